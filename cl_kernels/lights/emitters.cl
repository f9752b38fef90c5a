// Where light comes from: point lights (the path connects to one) and emitting triangles (the path lands on one).
#ifndef PYLMC_EMITTERS
#define PYLMC_EMITTERS

#include "number/random.cl"
#include "surface/surface.cl"
#include "lights/aiming.cl"

// Which point light: probability in proportion to power.
int sample_point_light(const Scene *scene, Rng *rng) {
    real u = rng_uniform(rng);
    int light = 0;
    while (light < NUM_POINTS - 1 && u >= scene->points[light].cumulative) light++;
    return light;
}

real point_light_probability(const Scene *scene, int light) {
    return scene->points[light].cumulative - (light > 0 ? scene->points[light - 1].cumulative : 0.0);
}

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

// The direction in which a light path sets out, and its density in solid angle. A null vertex: from the point light.
real emission_density(const Scene *scene, const Vertex *emitter, real3 x, real3 direction) {
    real otherwise = emitter ? fmax(dot(emitter->ng, direction), 0.0) * INV_PI : 0.25 * INV_PI;
    return aimed_density(scene, x, direction, otherwise, AIM_FROM_LIGHT);
}

real3 sample_emission(const Scene *scene, const Vertex *emitter, real3 x, Rng *rng) {
    real3 direction;
    if (sample_aim(scene, x, AIM_FROM_LIGHT, rng, &direction)) return direction;
    real u = rng_uniform(rng), angle = 2.0 * PI * rng_uniform(rng);
    if (!emitter) {
        real z = 1.0 - 2.0 * u, radius = sqrt(fmax(0.0, 1.0 - z * z));
        return (real3)(radius * cos(angle), radius * sin(angle), z);
    }
    real radius = sqrt(u);
    real3 tangent = any_tangent(emitter->ng);
    return normalize(radius * cos(angle) * tangent + radius * sin(angle) * cross(emitter->ng, tangent) +
                     sqrt(1.0 - u) * emitter->ng);
}

#endif
