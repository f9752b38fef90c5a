// Light from infinity, of one direction (pylmc/scene/lights/directional.py). A light path is a line along it, drawn through a
// uniform point of the disc across it that covers the scene, or through one of a target.
#ifndef PYLMC_DIRECTIONAL_LIGHT
#define PYLMC_DIRECTIONAL_LIGHT

#include "lights/aiming_across.cl"
#include "path/path.cl"

void directional_place(__global const Light *light, Vertex *end) {
    end->place = PLACE_INFINITY;
    end->v = -vec3(light->direction);
    end->t = 1.0;
}

real directional_emitted(__global const Light *light, real3 direction) { return 1.0; }

real directional_density(const Scene *scene, __global const Light *light, real3 x, real3 direction) {
    return density_across(scene, x, direction, INV_PI / square(light->disc));
}

real3 directional_sample(const Scene *scene, __global const Light *light, Rng *rng, Vertex *end) {
    real3 direction = vec3(light->direction), passed;
    if (!sample_across(scene, direction, rng, &passed)) {
        real radius = light->disc * sqrt(rng_uniform(rng)), angle = 2.0 * PI * rng_uniform(rng);
        passed = across_axis(direction, radius, angle);
    }
    end->x = passed - (dot(passed, direction) + 2.0 * light->disc) * direction;  // before all of the scene
    return direction;
}

#endif
