// Which portal a segment passes through, and where.
#ifndef PYLMC_CROSSINGS
#define PYLMC_CROSSINGS

#include "surface/scene.cl"

// Does the segment from x along v, of length t, pass through this portal? Then at `point`.
bool crosses_portal(__global const Portal *portal, real3 x, real3 v, real t, real3 *point) {
    real3 normal = vec3(portal->normal), to = vec3(portal->centre) - x;
    real cosine = dot(v, normal), height = dot(to, normal);
    if (!is_positive(cosine * height)) return false;
    real at = height / cosine;
    if (at >= t) return false;
    real3 offset = at * v - to, axis = vec3(portal->axis);
    *point = x + at * v;
    return fabs(dot(offset, axis)) <= portal->half_size[0] && fabs(dot(offset, cross(normal, axis))) <= portal->half_size[1];
}

// The first portal in the scene's order that the segment passes through, or -1.
int portal_crossed(const Scene *scene, real3 x, real3 v, real t, real3 *point) {
#if NUM_PORTALS > 0
    for (int i = 0; i < NUM_PORTALS; i++)
        if (crosses_portal(&scene->portals[i], x, v, t, point)) return i;
#endif
    return -1;
}

#endif
