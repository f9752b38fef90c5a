// Directions stay in their lobes (theory.md, 5; pylmc/constraints/lobes.py).
#ifndef PYLMC_CONSTRAINT_LOBES
#define PYLMC_CONSTRAINT_LOBES

#include "charts/sweep.cl"
#include "constraints/factor.cl"

// A free deviation (13), (14): a unit block on Omega, in the lobe's own axes.
void constrain_free_lobe(const Scene *scene, const Vertex *vertex, const Chart *chart, int column, Factor *factor) {
    real3 inward, sideways;
    real2 width;
    lobe_axes(scene, vertex, chart->anchor, &inward, &sideways, &width);
    real2 axes[2] = {(real2)(dot(inward, chart->e1), dot(inward, chart->e2)),
                     (real2)(dot(sideways, chart->e1), dot(sideways, chart->e2))};
    real widths[2] = {width.x, width.y};
    for (int r = 0; r < 2; r++) {
        Row row;
        for (int b = 0; b < COLUMN_BLOCKS; b++)
            row.block[b] = (axes[r].x * column_unit(b, column) + axes[r].y * column_unit(b, column + 1)) / widths[r];
        factor_add_row(factor, &row, column);
    }
    factor->constraints++;
}

// A lobe whose deviation depends on the coordinates (15), (16): by d(v - s). A lobe about the normal does not mind where its
// light goes, but one radian is still as far as a linear step is good; where nothing turns it, it is no constraint.
void constrain_dependent_lobe(const Scene *scene, const Segment *segment, Factor *factor) {
    const Vertex *here = segment->here;
    bool wide = reference_of(scene, here) == REFERENCE_NORMAL;
    if (wide && (segment->past || is_infinite(segment->next))) return;
    if (segment->past && !HAS_NARROW) return;
    real3 s = wide ? segment->next->v : reference_direction(scene, here, here->v);
    Tangent domega[COLUMN_BLOCKS];
    for (int b = 0; b < segment->blocks; b++)
        domega[b] = wide
                        ? segment->dv[b]
                        : tangent_sub(segment->dv[b], reference_tangent(scene, here, segment->dv_here[b], segment->dn_here[b]));
    real3 inward, sideways;
    real2 width;
    lobe_axes(scene, here, s, &inward, &sideways, &width);
    Row row;
    for (int b = 0; b < segment->blocks; b++) row.block[b] = tangent_dot(inward, domega[b]) / width.x;
    factor_add_row(factor, &row, 0);
    for (int b = 0; b < segment->blocks; b++) row.block[b] = tangent_dot(sideways, domega[b]) / width.y;
    factor_add_row(factor, &row, 0);
    factor->constraints++;
}

void constrain_lobes(const Scene *scene, const Path *path, const Segment *segment, Factor *factor) {
    if (!segment->chart)
        constrain_dependent_lobe(scene, segment, factor);
    else if (segment->chart->kind == KIND_DEVIATION)
        constrain_free_lobe(scene, segment->here, segment->chart, 2 * segment->j - 2, factor);
}

#endif
