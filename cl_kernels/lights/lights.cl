// Lights without area: the path is joined to one (ENDING_CONNECT). Which one, where it is, what it sends in a direction, and how
// a light path sets out from it.
//
// LIGHTS(F) is F(NUMBER, name) for each kind that the scene has, LIGHT_FILES are their files (pylmc/device/tables.py). A file
// defines name_place, name_emitted, name_density and name_sample, as lights/point.cl does.
#ifndef PYLMC_LIGHTS
#define PYLMC_LIGHTS

#include "lights/aiming.cl"
#include "path/path.cl"
#include LIGHT_FILES

// Which light: probability in proportion to power.
int sample_light(const Scene *scene, Rng *rng) {
    real u = rng_uniform(rng);
    int light = 0;
    while (light < NUM_LIGHTS - 1 && u >= scene->lights[light].cumulative) light++;
    return light;
}

real light_probability(const Scene *scene, int light) {
    return scene->lights[light].cumulative - (light > 0 ? scene->lights[light - 1].cumulative : 0.0);
}

// The end of a path that is joined to this light.
void place_at_light(const Scene *scene, int index, Vertex *end) {
    __global const Light *light = &scene->lights[index];
#define LIGHT_CASE(NUMBER, name)  \
    case NUMBER:                  \
        name##_place(light, end); \
        break;
    switch (light->kind) { LIGHTS(LIGHT_CASE) }
#undef LIGHT_CASE
}

// What the light sends in a direction, over the square of the distance: radiance times the falling light's solid angle.
real3 light_intensity(const Scene *scene, int index, real3 direction) {
    __global const Light *light = &scene->lights[index];
#define LIGHT_CASE(NUMBER, name) \
    case NUMBER:                 \
        return name##_emitted(light, direction) * vec3(light->intensity);
    switch (light->kind) { LIGHTS(LIGHT_CASE) }
#undef LIGHT_CASE
    return (real3)(0.0);
}

// Density of a light path's first segment, which runs along `direction` to the point x: in solid angle at the light, or, from
// infinity, in area across the direction.
real light_emission_density(const Scene *scene, int index, real3 x, real3 direction) {
    __global const Light *light = &scene->lights[index];
#define LIGHT_CASE(NUMBER, name) \
    case NUMBER:                 \
        return name##_density(scene, light, x, direction);
    switch (light->kind) { LIGHTS(LIGHT_CASE) }
#undef LIGHT_CASE
    return 0.0;
}

// Draw it: its direction; at infinity also where it passes, which becomes the position of `end`.
real3 sample_light_emission(const Scene *scene, int index, Rng *rng, Vertex *end) {
    __global const Light *light = &scene->lights[index];
#define LIGHT_CASE(NUMBER, name) \
    case NUMBER:                 \
        return name##_sample(scene, light, rng, end);
    switch (light->kind) { LIGHTS(LIGHT_CASE) }
#undef LIGHT_CASE
    return (real3)(0.0);
}

#endif
