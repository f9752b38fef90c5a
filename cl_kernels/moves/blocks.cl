// Leading blocks (theory.md, 2, Blocks): a small step moves directions 1 .. m and leaves the rest of the path where it is.
//
// Without BLOCKS every step moves all free directions. Which m may be drawn depends on the path's narrow nodes alone. A step that changes those is rejected, so that the draw has
// the same probability in both directions and cancels.
#ifndef PYLMC_BLOCKS
#define PYLMC_BLOCKS

#include "path/path.cl"

// A shorter block ends where the path can be joined again with ease: between two wide nodes.
bool block_allowed(const Scene *scene, const Path *path, int m) {
    if (m == free_directions(path)) return true;
#if BLOCKS
    if (is_narrow(scene, &path->vertex[m])) return false;
    return m + 1 == path->length || !is_narrow(scene, &path->vertex[m + 1]);
#else
    return false;
#endif
}

int choose_block(const Scene *scene, const Path *path, real u) {
    int free_count = free_directions(path), allowed = 0;
    for (int m = 1; m <= free_count; m++) allowed += block_allowed(scene, path, m);
    int wanted = min((int)(u * allowed), allowed - 1);
    for (int m = 1; m <= free_count; m++)
        if (block_allowed(scene, path, m) && wanted-- == 0) return m;
    return free_count;
}

#endif
