// How lobes about the normal are sampled: in proportion to the cosine, or aimed (lights/aiming.cl).
#ifndef PYLMC_COSINE
#define PYLMC_COSINE

#include "lights/aiming.cl"
#include "lobes/sides.cl"

real cosine_density(const Scene *scene, const Vertex *vertex, real3 known, real3 other) {
    real co = same_side(vertex, known, other) ? fabs(dot(vertex->ns, other)) : 0.0;
    return aimed_density(scene, vertex->x, other, co * INV_PI, AIM_FROM_NODE);
}

bool cosine_sample(const Scene *scene, const Vertex *vertex, real3 known, Rng *rng, real3 *other) {
    if (sample_aim(scene, vertex->x, AIM_FROM_NODE, rng, other)) return true;
    real3 n = normal_towards(vertex, known);
    real radius2 = rng_uniform(rng), angle = 2.0 * PI * rng_uniform(rng), radius = sqrt(radius2);
    *other = about_axis(n, sqrt(1.0 - radius2), radius, angle);
    return true;
}

#endif
