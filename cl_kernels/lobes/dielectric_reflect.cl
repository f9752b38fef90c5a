// The reflected part of a rough interface between dielectrics (pylmc/lobes/dielectric.py).
#ifndef PYLMC_DIELECTRIC_REFLECT
#define PYLMC_DIELECTRIC_REFLECT

#include "lobes/interface.cl"

real3 dielectric_reflect_value(__global const Lobe *lobe, const Vertex *vertex, real3 n, real3 wi, real3 wo, real *scale) {
    if (!same_side(vertex, wi, wo)) return (real3)(0.0);
    real3 h = normalize(wi + wo);
    *scale = facet_reflection(h, n, wi, wo, lobe->alpha, lobe->separable);
    return (real3)(fresnel_dielectric(dot(wi, h), relative_ior(lobe, vertex, wi)));
}

real dielectric_reflect_density(const Scene *scene, __global const Lobe *lobe, const Vertex *vertex, real3 known, real3 other) {
    real3 n = normal_towards(vertex, known);
    real density = facet_reflection_density(n, known, other, lobe->alpha);
    if (density == 0.0) return 0.0;
    return density * fresnel_dielectric(dot(known, normalize(known + other)), relative_ior(lobe, vertex, known));
}

bool dielectric_reflect_sample(const Scene *scene, __global const Lobe *lobe, Vertex *vertex, real3 known, Rng *rng,
                               real3 *other) {
    return interface_sample(lobe, vertex, known, rng, other);
}

LobeGradient dielectric_reflect_gradient(__global const Lobe *lobe, const Vertex *vertex, real3 n, real side, real3 wi,
                                         real3 wo) {
    Facet facet = facet_between(n, wi, wo, 1.0);
    real eta = relative_ior(lobe, vertex, wi);
    real by_xi = fresnel_slope(facet.xi, eta) / fresnel_dielectric(facet.xi, eta);
    return facet_gradient(&facet, n, side, wi, wo, lobe->alpha, lobe->separable, 1.0, by_xi, 0.0);
}

#endif
