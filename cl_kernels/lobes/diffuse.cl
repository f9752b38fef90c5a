// Lambertian reflection: f = reflectance / pi (pylmc/lobes/diffuse.py).
#ifndef PYLMC_DIFFUSE
#define PYLMC_DIFFUSE

#include "lobes/cosine.cl"
#include "lobes/gradient.cl"

real3 diffuse_value(__global const Lobe *lobe, const Vertex *vertex, real3 n, real3 wi, real3 wo, real *scale) {
    if (!same_side(vertex, wi, wo)) return (real3)(0.0);
    *scale = dot(n, wo) * INV_PI;
    return vec3(lobe->diffuse) * vertex->tint;
}

real diffuse_density(const Scene *scene, __global const Lobe *lobe, const Vertex *vertex, real3 known, real3 other) {
    return cosine_density(scene, vertex, known, other);
}

bool diffuse_sample(const Scene *scene, __global const Lobe *lobe, Vertex *vertex, real3 known, Rng *rng, real3 *other) {
    return cosine_sample(scene, vertex, known, rng, other);
}

LobeGradient diffuse_gradient(__global const Lobe *lobe, const Vertex *vertex, real3 n, real side, real3 wi, real3 wo) {
    return cosine_gradient(n, side, wo);
}

#endif
