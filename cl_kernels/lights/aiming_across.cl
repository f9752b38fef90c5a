// Aimed lines of one direction: as lights/aiming.cl aims directions from one point. A line's density is by area across it.
#ifndef PYLMC_AIMING_ACROSS
#define PYLMC_AIMING_ACROSS

#include "lights/aiming.cl"

#if NUM_TARGETS > 0

// Of the line through x: uniform over a sphere's disc, or in the area of a portal.
real target_density_across(__global const Target *target, real3 x, real3 direction) {
    real3 to = vec3(target->centre) - x;
    if (target->sphere) {
        real radius2 = square(target->half_size[0]);
        return length2(to - dot(to, direction) * direction) <= radius2 ? INV_PI / radius2 : 0.0;
    }
    real3 normal = vec3(target->normal), axis = vec3(target->axis);
    real cosine = dot(direction, normal);
    if (cosine == 0.0) return 0.0;
    real3 offset = dot(to, normal) / cosine * direction - to;
    real2 half_size = aimed_half_size(target);
    if (fabs(dot(offset, axis)) > half_size.x || fabs(dot(offset, cross(normal, axis))) > half_size.y) return 0.0;
    return 1.0 / (4.0 * half_size.x * half_size.y * fabs(cosine));
}

real3 sample_target_across(__global const Target *target, real3 direction, Rng *rng) {
    real u1 = rng_uniform(rng), u2 = rng_uniform(rng);
    real3 centre = vec3(target->centre), axis = vec3(target->axis);
    if (target->sphere) { return centre + across_axis(direction, target->half_size[0] * sqrt(u1), 2.0 * PI * u2); }
    real2 half_size = aimed_half_size(target);
    return centre + (2.0 * u1 - 1.0) * half_size.x * axis + (2.0 * u2 - 1.0) * half_size.y * cross(vec3(target->normal), axis);
}

#endif

// The density of the line through x that is drawn with density `otherwise` where it is not aimed.
real density_across(const Scene *scene, real3 x, real3 direction, real otherwise) {
#if NUM_TARGETS > 0
    real aimed = 0.0;
    for (int i = 0; i < NUM_TARGETS; i++) aimed += target_density_across(&scene->targets[i], x, direction);
    return (1.0 - AIM_FROM_LIGHT) * otherwise + AIM_FROM_LIGHT * aimed / NUM_TARGETS;
#else
    return otherwise;
#endif
}

// A point of an aimed line; false where the caller is to draw it by its own means.
bool sample_across(const Scene *scene, real3 direction, Rng *rng, real3 *passed) {
#if NUM_TARGETS > 0
    if (rng_uniform(rng) >= AIM_FROM_LIGHT) return false;
    *passed = sample_target_across(&scene->targets[rng_index(rng, NUM_TARGETS)], direction, rng);
    return true;
#else
    return false;
#endif
}

#endif
