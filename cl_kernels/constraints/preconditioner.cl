// The factor L of the preconditioner for a leading block of a path: directions 1 .. m move and the rest of the path stays
// (theory.md, 5).
//
// The constraints are rows: a row is the differential of one function of the path over its width, so that the constraint is
// |row . delta X| <= 1. Widths that are infinite have no row. One sweep along the path carries the derivatives, and each
// constraint adds its rows where it arises. What follows the block is a fixed point, x_{m+1}: the light of *connect*, or the
// next node, which is then joined as a light would be (theory.md, 2, Blocks).
//
// CONSTRAINTS(F) is F(name) for each kind that the scene has and the settings keep, CONSTRAINT_FILES are their files
// (pylmc/device/tables.py). A file defines constrain_name, as constraints/objects.cl does. The bounds are always there.
#ifndef PYLMC_PRECONDITIONER
#define PYLMC_PRECONDITIONER

#include "constraints/bounds.cl"
#include CONSTRAINT_FILES
#include "moves/drift.cl"

// What this segment adds to L, and to the gradient for the drift.
void add_segment(const Scene *scene, const Path *path, const Segment *segment, Factor *factor, Row *gradient) {
#if DRIFT
    gradient_add_segment(scene, segment, gradient);
#endif
#define CONSTRAINT_CASE(name) constrain_##name(scene, path, segment, factor);
    CONSTRAINTS(CONSTRAINT_CASE)
#undef CONSTRAINT_CASE
}

// Constraints (and the gradient) that depend on how the path moves. p is the frame at v_1.
void add_moving_constraints(const Scene *scene, const Path *path, int m, real3 p, const Chart *charts, Factor *factor,
                            Row *gradient) {
    int last_deviation = 0;  // the frame is needed up to the last deviation of the block, or not at all
    for (int j = 2; j <= m; j++)
        if (charts[j].kind == KIND_DEVIATION) last_deviation = j;
    Segment segment;
    sweep_start(factor->n, p, &segment);
    for (int b = 0; b < segment.blocks; b++) gradient->block[b] = (real8)(0.0);
    for (int j = 1; j <= m; j++) {
        sweep_own(scene, path, j, &charts[j], j <= last_deviation, &segment);
        add_segment(scene, path, &segment, factor, gradient);
    }
    if (m == path->length) return;
    sweep_joint(path, m + 1, &segment);
    add_segment(scene, path, &segment, factor, gradient);
    if (m + 1 == path->length || !(HAS_NARROW || DRIFT)) return;
    sweep_past(path, m + 2, &segment);
    add_segment(scene, path, &segment, factor, gradient);
}

// L for directions 1 .. m of the path. p is the frame at v_1 that the charts were made with. With drift, the gradient of the
// log density in the charts' coordinates comes back as well.
void precondition(const Scene *scene, const Path *path, int m, real3 p, const Chart *charts, Factor *factor, Row *gradient) {
    factor->n = 2 * m;
    factor->constraints = 0;
    for (int j = 1; j <= m; j++) constrain_direction(scene, &charts[j], j, path->vertex[j - 1].x, factor);
#if NEEDS_TANGENTS
    add_moving_constraints(scene, path, m, p, charts, factor, gradient);
#endif
    factor_finish(factor);
}

#endif
