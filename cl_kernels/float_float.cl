// Pairs of floats: a `real` is hi + lo with |lo| <= ulp(hi) / 2, about 2^-48 of relative precision out of float32 arithmetic alone,
// for devices without 64-bit floats. OpenCL C cannot overload operators: pylmc/float_float turns a + b on reals into
// ff_add(a, b), on real3 into ff3_add(a, b), and so on. This file passes through that untouched; its floats are floats.
//
// Error-free transforms after Dekker (1971) and Knuth (TAOCP 2, 4.2.2); operations and error bounds from Joldes, Muller and
// Popescu, "Tight and rigorous error bounds for basic building blocks of double-word arithmetic" (TOMS 44, 2017), with
// u = 2^-24: sums within 3 u^2, products 5 u^2 (7 u^2 without fma), quotients 15 u^2; square roots 25/8 u^2 (Lefevre,
// Louvet, Muller, Picot and Rideau 2022). They need round-to-nearest +, -, * (or fma), no contraction, and division and
// square root to a few ulp.
//
// Range: that of float32. Below about 2^-77 the low word loses digits, below 2^-126 the high one; without fma, factors beyond
// 2^114 overflow when they are split. Infinities and NaN behave as those of floats: they have lo = 0 (a sum or product
// that rounds to infinity only with its low word may be FLT_MAX instead).
#ifndef PYLMC_FLOAT_FLOAT
#define PYLMC_FLOAT_FLOAT

#pragma OPENCL FP_CONTRACT OFF

#if defined(FP_FAST_FMAF) || defined(__FMA__)
#define FF_MULTIPLY_ADD(a, b, c) fma(a, b, c)
#define FF_PRODUCT_ERROR(F, a, b, product) fma(a, b, -(product))
#else
#define FF_MULTIPLY_ADD(a, b, c) ((a) * (b) + (c))
#define FF_PRODUCT_ERROR(F, a, b, product) F##_product_error(a, b, product)
#endif

// `sum` is the main part of a result and hi + lo the result, if that is finite.
#define FF_PAIR(T, sum, hi, lo)                                                                                    \
    return (T){select(sum, hi, isfinite(hi)), select(0.0f * sum, lo, isfinite(hi))}
