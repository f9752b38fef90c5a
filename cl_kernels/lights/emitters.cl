// Emitting triangles: the path lands on one (ENDING_HIT).
#ifndef PYLMC_EMITTERS
#define PYLMC_EMITTERS

#include "number/random.cl"
#include "surface/surface.cl"
#include "lights/aiming.cl"

// A point on an emitter: a triangle in proportion to area times luminance, then uniform on it.
void sample_emitter(const Scene *scene, Rng *rng, Vertex *vertex) {
    real u = rng_uniform(rng);
    int low = 0, high = NUM_EMITTER_TRIANGLES - 1;
    while (low < high) {
        int middle = (low + high) / 2;
        if (u < scene->emitter_cdf[middle])
            high = middle;
        else
            low = middle + 1;
    }
    real root = sqrt(rng_uniform(rng)), share = rng_uniform(rng);
    place_on_triangle(scene, scene->emitter_triangles[low], root * (1.0 - share), root * share, vertex);
}

// The emitter that the vertex lies on, or null.
__global const Emitter *emitter_at(const Scene *scene, const Vertex *vertex) {
    int emitter = scene->triangles[vertex->triangle].emitter;
    return emitter >= 0 ? &scene->emitters[emitter] : 0;
}

// Density per area of sample_emitter at the vertex.
real emitter_density(const Scene *scene, const Vertex *vertex) {
    __global const Emitter *emitter = emitter_at(scene, vertex);
    return emitter ? emitter->density : 0.0;
}

// Radiance that the vertex emits against v, the direction in which the camera's path arrives; front side only.
real3 emitted_radiance(const Scene *scene, const Vertex *vertex, real3 v) {
    __global const Emitter *emitter = emitter_at(scene, vertex);
    return emitter && dot(v, vertex->ng) < 0.0 ? vec3(emitter->radiance) : (real3)(0.0);
}

// The direction in which a light path leaves an emitter, and its density in solid angle.
real emitter_emission_density(const Scene *scene, const Vertex *emitter, real3 direction) {
    return aimed_density(scene, emitter->x, direction, fmax(dot(emitter->ng, direction), 0.0) * INV_PI, AIM_FROM_LIGHT);
}

real3 sample_emitter_emission(const Scene *scene, const Vertex *emitter, Rng *rng) {
    real3 direction;
    if (sample_aim(scene, emitter->x, AIM_FROM_LIGHT, rng, &direction)) return direction;
    real u = rng_uniform(rng), angle = 2.0 * PI * rng_uniform(rng), radius = sqrt(u);
    return about_axis(emitter->ng, sqrt(1.0 - u), radius, angle);
}

#endif
