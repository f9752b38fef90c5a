// Aimed directions (theory.md, 6: the independent sampler's first direction goes, part of the time, to a uniform point of an
// aperture). Targets are apertures, aimed at uniformly in area, and small objects, aimed at uniformly in the cone of their
// bounding sphere. With AIM_EVERYWHERE diffuse nodes and
// the camera aim too, for any segment may cross an aperture; without it the light alone does, as in theory.md.
#ifndef PYLMC_AIMING
#define PYLMC_AIMING

#include "random.cl"
#include "scene.cl"

#define AIM_FROM_LIGHT 0.5f
#define AIM_FROM_NODE (AIM_EVERYWHERE ? 0.25f : 0.0f)
#define AIM_FROM_CAMERA (AIM_EVERYWHERE ? 0.1f : 0.0f)  // a hole that the camera looks through covers few pixels and may be the brightest thing

#if NUM_TARGETS > 0

// An aperture is aimed at with a margin: rounding puts the geometry's edge to either side of the rectangle's, and a path in
// between would be all but impossible to draw, hence of enormous weight.
#define AIM_MARGIN 1.002f
float2 aimed_half_size(__global const Target *target) {
    return AIM_MARGIN * (float2)(target->half_size[0], target->half_size[1]) + 1e-6f;
}

// cos of the cone that the sphere fills, seen from x, as 1 - cos (small cones keep their digits); 2 from inside.
float cone_of_sphere(float3 x, __global const Target *target) {
    float sine2 = square(target->half_size[0]) / fmax(length2(vec3(target->centre) - x), 1e-30f);
    return sine2 < 1.0f ? sine2 / (1.0f + sqrt(1.0f - sine2)) : 2.0f;
}

float target_density(__global const Target *target, float3 x, float3 direction) {
    float3 to = vec3(target->centre) - x;
    if (target->sphere) {
        float spread = cone_of_sphere(x, target);
        if (spread >= 2.0f) return 0.25f * INV_PI;
        float3 axis = normalize(to);
        // 1 - cos of the angle between unit vectors, from their difference
        return 0.5f * length2(direction - axis) <= spread ? 0.5f * INV_PI / spread : 0.0f;
    }
    float3 normal = vec3(target->normal), axis = vec3(target->axis);
    float cosine = dot(direction, normal), height = dot(to, normal);
    if (cosine * height <= 0.0f) return 0.0f;
    float t = height / cosine;
    float3 offset = t * direction - to;
    float2 half_size = aimed_half_size(target);
    if (fabs(dot(offset, axis)) > half_size.x || fabs(dot(offset, cross(normal, axis))) > half_size.y) return 0.0f;
    return t * t / (4.0f * half_size.x * half_size.y * fabs(cosine));
}

float3 sample_target(__global const Target *target, float3 x, Rng *rng) {
    float u1 = rng_uniform(rng), u2 = rng_uniform(rng);
    float3 centre = vec3(target->centre), axis = vec3(target->axis);
    if (target->sphere) {
        float3 axis_of_cone = normalize(centre - x + (float3)(0.0f, 0.0f, 1e-30f));
        float fall = cone_of_sphere(x, target) * u1;  // 1 - cos
        float sine = sqrt(fmax(0.0f, fall * (2.0f - fall))), angle = 2.0f * PI * u2;
        float3 tangent = any_tangent(axis_of_cone);
        return normalize(sine * cos(angle) * tangent + sine * sin(angle) * cross(axis_of_cone, tangent) +
                         (1.0f - fall) * axis_of_cone);
    }
    float3 bitangent = cross(vec3(target->normal), axis);
    float2 half_size = aimed_half_size(target);
    float3 point = centre + (2.0f * u1 - 1.0f) * half_size.x * axis + (2.0f * u2 - 1.0f) * half_size.y * bitangent;
    return normalize(point - x);
}

#endif

// The density of a direction that is aimed with the given probability and else drawn with density `otherwise`.
float aimed_density(const Scene *scene, float3 x, float3 direction, float otherwise, float probability) {
#if NUM_TARGETS > 0
    if (probability == 0.0f) return otherwise;
    float aimed = 0.0f;
    for (int i = 0; i < NUM_TARGETS; i++) aimed += target_density(&scene->targets[i], x, direction);
    return (1.0f - probability) * otherwise + probability * aimed / NUM_TARGETS;
#else
    return otherwise;
#endif
}

// Aim with the given probability; false where the caller is to draw the direction by its own means.
bool sample_aim(const Scene *scene, float3 x, float probability, Rng *rng, float3 *direction) {
#if NUM_TARGETS > 0
    if (rng_uniform(rng) >= probability) return false;
    *direction = sample_target(&scene->targets[rng_index(rng, NUM_TARGETS)], x, rng);
    return true;
#else
    return false;
#endif
}

#endif
