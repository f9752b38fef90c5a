// What lobes of reflecting microfacets share: value without the Fresnel term, and sampling by visible normals.
#ifndef PYLMC_FACETS
#define PYLMC_FACETS

#include "lobes/microfacet.cl"
#include "lobes/sides.cl"
#include "number/random.cl"

// D G / (4 cos theta_i), the Fresnel term left out; h is the facet's normal.
real facet_reflection(real3 h, real3 n, real3 wi, real3 wo, real alpha, int separable) {
    real masking = ggx_masking(ggx_lambda(wi, n, alpha), ggx_lambda(wo, n, alpha), separable);
    return ggx_density(h, n, alpha) * masking / (4.0 * dot(n, wi));
}

// Density of reflecting `known` at a visible normal so that it leaves as `other`. n is on known's side.
real facet_reflection_density(real3 n, real3 known, real3 other, real alpha) {
    real ci = dot(n, known), co = dot(n, other);
    real g1 = 1.0 / (1.0 + ggx_lambda(known, n, alpha));
    if (co <= 0.0 || ci <= 0.0) return 0.0;
    real3 h = normalize(known + other);
    return g1 * ggx_density(h, n, alpha) / (4.0 * ci);
}

bool facet_reflection_sample(real3 n, real3 known, real alpha, Rng *rng, real3 *other) {
    real u1 = rng_uniform(rng), u2 = rng_uniform(rng);
    real3 h = ggx_sample_visible(known, n, alpha, u1, u2);
    real kh = dot(known, h);
    if (kh <= 0.0) return false;
    *other = normalize(2.0 * kh * h - known);
    return dot(*other, n) > 0.0;
}

#endif
