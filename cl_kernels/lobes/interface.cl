// An interface between two dielectrics, whose two lobes, next to each other among the material's, are one choice.
#ifndef PYLMC_INTERFACE
#define PYLMC_INTERFACE

#include "lobes/facets.cl"
#include "lobes/gradient.cl"

// Index of the side that w_o is on over the side that w_i is on, were they opposite.
real relative_ior(__global const Lobe *lobe, const Vertex *vertex, real3 wi) {
    return dot(vertex->ns, wi) > 0.0 ? lobe->ior : 1.0 / lobe->ior;
}

// Draw a facet, then reflection or refraction by its Fresnel term; the vertex's lobe becomes the one drawn.
bool interface_sample(__global const Lobe *lobe, Vertex *vertex, real3 known, Rng *rng, real3 *other) {
    real3 n = normal_towards(vertex, known);
    real u1 = rng_uniform(rng), u2 = rng_uniform(rng);
    real3 h = ggx_sample_visible(known, n, lobe->alpha, u1, u2);
    real kh = dot(known, h);
    if (kh <= 0.0) return false;
    real eta = relative_ior(lobe, vertex, known);
    if (lobe->pair < 0) vertex->lobe--;
    if (rng_uniform(rng) >= fresnel_dielectric(kh, eta)) {
        vertex->lobe++;
        real cosine_t = sqrt(fmax(0.0, 1.0 - (1.0 - kh * kh) / (eta * eta)));
        *other = normalize((kh / eta - cosine_t) * h - known / eta);
        return dot(*other, n) < 0.0;
    }
    *other = normalize(2.0 * kh * h - known);
    return dot(*other, n) > 0.0;
}

#endif
