// log, exp, sin and cos of 32-bit floats, written out: OpenCL lets each implementation round its own by several ulps, and
// with these a seed gives the same picture on all of them. They take nothing but +, -, * and /, rounded to nearest and not
// contracted, and integers.
//
// Polynomials are minimax ones, fitted in float64 (bench/polynomials.py) and rounded to floats one coefficient after the
// other, the rest fitted anew. Greatest errors over all floats (tests/kernels/test_elementary.py goes through them):
//
//   log   0.84 ulp
//   exp   1.02 ulp, results below 2^-126 included, which are rounded once more
//   sin   1.50 ulp for |x| <= 8, and absolutely 1.32 * 2^-24 up to CIRCULAR_LIMIT
//   cos   2.21 ulp for |x| <= 8, and absolutely the same
//
// log of zero is -infinity, exp beyond its range 0 or infinity, NaN comes back as NaN; log of a negative number is NaN, and so
// are sin and cos beyond CIRCULAR_LIMIT, which is no angle that a path has. These cases are told, and answered, in integers, so
// that a compiler that may forget infinities (math="fast") cannot leave them out.
#ifndef PYLMC_ELEMENTARY
#define PYLMC_ELEMENTARY

#define PLUS_INFINITY 0x7f800000
#define MINUS_INFINITY (int)0xff800000u
#define QUIET_NAN 0x7fc00000

// ln 2 in two parts: an integer of up to eight bits times the first is exact.
#define LN2_HIGH 6.93145752e-01f
#define LN2_LOW 1.42860677e-06f

// ln x = k ln 2 + ln m with m = 1 + f between sqrt(1/2) and sqrt(2). With s = f / (2 + f), ln m = 2 artanh(s) = 2 s + s R(s^2),
// where f - s f is 2 s, written so that what is rounded is small beside f: f - (f^2 / 2 - s (f^2 / 2 + R)).
float log_float(float x) {
    int bits = as_int(x), k = 0;
    if ((uint)bits - 0x00800000u >= 0x7f000000u) {  // not a positive number of full precision
        if ((uint)bits - 1u >= 0x007fffffu)
            return as_float((uint)bits << 1 == 0u ? MINUS_INFINITY : bits == PLUS_INFINITY ? bits : QUIET_NAN);
        bits = as_int(x * 8388608.0f);  // 2^23
        k = -23;
    }
    int above = bits - 0x3f3504f3;  // sqrt(1/2)
    k += above >> 23;
    float f = as_float((above & 0x007fffff) + 0x3f3504f3) - 1.0f;
    float s = f / (2.0f + f), z = s * s, half_square = 0.5f * f * f;
    float rest = z * (6.66667759e-01f + z * (3.99775773e-01f + z * 2.98710614e-01f));
    float twos = (float)k;
    return twos * LN2_HIGH - ((half_square - (s * (half_square + rest) + twos * LN2_LOW)) - f);
}

// (x - k A) - k B must not become x - k (A + B), as math="relaxed" allows: it would undo a reduction. It cannot where the first
// difference goes through integers and a zero that the compiler does not know to be one; |k| is less than 4096.
#if MATH_CONTRACT
#define KEPT(difference, k) as_float(as_int(difference) + ((k + 4096) >> 20))
#else
#define KEPT(difference, k) (difference)
#endif

int rounded(float x) { return (int)(x + (as_int(x) < 0 ? -0.5f : 0.5f)); }

// e^x = 2^k e^r with |r| <= ln(2) / 2, and e^r = 1 + r + r^2 P(r). 2^k is added to the exponent.
float exp_float(float x) {
    uint size = as_uint(x) & 0x7fffffffu;
    if (size >= 0x42b17218u) {  // |x| > ln of the greatest float
        if (size > PLUS_INFINITY) return x;
        if (as_int(x) > 0) return as_float(PLUS_INFINITY);
        if (size >= 0x42cff1b5u) return 0.0f;  // x < ln 2^-150
    }
    int k = rounded(x * 1.44269502e+00f);
    float twos = (float)k, first = x - twos * LN2_HIGH, r = KEPT(first, k) - twos * LN2_LOW, r2 = r * r;
    float rest = 0.5f + r * 1.66665211e-01f + r2 * (4.16663885e-02f + r * 8.36867746e-03f + r2 * 1.39418768e-03f);
    int y = as_int(1.0f + (r + r2 * rest));
    if (k < -125) return as_float(y + ((k + 64) << 23)) * 5.42101086e-20f;  // 2^-64: subnormal, and rounded here
    return as_float(y + (k << 23));
}

// pi / 2 in three parts: an integer of up to eleven bits times either of the first two is exact, and so is what they leave of x.
#define HALF_PI_HIGH 1.5703125e+00f
#define HALF_PI_MIDDLE 4.83810902e-04f
#define HALF_PI_LOW 1.58932547e-08f
#define CIRCULAR_LIMIT 3000.0f

bool is_angle(float x) { return (as_uint(x) & 0x7fffffffu) <= as_uint(CIRCULAR_LIMIT); }

// x - k pi / 2, |...| <= pi / 4, of an angle.
float circular_reduced(float x, int *k) {
    int nearest = rounded(x * 6.36619747e-01f);
    float quarters = (float)nearest, first = x - quarters * HALF_PI_HIGH;
    float second = KEPT(first, nearest) - quarters * HALF_PI_MIDDLE;
    *k = nearest;
    return KEPT(second, nearest) - quarters * HALF_PI_LOW;
}

float sin_reduced(float r) {
    float z = r * r;
    return r + r * z * (-1.66666552e-01f + z * (8.33218917e-03f - z * 1.95182904e-04f));
}

float cos_reduced(float r) {
    float z = r * r;
    return 1.0f - (0.5f * z - z * z * (4.16666456e-02f + z * (-1.38873095e-03f + z * 2.44323273e-05f)));
}

float sin_float(float x) {
    int k;
    if (!is_angle(x)) return as_float(QUIET_NAN);
    float r = circular_reduced(x, &k), y = k & 1 ? cos_reduced(r) : sin_reduced(r);
    return k & 2 ? -y : y;
}

float cos_float(float x) {
    int k;
    if (!is_angle(x)) return as_float(QUIET_NAN);
    float r = circular_reduced(x, &k), y = k & 1 ? sin_reduced(r) : cos_reduced(r);
    return (k + 1) & 2 ? -y : y;
}

#endif
