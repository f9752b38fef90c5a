// The film: 64-bit fixed point, FILM_SCALE to the unit, two 32-bit words a channel, added with 32-bit atomics alone (OpenCL 1.2
// core). The low word's sum wraps; whoever sees it wrap carries one into the high word. Every wrap is seen once, so the sum is
// exact and does not depend on the order of the additions: the same seed gives the same image, run after run. The high word
// stays at its greatest value once it is there, and the host says so (pylmc/device/arrays.py).
#ifndef PYLMC_FILM
#define PYLMC_FILM

#include "number/finite.cl"

#define FULL 0xffffffffu

void film_add_high(__global volatile uint *word, uint addend) {
    uint now = *word, before;
    do {
        before = now;
        now = atomic_cmpxchg(word, before, add_sat(before, addend));
    } while (now != before);
}

void film_add_channel(__global volatile uint *word, real value) {
    if (!is_positive(value)) return;  // nothing, or NaN, which must not reach the film
    float scaled = (float)value * FILM_SCALE + 0.5f;
    if (!(scaled < 1.8e19f)) {  // 2^64, about
        film_add_high(&word[1], FULL);
        return;
    }
    uint high = (uint)(scaled * 2.3283064365386963e-10f);  // 2^-32
    uint low = (uint)(scaled - (float)high * 4294967296.0f);
    if (low) {
        uint before = atomic_add(&word[0], low);
        high += before + low < before;
    }
    if (high) film_add_high(&word[1], high);
}

void film_add(__global volatile uint *film, size_t pixel, real3 value) {
    film_add_channel(film + 6 * pixel, value.x);
    film_add_channel(film + 6 * pixel + 2, value.y);
    film_add_channel(film + 6 * pixel + 4, value.z);
}

#endif
