// A chain between launches: its path's random content (directions, lengths, triangles, lobes) and what is known of its
// density. The struct is generated from pylmc/device/tables.py; the nodes are placed anew from triangle and barycentrics.
#ifndef PYLMC_CHAIN_STATE
#define PYLMC_CHAIN_STATE

#include "path/independent.cl"

void load_path(const Scene *scene, __global const ChainState *state, Path *path) {
    path->length = state->length;
    path->ending = state->ending;
    path->light = state->light;
    start_at_camera(scene, &path->vertex[0]);
    for (int i = 1; i <= path->length; i++) {
        __global const ChainVertex *stored = &state->vertex[i - 1];
        Vertex *vertex = &path->vertex[i];
        if (i == path->length && path->ending == ENDING_CONNECT)
            place_at_light(scene, path->light, vertex);
        else
            place_on_triangle(scene, stored->triangle, stored->bu, stored->bv, vertex);
        vertex->v = vec3(stored->v);
        vertex->t = stored->t;
        vertex->lobe = i < path->length ? lobe_like(scene, vertex->material, stored->lobe) : -1;
    }
}

void store_path(const Scene *scene, const Path *path, __global ChainState *state) {
    state->length = path->length;
    state->ending = path->ending;
    state->light = path->light;
    for (int i = 1; i <= path->length; i++) {
        __global ChainVertex *stored = &state->vertex[i - 1];
        const Vertex *vertex = &path->vertex[i];
        bool on_light = path->ending == ENDING_CONNECT && i == path->length;
        vstore3(vertex->v, 0, stored->v);
        stored->t = vertex->t;
        stored->bu = on_light ? 0.0 : vertex->bu;
        stored->bv = on_light ? 0.0 : vertex->bv;
        stored->triangle = on_light ? -1 : vertex->triangle;
        stored->lobe = i < path->length ? scene->lobes[vertex->lobe].signature : -1;
    }
}

#endif
