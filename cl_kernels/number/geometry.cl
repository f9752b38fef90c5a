// Products, lengths and mixtures of `real` vectors, written out: implementations of OpenCL's own add and round in ways of their
// own, so that a seed would not give the same picture on all of them. What remains built in (+, -, *, / and sqrt, fmin, floor
// and the like) is rounded as IEEE 754 has it, where the device can (pylmc/device/program.py).
#ifndef PYLMC_GEOMETRY
#define PYLMC_GEOMETRY

#define OVERLOADED __attribute__((overloadable))

#if !MATH_NATIVE
#undef rsqrt
#define rsqrt(x) (1.0 / sqrt(x))
#endif

real OVERLOADED real_dot(real2 a, real2 b) { return a.x * b.x + a.y * b.y; }
real OVERLOADED real_dot(real3 a, real3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
real3 real_cross(real3 a, real3 b) { return a.yzx * b.zxy - a.zxy * b.yzx; }
real OVERLOADED real_mix(real a, real b, real share) { return a + (b - a) * share; }
real3 OVERLOADED real_mix(real3 a, real3 b, real share) { return a + (b - a) * share; }

// Squares beyond these have overflowed or lost digits: the vector is scaled first.
#if REAL == REAL_DOUBLE
#define LEAST_SQUARE 1e-280
#define GREATEST_SQUARE 1e300
#else
#define LEAST_SQUARE 1e-30
#define GREATEST_SQUARE 1e38
#endif

// |v| / scale, and v / scale.
real scaled_length(real3 *v, real *scale) {
    real square = real_dot(*v, *v);
    *scale = 1.0;
    if (!(square >= LEAST_SQUARE && square <= GREATEST_SQUARE)) {
        *scale = fmax(fabs(v->x), fmax(fabs(v->y), fabs(v->z)));
        if (*scale == 0.0) return 0.0;
        *v /= *scale;
        square = real_dot(*v, *v);
    }
    return sqrt(square);
}

real real_length(real3 v) {
    real scale, size = scaled_length(&v, &scale);
    return scale * size;
}

// The zero vector stays as it is.
real3 real_normalize(real3 v) {
    real scale, size = scaled_length(&v, &scale);
    return size > 0.0 ? v / size : v;
}

real real_distance(real3 a, real3 b) { return real_length(a - b); }

// some implementations have macros of these names
#undef dot
#undef cross
#undef mix
#undef length
#undef normalize
#undef distance
#define dot real_dot
#define cross real_cross
#define mix real_mix
#define length(v) real_length(v)
#define normalize real_normalize
#define distance(a, b) real_distance(a, b)

#endif
