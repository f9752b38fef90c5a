// The number type of paths, integrand and densities (pylmc/device/precision.py). Kernels are written once, in `real`; a floating
// literal without a suffix is a `real` too (pylmc/device/program.py gives it one). REAL is one of these; with REAL_PAIR the host
// translates every operation on a `real` into a call, and float_float.cl comes first.
#ifndef PYLMC_REAL
#define PYLMC_REAL

#if REAL != REAL_PAIR
#if REAL == REAL_DOUBLE
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#define REAL_NAME(suffix) double##suffix
#define convert_real2 convert_double2
#define convert_real8 convert_double8
#else
#define REAL_NAME(suffix) float##suffix
#define convert_real2 convert_float2
#define convert_real8 convert_float8
#endif
typedef REAL_NAME() real;
typedef REAL_NAME(2) real2;
typedef REAL_NAME(3) real3;
typedef REAL_NAME(8) real8;

#if REAL == REAL_FLOAT
#include "number/elementary.cl"
#undef exp
#undef log
#undef sin
#undef cos
#if MATH_NATIVE
#undef sqrt
#undef rsqrt
#define exp native_exp
#define log native_log
#define sin native_sin
#define cos native_cos
#define sqrt native_sqrt
#define rsqrt native_rsqrt
#else
#define exp exp_float
#define log log_float
#define sin sin_float
#define cos cos_float
#endif
#endif
#include "number/geometry.cl"

// Entry k of a row of eights.
real real8_at(const real8 *row, int k) { return ((const real *)row)[k]; }
#endif

#endif
