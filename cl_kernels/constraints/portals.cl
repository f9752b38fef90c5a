// A segment stays in each portal that it passes (theory.md, 5; eqs. (11), (20); pylmc/constraints/portals.py). In the portal
// whose own chart the direction takes the constraint is a unit block: see bounds.cl.
#ifndef PYLMC_CONSTRAINT_PORTALS
#define PYLMC_CONSTRAINT_PORTALS

#include "charts/sweep.cl"
#include "constraints/factor.cl"

void constrain_portals(const Scene *scene, const Path *path, const Segment *segment, Factor *factor) {
    if (segment->past) return;
    const Vertex *next = segment->next;
    real3 x = segment->here->x;
    int own = segment->chart ? segment->chart->kind - KIND_PORTAL : -1;
    for (int i = 0; i < NUM_PORTALS; i++) {
        real3 point;
        __global const Portal *portal = &scene->portals[i];
        if (i == own || !crosses_portal(portal, x, next->v, reach(next), &point)) continue;
        real3 normal = vec3(portal->normal), axes[2] = {vec3(portal->axis), cross(normal, vec3(portal->axis))};
        real share = dot(point - x, next->v) / reach(next);
        real cosine = dot(next->v, normal);
        Tangent moved[COLUMN_BLOCKS];
        for (int b = 0; b < segment->blocks; b++)
            moved[b] = tangent_add(tangent_times(segment->dx_here[b], (real8)(1.0 - share)),
                                   tangent_times(segment->dx[b], (real8)(share)));
        for (int e = 0; e < 2; e++) {
            real3 slanted = axes[e] - dot(axes[e], next->v) / cosine * normal;
            Row row;
            for (int b = 0; b < segment->blocks; b++) row.block[b] = tangent_dot(slanted, moved[b]) / portal->half_size[e];
            factor_add_row(factor, &row, 0);
        }
        factor->constraints += 2;
    }
}

#endif
