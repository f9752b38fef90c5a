// The pinhole camera x_0 and its film. Importance W(v_1) = 1 / (A cos^3) over the film (A: its area at unit distance)
// integrates to one over the directions that meet the film, so b is the image's mean luminance.
#ifndef PYLMC_CAMERA
#define PYLMC_CAMERA

#include "lights/aiming.cl"
#include "path/path.cl"

void start_at_camera(const Scene *scene, Vertex *start) {
    start->place = PLACE_PINHOLE;
    start->x = vec3(scene->camera->origin);
}

// Film coordinates in [0, 1)^2, x to the right and y down, of direction v; false where it misses the film.
bool film_position(const Scene *scene, real3 v, real2 *position) {
    __global const Camera *camera = scene->camera;
    real depth = dot(v, vec3(camera->forward));
    if (depth <= 0.0) return false;
    real2 tangent = (real2)(dot(v, vec3(camera->right)), -dot(v, vec3(camera->up))) / depth;
    *position = 0.5 * tangent / (real2)(camera->tan_x, camera->tan_y) + 0.5;
    return position->x >= 0.0 && position->x < 1.0 && position->y >= 0.0 && position->y < 1.0;
}

real3 film_direction(const Scene *scene, real2 position) {
    __global const Camera *camera = scene->camera;
    real2 tangent = (2.0 * position - 1.0) * (real2)(camera->tan_x, -camera->tan_y);
    return normalize(vec3(camera->forward) + tangent.x * vec3(camera->right) + tangent.y * vec3(camera->up));
}

// W(v_1), which is also the density of a direction through a uniform point of the film; 0 off the film.
real camera_importance(const Scene *scene, real3 v) {
    real2 position;
    if (!film_position(scene, v, &position)) return 0.0;
    real cosine = dot(v, vec3(scene->camera->forward));
    return 1.0 / (4.0 * scene->camera->tan_x * scene->camera->tan_y * cosine * cosine * cosine);
}

// The independent sampler's first direction: through a uniform point of the film, or aimed; and its density.
real3 sample_camera(const Scene *scene, Rng *rng) {
    real3 direction;
    if (sample_aim(scene, vec3(scene->camera->origin), AIM_FROM_CAMERA, rng, &direction)) return direction;
    real x = rng_uniform(rng), y = rng_uniform(rng);
    return film_direction(scene, (real2)(x, y));
}

real camera_density(const Scene *scene, real3 v) {
    return aimed_density(scene, vec3(scene->camera->origin), v, camera_importance(scene, v), AIM_FROM_CAMERA);
}

// The weight of the chain's density at a film position (pylmc/sampling/evenness.py): bilinear on a coarse grid over the film.
real film_weight(const Scene *scene, real3 v) {
    real2 position;
    if (!film_position(scene, v, &position)) return 1.0;
    real2 at = clamp(position * EVENNESS_GRID - 0.5, 0.0, EVENNESS_GRID - 1.001);
    int2 cell = convert_int2(at);
    real2 share = at - convert_real2(cell);
    __global const float *row = scene->evenness + cell.y * EVENNESS_GRID + cell.x;
    real top = row[0], bottom = row[EVENNESS_GRID];
    top += (row[1] - top) * share.x;
    bottom += (row[EVENNESS_GRID + 1] - bottom) * share.x;
    return mix(top, bottom, share.y);
}

int pixel_of(const Scene *scene, real3 v) {
    real2 position;
    if (!film_position(scene, v, &position)) return -1;
    int width = scene->camera->width, height = scene->camera->height;
    return min((int)(position.y * height), height - 1) * width + min((int)(position.x * width), width - 1);
}

#endif
