// GGX reflection: a conductor's, of constant Fresnel factor, or with Schlick's term (pylmc/lobes/reflect.py).
#ifndef PYLMC_REFLECT
#define PYLMC_REFLECT

#include "lobes/facets.cl"
#include "lobes/gradient.cl"

real3 reflect_f0(__global const Lobe *lobe, const Vertex *vertex) {
    return vec3(lobe->specular) + vec3(lobe->specular_tinted) * vertex->tint;
}

real3 reflect_value(__global const Lobe *lobe, const Vertex *vertex, real3 n, real3 wi, real3 wo, real *scale) {
    if (!same_side(vertex, wi, wo)) return (real3)(0.0);
    real3 h = normalize(wi + wo);
    *scale = facet_reflection(h, n, wi, wo, lobe->alpha, lobe->separable);
    real3 f0 = reflect_f0(lobe, vertex);
    if (!lobe->schlick) return f0;
    real grazing = 1.0 - fmin(fabs(dot(wi, h)), 1.0);
    return f0 + (1.0 - f0) * (square(square(grazing)) * grazing);
}

real reflect_density(const Scene *scene, __global const Lobe *lobe, const Vertex *vertex, real3 known, real3 other) {
    real3 n = normal_towards(vertex, known);
    return facet_reflection_density(n, known, other, lobe->alpha);
}

bool reflect_sample(const Scene *scene, __global const Lobe *lobe, Vertex *vertex, real3 known, Rng *rng, real3 *other) {
    return facet_reflection_sample(normal_towards(vertex, known), known, lobe->alpha, rng, other);
}

LobeGradient reflect_gradient(__global const Lobe *lobe, const Vertex *vertex, real3 n, real side, real3 wi, real3 wo) {
    Facet facet = facet_between(n, wi, wo, 1.0);
    real by_xi = 0.0;
    if (lobe->schlick) {
        real f0 = luminance(reflect_f0(lobe, vertex));
        real grazing = 1.0 - fmin(facet.xi, 1.0);
        real grazing4 = square(square(grazing));
        by_xi = -5.0 * (1.0 - f0) * grazing4 / (f0 + (1.0 - f0) * grazing4 * grazing);
    }
    return facet_gradient(&facet, n, side, wi, wo, lobe->alpha, lobe->separable, 1.0, by_xi, 0.0);
}

#endif
