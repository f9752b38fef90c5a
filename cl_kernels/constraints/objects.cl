// A node stays on its small object (theory.md, 5; eqs. (12), (17), (19); pylmc/constraints/objects.py). An emitter that the path
// must land on counts as small at any size.
#ifndef PYLMC_CONSTRAINT_OBJECTS
#define PYLMC_CONSTRAINT_OBJECTS

#include "charts/sweep.cl"
#include "constraints/factor.cl"

void constrain_objects(const Scene *scene, const Path *path, const Segment *segment, Factor *factor) {
    if (!segment->chart || !(HAS_SMALL_OBJECTS || segment->j == path->length)) return;
    __global const SceneObject *object = &scene->objects[scene->triangles[segment->next->triangle].object];
    if (!object->small) return;
    for (int axis = 0; axis < 3; axis++) {
        real inverse = object->inverse_half[axis];
        if (inverse == 0.0) continue;
        real3 direction = vec3(object->axes + 3 * axis);
        Row row;
        for (int b = 0; b < segment->blocks; b++) row.block[b] = inverse * tangent_dot(direction, segment->dx[b]);
        factor_add_row(factor, &row, 0);
    }
    factor->constraints++;
}

#endif
