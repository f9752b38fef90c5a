// Functions of pairs of floats: elementary ones, vectors' components, products and lengths, and arrays in memory.
//
// Errors are relative and at most 2^-45, or 2^-43 where division is sloppy (tests/units/device/test_float_float.py measures both); those of
// sin and cos are relative to the greater of the result and one, and hold for |x| < 2^20. Polynomials are Taylor's: their
// first terms in pairs, and in floats from where a float's rounding no longer shows.
#ifndef PYLMC_FLOAT_FLOAT_FUNCTIONS
#define PYLMC_FLOAT_FLOAT_FUNCTIONS

// ln 2 in three parts; an integer of up to nine bits times either of the first two is exact.
#define FF_LN2_HIGH 6.9314575e-01f
#define FF_LN2_MIDDLE 1.4285906e-06f
#define FF_LN2_LOW 1.619851e-11f

// e^x: 2^k e^r, |r| <= ln(2) / 2, and e^r - 1 from e^(r/64) - 1 by doubling the exponent six times.
real ff_exp(real x) {
    if (!(fabs(x.hi) < 110.0f)) return ff_from_float(exp(x.hi));  // 0, infinity or NaN
    float k = rint(x.hi * 1.442695f);
    real r = ff_sub(ff_sub(x, ff_finish(0.0f, k * FF_LN2_HIGH, k * FF_LN2_MIDDLE)), ff_from_float(k * FF_LN2_LOW));
    r = ff_make(0.015625f * r.hi, 0.015625f * r.lo);
    real p = ff_from_float(r.hi * (4.1666668e-02f + r.hi * (8.333334e-03f + r.hi * 1.3888889e-03f)));
    p = ff_add(ff_mul(ff_add(p, ff_make(1.6666667e-01f, -4.967054e-09f)), r), ff_from_float(0.5f));
    p = ff_add(r, ff_mul(ff_mul(r, r), p));
    for (int i = 0; i < 6; i++) p = ff_add(ff_make(2.0f * p.hi, 2.0f * p.lo), ff_mul(p, p));
    p = ff_add(ff_from_float(1.0f), p);
    float hi = ldexp(p.hi, (int)k);
    return ff_make(hi, isfinite(hi) ? ldexp(p.lo, (int)k) : 0.0f);
}

// ln x: k ln 2 + ln m with m between sqrt(1/2) and sqrt(2), and ln m = 2 artanh(s), s = (m - 1) / (m + 1), |s| < 0.172.
real ff_log(real x) {
    if (!(x.hi > 0.0f && x.hi < INFINITY)) return ff_from_float(log(x.hi));
    int k;
    if (frexp(x.hi, &k) < 0.70710677f) k--;
    real m = ff_make(ldexp(x.hi, -k), ldexp(x.lo, -k));
    real s = ff_div(ff_sub(m, ff_from_float(1.0f)), ff_add(m, ff_from_float(1.0f))), z = ff_mul(s, s);
    float tail = 1.3333334e-01f + z.hi * (1.1764706e-01f + z.hi * 1.0526316e-01f);
    tail = 2.2222222e-01f + z.hi * (1.8181819e-01f + z.hi * (1.5384616e-01f + z.hi * tail));
    real p = ff_from_float(z.hi * tail);
    p = ff_mul(ff_add(p, ff_make(2.857143e-01f, -1.2772424e-08f)), z);
    p = ff_mul(ff_add(p, ff_make(4.0e-01f, -5.9604646e-09f)), z);
    p = ff_mul(ff_add(p, ff_make(6.666667e-01f, -1.9868216e-08f)), ff_mul(z, s));
    p = ff_add(ff_make(2.0f * s.hi, 2.0f * s.lo), p);
    p = ff_add(ff_from_float(k * FF_LN2_LOW), p);
    return ff_add(ff_finish(0.0f, k * FF_LN2_HIGH, k * FF_LN2_MIDDLE), p);
}

// x - k pi/2, |...| <= pi/4, and k mod 4. pi/2 is three floats, k times the first two an exact pair.
real ff_reduce(real x, int *quadrant) {
    float k = rint(x.hi * 6.3661975e-01f), high = k * 1.5707964e+00f, middle = k * -4.371139e-08f;
    real r = ff_sub(x, ff_make(high, FF_PRODUCT_ERROR(ff, k, 1.5707964e+00f, high)));
    r = ff_sub(r, ff_make(middle, FF_PRODUCT_ERROR(ff, k, -4.371139e-08f, middle)));
    *quadrant = (int)k & 3;
    return ff_sub(r, ff_from_float(k * -1.7151245e-15f));
}

real ff_sin_reduced(real r) {
    real z = ff_mul(r, r);
    real p = ff_from_float(z.hi * (-2.5052108e-08f + z.hi * (1.6059044e-10f - z.hi * 7.6471637e-13f)));
    p = ff_mul(ff_add(p, ff_make(2.7557319e-06f, 3.7935712e-14f)), z);
    p = ff_mul(ff_add(p, ff_make(-1.984127e-04f, 2.7255969e-12f)), z);
    p = ff_mul(ff_add(p, ff_make(8.333334e-03f, -4.346172e-10f)), z);
    p = ff_mul(ff_add(p, ff_make(-1.6666667e-01f, 4.967054e-09f)), z);
    return ff_add(r, ff_mul(r, p));
}

real ff_cos_reduced(real r) {
    real z = ff_mul(r, r);
    float tail = 2.0876756e-09f + z.hi * (-1.1470746e-11f + z.hi * 4.7794773e-14f);
    real p = ff_from_float(z.hi * (-2.755732e-07f + z.hi * tail));
    p = ff_mul(ff_add(p, ff_make(2.4801588e-05f, -3.406996e-13f)), z);
    p = ff_mul(ff_add(p, ff_make(-1.3888889e-03f, 3.3631094e-11f)), z);
    p = ff_mul(ff_add(p, ff_make(4.1666668e-02f, -1.2417635e-09f)), z);
    p = ff_mul(ff_add(p, ff_from_float(-0.5f)), z);
    return ff_add(ff_from_float(1.0f), p);
}

// Greater arguments, which no path has, get a float's digits: k would not be near enough to x / (pi/2).
#define FF_CIRCULAR_LIMIT 1048576.0f

real ff_sin(real x) {
    int quadrant;
    if (!(fabs(x.hi) < FF_CIRCULAR_LIMIT)) return ff_from_float(sin(x.hi));
    real r = ff_reduce(x, &quadrant), y = quadrant & 1 ? ff_cos_reduced(r) : ff_sin_reduced(r);
    return quadrant & 2 ? ff_neg(y) : y;
}

real ff_cos(real x) {
    int quadrant;
    if (!(fabs(x.hi) < FF_CIRCULAR_LIMIT)) return ff_from_float(cos(x.hi));
    real r = ff_reduce(x, &quadrant), y = quadrant & 1 ? ff_sin_reduced(r) : ff_cos_reduced(r);
    return (quadrant + 1) & 2 ? ff_neg(y) : y;
}

// Components: read, and replaced.
#define FF_COMPONENT(T, P, C)                             \
    real P##_##C(T v) { return ff_make(v.hi.C, v.lo.C); } \
    T P##_with_##C(T v, real x) {                         \
        v.hi.C = x.hi;                                    \
        v.lo.C = x.lo;                                    \
        return v;                                         \
    }
FF_COMPONENT(real2, ff2, x)
FF_COMPONENT(real2, ff2, y)
FF_COMPONENT(real3, ff3, x)
FF_COMPONENT(real3, ff3, y)
FF_COMPONENT(real3, ff3, z)
real2 ff2_of(real x, real y) { return ff2_make((float2)(x.hi, y.hi), (float2)(x.lo, y.lo)); }
real3 ff3_of(real x, real y, real z) { return ff3_make((float3)(x.hi, y.hi, z.hi), (float3)(x.lo, y.lo, z.lo)); }
real real8_at(const real8 *row, int k) {
    const real8 *eight = row + (k >> 3);
    return ff_make(((const float *)&eight->hi)[k & 7], ((const float *)&eight->lo)[k & 7]);
}

real ff2_dot(real2 a, real2 b) {
    real2 p = ff2_mul(a, b);
    return ff_add(ff2_x(p), ff2_y(p));
}
real ff3_dot(real3 a, real3 b) {
    real3 p = ff3_mul(a, b);
    return ff_add(ff_add(ff3_x(p), ff3_y(p)), ff3_z(p));
}
real3 ff3_cross(real3 a, real3 b) {
    return ff3_sub(ff3_mul(ff3_make(a.hi.yzx, a.lo.yzx), ff3_make(b.hi.zxy, b.lo.zxy)),
                   ff3_mul(ff3_make(a.hi.zxy, a.lo.zxy), ff3_make(b.hi.yzx, b.lo.yzx)));
}
// As OpenCL's: squares neither overflow nor lose digits, since v is scaled by a power of two where they might.
float ff3_scale(real3 v) {
    float most = fmax(fabs(v.hi.x), fmax(fabs(v.hi.y), fabs(v.hi.z)));
    bool needed = (most < 1e-10f && most > 0.0f) || (most > 1e15f && most < INFINITY);
    return needed ? ldexp(1.0f, clamp(-ilogb(most), -126, 126)) : 1.0f;
}
real3 ff3_normalize(real3 v) {
    float scale = ff3_scale(v);
    v = ff3_make(scale * v.hi, scale * v.lo);
    real square = ff3_dot(v, v);
    return square.hi == 0.0f ? v : ff3_mul(v, ff3_splat(ff_rsqrt(square)));
}
real ff3_length(real3 v) {
    float scale = ff3_scale(v);
    v = ff3_make(scale * v.hi, scale * v.lo);
    return ff_div(ff_sqrt(ff3_dot(v, v)), ff_from_float(scale));
}
real ff3_distance(real3 a, real3 b) { return ff3_length(ff3_sub(a, b)); }

// vload and vstore, by address space.
#define FF_MEMORY(SPACE, NAME)                                                                                     \
    real2 ff2_vload_##NAME(size_t i, SPACE const real *p) { return ff2_of(p[2 * i], p[2 * i + 1]); }               \
    real3 ff3_vload_##NAME(size_t i, SPACE const real *p) { return ff3_of(p[3 * i], p[3 * i + 1], p[3 * i + 2]); } \
    void ff2_vstore_##NAME(real2 v, size_t i, SPACE real *p) {                                                     \
        p[2 * i] = ff2_x(v);                                                                                       \
        p[2 * i + 1] = ff2_y(v);                                                                                   \
    }                                                                                                              \
    void ff3_vstore_##NAME(real3 v, size_t i, SPACE real *p) {                                                     \
        p[3 * i] = ff3_x(v);                                                                                       \
        p[3 * i + 1] = ff3_y(v);                                                                                   \
        p[3 * i + 2] = ff3_z(v);                                                                                   \
    }
FF_MEMORY(__global, global)
FF_MEMORY(__private, private)

#endif
