// A normal keeps within one radian as its node moves (theory.md, 5; eqs. (17), (19); pylmc/constraints/normals.py): on curved
// faces only. Not within the lobe: the deviation is counted from the reference direction, which turns with the normal, so that
// the path stays in its lobe wherever it goes.
#ifndef PYLMC_CONSTRAINT_NORMALS
#define PYLMC_CONSTRAINT_NORMALS

#include "charts/sweep.cl"
#include "constraints/factor.cl"

void constrain_normals(const Scene *scene, const Path *path, const Segment *segment, Factor *factor) {
    if (!segment->chart || segment->curvature.flat) return;
    real3 axes[2];
    axes[0] = any_tangent(segment->next->ns);
    axes[1] = cross(segment->next->ns, axes[0]);
    for (int e = 0; e < 2; e++) {
        Row row;
        for (int b = 0; b < segment->blocks; b++) row.block[b] = tangent_dot(axes[e], segment->dn[b]);
        factor_add_row(factor, &row, 0);
    }
    factor->constraints++;
}

#endif
