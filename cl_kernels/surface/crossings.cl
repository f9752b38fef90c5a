// Which aperture a segment passes through, and where.
#ifndef PYLMC_CROSSINGS
#define PYLMC_CROSSINGS

#include "surface/scene.cl"

// Does the segment from x along v, of length t, pass through this aperture? Then at `point`.
bool crosses_aperture(__global const Aperture *aperture, real3 x, real3 v, real t, real3 *point) {
    real3 normal = vec3(aperture->normal), to = vec3(aperture->centre) - x;
    real cosine = dot(v, normal), height = dot(to, normal);
    if (!(cosine * height > 0.0)) return false;
    real at = height / cosine;
    if (at >= t) return false;
    real3 offset = at * v - to, axis = vec3(aperture->axis);
    *point = x + at * v;
    return fabs(dot(offset, axis)) <= aperture->half_size[0] &&
           fabs(dot(offset, cross(normal, axis))) <= aperture->half_size[1];
}

// The first aperture in the scene's order that the segment passes through, or -1.
int aperture_crossed(const Scene *scene, real3 x, real3 v, real t, real3 *point) {
#if NUM_APERTURES > 0
    for (int i = 0; i < NUM_APERTURES; i++)
        if (crosses_aperture(&scene->apertures[i], x, v, t, point)) return i;
#endif
    return -1;
}

#endif
