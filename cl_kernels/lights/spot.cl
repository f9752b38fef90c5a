// Spot lights: a cone about an axis, with a soft rim (pylmc/scene/lights/spot.py).
#ifndef PYLMC_SPOT_LIGHT
#define PYLMC_SPOT_LIGHT

#include "lights/aiming.cl"
#include "path/path.cl"

void spot_place(__global const Light *light, Vertex *end) { place_at_point(vec3(light->position), end); }

// 1 - cos of the angle with the axis, from the difference of unit vectors.
real spot_fall(__global const Light *light, real3 direction) { return 0.5 * length2(direction - vec3(light->direction)); }

real spot_emitted(__global const Light *light, real3 direction) {
    real rim = light->spread - light->full_spread;
    return square(clamp((light->spread - spot_fall(light, direction)) / fmax(rim, 1e-30), 0.0, 1.0));
}

real spot_density(const Scene *scene, __global const Light *light, real3 x, real3 direction) {
    real inside = spot_fall(light, direction) <= light->spread ? 0.5 * INV_PI / light->spread : 0.0;
    return aimed_density(scene, vec3(light->position), direction, inside, AIM_FROM_LIGHT);
}

real3 spot_sample(const Scene *scene, __global const Light *light, Rng *rng, Vertex *end) {
    real3 direction, axis = vec3(light->direction);
    if (sample_aim(scene, vec3(light->position), AIM_FROM_LIGHT, rng, &direction)) return direction;
    real fall = light->spread * rng_uniform(rng), angle = 2.0 * PI * rng_uniform(rng);
    real sine = sqrt(fmax(0.0, fall * (2.0 - fall)));
    return about_axis(axis, 1.0 - fall, sine, angle);
}

#endif
