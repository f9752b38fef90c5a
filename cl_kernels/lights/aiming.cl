// Aimed directions (theory.md, 6: the independent sampler's first direction goes, part of the time, to a uniform point of an
// portal). Targets are portals, aimed at uniformly in area, and small objects, aimed at uniformly in the cone of their
// bounding sphere. With AIM_EVERYWHERE diffuse nodes and
// the camera aim too, for any segment may cross a portal; without it the light alone does, as in theory.md.
#ifndef PYLMC_AIMING
#define PYLMC_AIMING

#include "number/random.cl"
#include "surface/scene.cl"

#define AIM_FROM_LIGHT 0.5
#define AIM_FROM_NODE (AIM_EVERYWHERE ? 0.25 : 0.0)
#define AIM_FROM_CAMERA \
    (AIM_EVERYWHERE ? 0.1 : 0.0)  // a hole that the camera looks through covers few pixels and may be the brightest thing

#if NUM_TARGETS > 0

// A portal is aimed at with a margin: rounding puts the geometry's edge to either side of the rectangle's, and a path in
// between would be all but impossible to draw, hence of enormous weight. The part that does not grow with the hole is
// by how far the offsets of a segment's ends can move it sideways, and a little.
#define AIM_MARGIN 1.002
real2 aimed_half_size(__global const Target *target) {
    return AIM_MARGIN * (real2)(target->half_size[0], target->half_size[1]) + 1.25 * RAY_OFFSET;
}

// cos of the cone that the sphere fills, seen from x, as 1 - cos (small cones keep their digits); 2 from inside.
real cone_of_sphere(real3 x, __global const Target *target) {
    real sine2 = square(target->half_size[0]) / fmax(length2(vec3(target->centre) - x), 1e-30);
    return sine2 < 1.0 ? sine2 / (1.0 + sqrt(1.0 - sine2)) : 2.0;
}

real target_density(__global const Target *target, real3 x, real3 direction) {
    real3 to = vec3(target->centre) - x;
    if (target->sphere) {
        real spread = cone_of_sphere(x, target);
        if (spread >= 2.0) return 0.25 * INV_PI;
        real3 axis = normalize(to);
        // 1 - cos of the angle between unit vectors, from their difference
        return 0.5 * length2(direction - axis) <= spread ? 0.5 * INV_PI / spread : 0.0;
    }
    real3 normal = vec3(target->normal), axis = vec3(target->axis);
    real cosine = dot(direction, normal), height = dot(to, normal);
    if (cosine * height <= 0.0) return 0.0;
    real t = height / cosine;
    real3 offset = t * direction - to;
    real2 half_size = aimed_half_size(target);
    if (fabs(dot(offset, axis)) > half_size.x || fabs(dot(offset, cross(normal, axis))) > half_size.y) return 0.0;
    return t * t / (4.0 * half_size.x * half_size.y * fabs(cosine));
}

real3 sample_target(__global const Target *target, real3 x, Rng *rng) {
    real u1 = rng_uniform(rng), u2 = rng_uniform(rng);
    real3 centre = vec3(target->centre), axis = vec3(target->axis);
    if (target->sphere) {
        real3 axis_of_cone = normalize(centre - x + (real3)(0.0, 0.0, 1e-30));
        real fall = cone_of_sphere(x, target) * u1;  // 1 - cos
        real sine = sqrt(fmax(0.0, fall * (2.0 - fall)));
        return about_axis(axis_of_cone, 1.0 - fall, sine, 2.0 * PI * u2);
    }
    real3 bitangent = cross(vec3(target->normal), axis);
    real2 half_size = aimed_half_size(target);
    real3 point = centre + (2.0 * u1 - 1.0) * half_size.x * axis + (2.0 * u2 - 1.0) * half_size.y * bitangent;
    return normalize(point - x);
}

#endif

// The density of a direction that is aimed with the given probability and else drawn with density `otherwise`.
real aimed_density(const Scene *scene, real3 x, real3 direction, real otherwise, real probability) {
#if NUM_TARGETS > 0
    if (probability == 0.0) return otherwise;
    real aimed = 0.0;
    for (int i = 0; i < NUM_TARGETS; i++) aimed += target_density(&scene->targets[i], x, direction);
    return (1.0 - probability) * otherwise + probability * aimed / NUM_TARGETS;
#else
    return otherwise;
#endif
}

// Aim with the given probability; false where the caller is to draw the direction by its own means.
bool sample_aim(const Scene *scene, real3 x, real probability, Rng *rng, real3 *direction) {
#if NUM_TARGETS > 0
    if (rng_uniform(rng) >= probability) return false;
    *direction = sample_target(&scene->targets[rng_index(rng, NUM_TARGETS)], x, rng);
    return true;
#else
    return false;
#endif
}

#endif
