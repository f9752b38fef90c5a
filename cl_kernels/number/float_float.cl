// Pairs of floats: a `real` is hi + lo with |lo| <= ulp(hi) / 2, about 48 bits out of float32 arithmetic alone, for devices
// without 64-bit floats. OpenCL C cannot overload operators: pylmc/float_float turns a + b on reals into ff_add(a, b), on
// real3s into ff3_add(a, b), and so on. This file is not translated: what it calls float is one.
//
// Error-free transforms of Dekker (1971) and Knuth (TAOCP 2, 4.2.2); operations of Joldes, Muller and Popescu, "Tight and
// rigorous error bounds for basic building blocks of double-word arithmetic" (TOMS 44, 2017). With u = 2^-24, sums are within
// 3 u^2 of the exact result, products 5 u^2 (7 u^2 without fma), quotients 15 u^2; square roots 4 u^2 after Lefevre, Louvet,
// Muller, Picot and Rideau (TOMS 49, 2023). That takes +, -, * rounded to nearest and never contracted. Where division
// and square roots of floats are 2.5 ulp off, which OpenCL allows, quotients and roots of pairs are still within 2^-43.
//
// Range: float32's. The low word runs out of digits below about 2^-77 and, without fma, for factors beyond 2^115. Infinity
// and NaN go through as in floats, with lo = 0.
#ifndef PYLMC_FLOAT_FLOAT
#define PYLMC_FLOAT_FLOAT

#pragma OPENCL FP_CONTRACT OFF

#if defined(FP_FAST_FMAF) || defined(__FMA__)
#define FF_MULTIPLY_ADD(a, b, c) fma(a, b, c)
#define FF_PRODUCT_ERROR(P, a, b, product) fma(a, b, -(product))
#else
#define FF_MULTIPLY_ADD(a, b, c) ((a) * (b) + (c))
#define FF_PRODUCT_ERROR(P, a, b, product) P##_product_error(a, b, product)
#endif

typedef struct __attribute__((aligned(8))) {
    float hi, lo;
} real;  // as the host packs it
typedef struct {
    float2 hi, lo;
} real2;
typedef struct {
    float3 hi, lo;
} real3;
typedef struct {
    float8 hi, lo;
} real8;

// Everything that goes by components. T: the pair; P: prefix of its functions; F, I: floats and ints as wide.
#define FF_DEFINE(T, P, F, I)                                                                                       \
    T P##_make(F hi, F lo) { return (T){hi, lo}; }                                                                  \
    T P##_from_float(F x) { return (T){x, (F)(0.0f)}; }                                                             \
    T P##_splat(real x) { return (T){(F)(x.hi), (F)(x.lo)}; }                                                       \
    /* Both halves of an int are floats, and so is their sum's error. */                                            \
    T P##_from_int(I x) {                                                                                           \
        F high = convert_##F((x >> 16) << 16), low = convert_##F(x & 0xffff), hi = high + low;                      \
        return (T){hi, low - (hi - high)};                                                                          \
    }                                                                                                               \
                                                                                                                    \
    /* s + e, |e| <= |s| (Dekker's fast two-sum); `first`, a rounded result, stands in where that is not finite. */ \
    T P##_finish(F first, F s, F e) {                                                                               \
        F hi = s + e, lo = e - (hi - s);                                                                            \
        return (T){select(first, hi, isfinite(hi)), select((F)(0.0f), lo, isfinite(hi))};                           \
    }                                                                                                               \
    /* What a + b loses (Knuth's two-sum). */                                                                       \
    F P##_sum_error(F a, F b, F sum) {                                                                              \
        F b_in_sum = sum - a;                                                                                       \
        return (a - (sum - b_in_sum)) + (b - b_in_sum);                                                             \
    }                                                                                                               \
    /* What a * b loses, by halves of 12 bits (Veltkamp's splitting, Dekker's product). */                          \
    F P##_product_error(F a, F b, F product) {                                                                      \
        F a_split = 4097.0f * a, a_high = a_split - (a_split - a), a_low = a - a_high;                              \
        F b_split = 4097.0f * b, b_high = b_split - (b_split - b), b_low = b - b_high;                              \
        return ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;                     \
    }                                                                                                               \
                                                                                                                    \
    T P##_neg(T x) { return (T){-x.hi, -x.lo}; }                                                                    \
    T P##_add(T x, T y) {                                                                                           \
        F s = x.hi + y.hi, t = x.lo + y.lo;                                                                         \
        F c = P##_sum_error(x.hi, y.hi, s) + t, v = s + c;                                                          \
        return P##_finish(s, v, P##_sum_error(x.lo, y.lo, t) + (c - (v - s)));                                      \
    }                                                                                                               \
    T P##_sub(T x, T y) { return P##_add(x, P##_neg(y)); }                                                          \
    T P##_mul(T x, T y) {                                                                                           \
        F product = x.hi * y.hi;                                                                                    \
        F cross = FF_MULTIPLY_ADD(x.lo, y.hi, FF_MULTIPLY_ADD(x.hi, y.lo, x.lo * y.lo));                            \
        return P##_finish(product, product, FF_PRODUCT_ERROR(P, x.hi, y.hi, product) + cross);                      \
    }                                                                                                               \
    T P##_div(T x, T y) {                                                                                           \
        F q = x.hi / y.hi, product = q * y.hi;                                                                      \
        F rest = ((x.hi - product) - FF_PRODUCT_ERROR(P, q, y.hi, product)) + x.lo;                                 \
        rest = FF_MULTIPLY_ADD(-q, y.lo, rest);                                                                     \
        F more = rest / y.hi;                                                                                       \
        return P##_finish(q, q, more + FF_MULTIPLY_ADD(-more, y.hi, rest) / y.hi);                                  \
    }                                                                                                               \
    /* What root * root misses of x.hi. */                                                                          \
    F P##_square_rest(T x, F root) {                                                                                \
        F square = root * root;                                                                                     \
        return (x.hi - square) - FF_PRODUCT_ERROR(P, root, root, square);                                           \
    }                                                                                                               \
    T P##_sqrt(T x) {                                                                                               \
        F first = sqrt(x.hi), root = first + P##_square_rest(x, first) / (2.0f * first);                            \
        return P##_finish(first, root, (P##_square_rest(x, root) + x.lo) / (2.0f * root));                          \
    }                                                                                                               \
    /* (1 - e)^(-1/2) = 1 + e / 2 + 3 e^2 / 8 ..., with 1 - e = x y^2. */                                           \
    T P##_rsqrt(T x) {                                                                                              \
        F y = rsqrt(x.hi);                                                                                          \
        T xyy = P##_mul(P##_mul(x, P##_from_float(y)), P##_from_float(y));                                          \
        F e = (1.0f - xyy.hi) - xyy.lo;                                                                             \
        return P##_finish(y, y, y * e * FF_MULTIPLY_ADD(0.375f, e, (F)(0.5f)));                                     \
    }                                                                                                               \
                                                                                                                    \
    I P##_less(T x, T y) { return (x.hi < y.hi) | ((x.hi == y.hi) & (x.lo < y.lo)); }                               \
    T P##_select(T x, T y, I c) { return (T){select(x.hi, y.hi, c), select(x.lo, y.lo, c)}; }                       \
    T P##_fmin(T x, T y) { return P##_select(x, y, P##_less(y, x) | isnan(x.hi)); }                                 \
    T P##_fmax(T x, T y) { return P##_select(x, y, P##_less(x, y) | isnan(x.hi)); }                                 \
    T P##_clamp(T x, T low, T high) { return P##_fmin(P##_fmax(x, low), high); }                                    \
    T P##_mix(T x, T y, T share) { return P##_add(x, P##_mul(P##_sub(y, x), share)); }                              \
    T P##_fabs(T x) { return P##_select(x, P##_neg(x), signbit(x.hi)); }                                            \
    T P##_copysign(T x, T y) { return P##_select(P##_fabs(x), P##_neg(P##_fabs(x)), signbit(y.hi)); }               \
    T P##_floor(T x) {                                                                                              \
        F low = floor(x.hi);                                                                                        \
        return P##_finish(low, low, select((F)(0.0f), floor(x.lo), low == x.hi));                                   \
    }                                                                                                               \
    T P##_trunc(T x) { return P##_copysign(P##_floor(P##_fabs(x)), x); }                                            \
    /* Towards zero; |x| must be below 2^31 - 128. */                                                               \
    I P##_to_int(T x) {                                                                                             \
        T whole = P##_trunc(x);                                                                                     \
        return convert_##I(whole.hi) + convert_##I(whole.lo);                                                       \
    }

FF_DEFINE(real, ff, float, int)
FF_DEFINE(real2, ff2, float2, int2)
FF_DEFINE(real3, ff3, float3, int3)
FF_DEFINE(real8, ff8, float8, int8)

// Comparisons are false with NaN, except that it is not equal to anything.
int ff_lt(real x, real y) { return ff_less(x, y); }
int ff_gt(real x, real y) { return ff_less(y, x); }
int ff_le(real x, real y) { return x.hi < y.hi || (x.hi == y.hi && x.lo <= y.lo); }
int ff_ge(real x, real y) { return ff_le(y, x); }
int ff_eq(real x, real y) { return x.hi == y.hi && x.lo == y.lo; }
int ff_ne(real x, real y) { return !ff_eq(x, y); }
int ff_isnan(real x) { return isnan(x.hi); }
int ff_isinf(real x) { return isinf(x.hi); }
int ff_isfinite(real x) { return isfinite(x.hi); }

float ff_to_float(real x) { return x.hi; }
real ff_from_uint(uint x) {
    float high = (float)(x >> 16) * 65536.0f, low = (float)(x & 0xffffu), hi = high + low;
    return ff_make(hi, low - (hi - high));
}
// Towards zero; x from 0 to below 2^32.
uint ff_to_uint(real x) {
    real whole = ff_floor(x);
    return (uint)((long)whole.hi + (long)whole.lo);
}

#include "number/float_float_functions.cl"

#endif
