// Whether a `real` is a number, in integers: with math="fast" a compiler may take NaN and infinities for impossible and leave
// out comparisons that tell them, such as !(x > 0.0). It may also know integer comparisons that single out infinity's bits for
// what they are, so the greatest number passes for infinite too. (Pairs of floats are computed with math="exact" only.)
#ifndef PYLMC_FINITE
#define PYLMC_FINITE

#include "number/real.cl"

#if REAL == REAL_PAIR
bool is_positive(real x) { return x > 0.0; }
bool is_minus_infinity(real x) { return x == -INFINITY; }
#else
#if REAL == REAL_DOUBLE
#define REAL_BITS as_ulong
#define SIGN_BIT 0x8000000000000000ul
#define INFINITY_BITS 0x7ff0000000000000ul
#else
#define REAL_BITS as_uint
#define SIGN_BIT 0x80000000u
#define INFINITY_BITS 0x7f800000u
#endif
bool real_isnan(real x) { return (REAL_BITS(x) & ~SIGN_BIT) > INFINITY_BITS; }
bool real_isinf(real x) { return (REAL_BITS(x) & ~SIGN_BIT) - (INFINITY_BITS - 1) < 2; }
bool real_isfinite(real x) { return (REAL_BITS(x) & ~SIGN_BIT) < INFINITY_BITS; }

// Above zero, infinity too; false of NaN.
bool is_positive(real x) { return REAL_BITS(x) - 1 < INFINITY_BITS; }
bool is_minus_infinity(real x) { return REAL_BITS(x) - (SIGN_BIT | (INFINITY_BITS - 1)) < 2; }

// some implementations have macros of these names
#undef isnan
#undef isinf
#undef isfinite
#define isnan real_isnan
#define isinf real_isinf
#define isfinite real_isfinite
#endif

#endif
