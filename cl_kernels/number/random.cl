// Counter-based random numbers (Philox4x32-10, from pyopencl's random123): a stream is named by (seed, stream, purpose),
// so that any path can be drawn again from its number alone, on every device alike.
#ifndef PYLMC_RANDOM
#define PYLMC_RANDOM

#include "number/vectors.cl"
#include <pyopencl-random123/philox.cl>

typedef struct {
    philox4x32_key_t key;
    philox4x32_ctr_t counter;
    philox4x32_ctr_t block;
    int left;
} Rng;

// counter: the number of blocks used so far, the step (or draw) as 64 bits, and the purpose.
Rng rng_open(uint seed, uint stream, ulong step, uint purpose) {
    Rng rng;
    rng.key.v[0] = seed;
    rng.key.v[1] = stream;
    rng.counter.v[0] = 0u;
    rng.counter.v[1] = (uint)step;
    rng.counter.v[2] = (uint)(step >> 32);
    rng.counter.v[3] = purpose;
    rng.left = 0;
    return rng;
}

uint rng_bits(Rng *rng) {
    if (rng->left == 0) {
        rng->block = philox4x32_R(10, rng->counter, rng->key);
        rng->counter.v[0]++;
        rng->left = 4;
    }
    rng->left--;
    return rng->block.v[rng->left];
}

// Uniform in the open interval (0, 1): as many bits as `real` holds, and a half, so that neither end is ever returned, not
// even by rounding.
real rng_uniform(Rng *rng) {
#if REAL == REAL_FLOAT
    return ((real)(rng_bits(rng) >> 9) + 0.5) * 1.1920928955078125e-7;  // 2^-23
#else
    uint high = rng_bits(rng) >> 6, low = rng_bits(rng) >> 6;
    return ((real)high * 67108864.0 + (real)low + 0.5) * 2.220446049250313e-16;  // 2^26, 2^-52
#endif
}

int rng_index(Rng *rng, int count) { return min((int)(rng_uniform(rng) * count), count - 1); }

// Two independent standard normals (Box and Muller).
real2 rng_normal2(Rng *rng) {
    real radius = sqrt(-2.0 * log(rng_uniform(rng)));
    real angle = 2.0 * PI * rng_uniform(rng);
    return radius * (real2)(cos(angle), sin(angle));
}

#endif
