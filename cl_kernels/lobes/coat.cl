// The reflection of a dielectric coat, alike on both sides (pylmc/lobes/coat.py).
#ifndef PYLMC_COAT
#define PYLMC_COAT

#include "lobes/facets.cl"
#include "lobes/gradient.cl"

real3 coat_value(__global const Lobe *lobe, const Vertex *vertex, real3 n, real3 wi, real3 wo, real *scale) {
    if (!same_side(vertex, wi, wo)) return (real3)(0.0);
    real3 h = normalize(wi + wo);
    *scale = facet_reflection(h, n, wi, wo, lobe->alpha, lobe->separable);
    return (real3)(fresnel_dielectric(dot(wi, h), lobe->ior));
}

real coat_density(const Scene *scene, __global const Lobe *lobe, const Vertex *vertex, real3 known, real3 other) {
    return facet_reflection_density(normal_towards(vertex, known), known, other, lobe->alpha);
}

bool coat_sample(const Scene *scene, __global const Lobe *lobe, Vertex *vertex, real3 known, Rng *rng, real3 *other) {
    return facet_reflection_sample(normal_towards(vertex, known), known, lobe->alpha, rng, other);
}

LobeGradient coat_gradient(__global const Lobe *lobe, const Vertex *vertex, real3 n, real side, real3 wi, real3 wo) {
    Facet facet = facet_between(n, wi, wo, 1.0);
    real by_xi = fresnel_slope(facet.xi, lobe->ior) / fresnel_dielectric(facet.xi, lobe->ior);
    return facet_gradient(&facet, n, side, wi, wo, lobe->alpha, lobe->separable, 1.0, by_xi, 0.0);
}

#endif
