// The pinhole camera x_0 and its film. Importance W(v_1) = 1 / (A cos^3) over the film (A: its area at unit distance)
// integrates to one over the directions that meet the film, so b is the image's mean luminance.
#ifndef PYLMC_CAMERA
#define PYLMC_CAMERA

#include "aiming.cl"

// Film coordinates in [0, 1)^2, x to the right and y down, of direction v; false where it misses the film.
bool film_position(const Scene *scene, float3 v, float2 *position) {
    __global const Camera *camera = scene->camera;
    float depth = dot(v, vec3(camera->forward));
    if (depth <= 0.0f) return false;
    float2 tangent = (float2)(dot(v, vec3(camera->right)), -dot(v, vec3(camera->up))) / depth;
    *position = 0.5f * tangent / (float2)(camera->tan_x, camera->tan_y) + 0.5f;
    return position->x >= 0.0f && position->x < 1.0f && position->y >= 0.0f && position->y < 1.0f;
}

float3 film_direction(const Scene *scene, float2 position) {
    __global const Camera *camera = scene->camera;
    float2 tangent = (2.0f * position - 1.0f) * (float2)(camera->tan_x, -camera->tan_y);
    return normalize(vec3(camera->forward) + tangent.x * vec3(camera->right) + tangent.y * vec3(camera->up));
}

// W(v_1), which is also the density of a direction through a uniform point of the film; 0 off the film.
float camera_importance(const Scene *scene, float3 v) {
    float2 position;
    if (!film_position(scene, v, &position)) return 0.0f;
    float cosine = dot(v, vec3(scene->camera->forward));
    return 1.0f / (4.0f * scene->camera->tan_x * scene->camera->tan_y * cosine * cosine * cosine);
}

// The independent sampler's first direction: through a uniform point of the film, or aimed; and its density.
float3 sample_camera(const Scene *scene, Rng *rng) {
    float3 direction;
    if (sample_aim(scene, vec3(scene->camera->origin), AIM_FROM_CAMERA, rng, &direction)) return direction;
    float x = rng_uniform(rng), y = rng_uniform(rng);
    return film_direction(scene, (float2)(x, y));
}

float camera_density(const Scene *scene, float3 v) {
    return aimed_density(scene, vec3(scene->camera->origin), v, camera_importance(scene, v), AIM_FROM_CAMERA);
}

// The weight of the target at a film position (pylmc/evenness.py): bilinear on a coarse grid over the film.
float film_weight(const Scene *scene, float3 v) {
    float2 position;
    if (!film_position(scene, v, &position)) return 1.0f;
    float2 at = clamp(position * EVENNESS_GRID - 0.5f, 0.0f, EVENNESS_GRID - 1.001f);
    int2 cell = convert_int2(at);
    float2 share = at - convert_float2(cell);
    __global const float *row = scene->evenness + cell.y * EVENNESS_GRID + cell.x;
    return mix(mix(row[0], row[1], share.x), mix(row[EVENNESS_GRID], row[EVENNESS_GRID + 1], share.x), share.y);
}

int pixel_of(const Scene *scene, float3 v) {
    float2 position;
    if (!film_position(scene, v, &position)) return -1;
    int width = scene->camera->width, height = scene->camera->height;
    return min((int)(position.y * height), height - 1) * width + min((int)(position.x * width), width - 1);
}

#endif
