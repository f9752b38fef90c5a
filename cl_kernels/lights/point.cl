// Point lights: the same in every direction (pylmc/scene/lights/point.py).
#ifndef PYLMC_POINT_LIGHT
#define PYLMC_POINT_LIGHT

#include "lights/aiming.cl"
#include "path/path.cl"

void point_place(__global const Light *light, Vertex *end) { place_at_point(vec3(light->position), end); }

real point_emitted(__global const Light *light, real3 direction) { return 1.0; }

real point_density(const Scene *scene, __global const Light *light, real3 x, real3 direction) {
    return aimed_density(scene, vec3(light->position), direction, 0.25 * INV_PI, AIM_FROM_LIGHT);
}

real3 point_sample(const Scene *scene, __global const Light *light, Rng *rng, Vertex *end) {
    real3 direction;
    if (sample_aim(scene, vec3(light->position), AIM_FROM_LIGHT, rng, &direction)) return direction;
    real u = rng_uniform(rng), angle = 2.0 * PI * rng_uniform(rng);
    real z = 1.0 - 2.0 * u, radius = sqrt(fmax(0.0, 1.0 - z * z));
    return (real3)(radius * cos(angle), radius * sin(angle), z);
}

#endif
