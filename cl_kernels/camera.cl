// The pinhole camera x_0 and its film. Importance W(v_1) = 1 / (A cos^3) over the film (A: its area at unit distance)
// integrates to one over the directions that meet the film, so b is the image's mean luminance.
#ifndef PYLMC_CAMERA
#define PYLMC_CAMERA

#include "scene.cl"

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

int pixel_of(const Scene *scene, float3 v) {
    float2 position;
    if (!film_position(scene, v, &position)) return -1;
    int width = scene->camera->width, height = scene->camera->height;
    return min((int)(position.y * height), height - 1) * width + min((int)(position.x * width), width - 1);
}

#endif
