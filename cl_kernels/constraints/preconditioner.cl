// The factor L of the preconditioner for a leading block of a path: directions 1 .. m move and the rest of the path stays.
//
// One sweep along the path carries the tangents and adds each constraint where it arises. What follows the block is a fixed
// point, x_{m+1}: the light of *connect*, or the next node, which is then joined as a light would be (theory.md, 2, Blocks).
#ifndef PYLMC_PRECONDITIONER
#define PYLMC_PRECONDITIONER

#include "constraints/constraints.cl"
#include "moves/drift.cl"

// Without any of these nothing needs the tangents, and L is the bounds' diagonal: an isotropic step.
#define NEEDS_TANGENTS (USE_LOBES || USE_PORTALS || USE_OBJECTS || USE_NORMALS || DRIFT)

// The sweep: constraints (and the gradient) that depend on how the path moves. p is the frame at v_1.
void add_moving_constraints(const Scene *scene, const Path *path, int m, real3 p, const Chart *charts, Factor *factor,
                            Row *gradient) {
    int blocks = (factor->n + LANES - 1) / LANES;
    Tangent zero = tangent_scaled((real3)(0.0), (real8)(0.0));
    Tangent dx[COLUMN_BLOCKS], dv[COLUMN_BLOCKS], dn[COLUMN_BLOCKS];
    for (int b = 0; b < blocks; b++) {
        dx[b] = dv[b] = dn[b] = zero;
        gradient->block[b] = (real8)(0.0);
    }
#if HAS_DEVIATION
    // the frame is needed up to the last deviation of the block, or not at all
    Tangent dp[COLUMN_BLOCKS];
    int last_deviation = 0;
    for (int j = 2; j <= m; j++)
        if (charts[j].kind == KIND_DEVIATION) last_deviation = j;
#endif
    real3 x = path->vertex[0].x;
    for (int j = 1; j <= m; j++) {
        const Chart *chart = &charts[j];
        const Vertex *here = &path->vertex[j - 1], *next = &path->vertex[j];
        Tangent dx0[COLUMN_BLOCKS], dv_in[COLUMN_BLOCKS];
#if HAS_DEVIATION
        bool with_frame = j <= last_deviation;
        real3 s, arriving_p = p;
        if (j > 1 && with_frame) {
            s = reference_direction(scene, here, here->v);
            p = transport_frame(scene, here, here->v, p, s);
        }
#endif
        for (int b = 0; b < blocks; b++) {
            real8 unit1 = column_unit(b, 2 * j - 2), unit2 = column_unit(b, 2 * j - 1);
            dx0[b] = dx[b];
            dv_in[b] = dv[b];
#if HAS_DEVIATION
            Tangent ds, dp_s;
            if (j > 1 && with_frame) {
                ds = reference_tangent(scene, here, dv[b], dn[b]);
                dp_s = DIFFERENTIALS_REDUCED ? zero : frame_tangent(scene, here, arriving_p, s, dp[b], dv[b], dn[b], ds);
            }
            if (chart->kind == KIND_DEVIATION)
                dv[b] = deviation_tangent(chart, ds, dp_s, unit1, unit2);
            else if (chart->kind == KIND_PROJECTION)
                dv[b] = tangent_add(tangent_scaled(chart->e1, unit1), tangent_scaled(chart->e2, unit2));
            else
#endif
                dv[b] = aimed_tangent(chart, x, next->v, dx[b], unit1, unit2);
#if HAS_DEVIATION
#if !DIFFERENTIALS_REDUCED
            if (with_frame && j > 1) dp[b] = rotation_tangent(p, s, next->v, dp_s, ds, dv[b]);
            // the first frame follows v_1 by the minimal rotation: dp = -(p.dv) v
            if (with_frame && j == 1) dp[b] = tangent_scaled(next->v, -tangent_dot(p, dv[b]));
#endif
#endif
            dx[b] = node_tangent(next, dx[b], dv[b]);
#if DRIFT
#if CHART == CHART_ORTHOGRAPHIC
            if (chart->kind == KIND_DEVIATION)
                gradient->block[b] +=
                    (chart->omega.x * unit1 + chart->omega.y * unit2) / fmax(1.0 - dot(chart->omega, chart->omega), 1e-6);
#endif
            if (chart->kind >= KIND_NODE) {
                Tangent moved =
                    tangent_sub(tangent_add(tangent_scaled(chart->e1, unit1), tangent_scaled(chart->e2, unit2)), dx0[b]);
                gradient_add_target(chart->normal, next->v, distance(chart->anchor, x), b, dv[b], moved, gradient);
            }
#endif
        }
#if DRIFT
        if (j == 1)
            gradient_add_camera(scene, next->v, dv, blocks, gradient);
        else
            gradient_add_lobe(scene, here, next->v, dv_in, dv, dn, blocks, gradient);
#endif
#if HAS_DEVIATION
        if (j > 1 && with_frame) p = rotate_minimal(p, s, next->v);
#endif
        Curvature curvature = curvature_at(scene, next);
        for (int b = 0; b < blocks; b++) dn[b] = normal_tangent(&curvature, dx[b]);
        if (chart->kind == KIND_DEVIATION) constrain_free_lobe(scene, here, chart, 2 * j - 2, factor);
        constrain_portals(scene, x, next, dx0, dx, chart->kind - KIND_PORTAL, blocks, factor);
        if (HAS_SMALL_OBJECTS || j == path->length) constrain_object(scene, next, dx, blocks, factor);
        constrain_normal(next, &curvature, dn, blocks, factor);
        x = next->x;
    }
    if (m == path->length) return;
    // the segment to the fixed point x_{m+1}
    const Vertex *here = &path->vertex[m], *next = &path->vertex[m + 1];
    Tangent domega[COLUMN_BLOCKS], still[COLUMN_BLOCKS], dv_in[COLUMN_BLOCKS];
    bool wide = reference_of(scene, here) == REFERENCE_NORMAL;
    real3 s = wide ? next->v : reference_direction(scene, here, here->v);
    for (int b = 0; b < blocks; b++) {
        dv_in[b] = dv[b];
        dv[b] = is_infinite(next) ? zero : tangent_times(tangent_across(next->v, dx[b]), (real8)(-1.0 / next->t));
        // a lobe about the normal does not mind where its light goes, but one radian is still as far as a linear step is good
        domega[b] = wide ? dv[b] : tangent_sub(dv[b], reference_tangent(scene, here, dv_in[b], dn[b]));
        still[b] = zero;
    }
    // and light from infinity keeps its direction, whatever the node does
    if (!(wide && is_infinite(next))) constrain_dependent_lobe(scene, here, s, domega, blocks, factor);
#if DRIFT
    gradient_add_lobe(scene, here, next->v, dv_in, dv, dn, blocks, gradient);
    // 1/r^2 of the light; or the joint's |n.v| / r^2, and the next node's lobe
    for (int b = 0; b < blocks && !is_infinite(next); b++) gradient->block[b] += 2.0 / next->t * tangent_dot(next->v, dx[b]);
    if (m < free_directions(path)) {
        for (int b = 0; b < blocks; b++) gradient->block[b] += tangent_dot(next->ng, dv[b]) / dot(next->ng, next->v);
        if (m + 1 < path->length) gradient_add_lobe(scene, next, path->vertex[m + 2].v, dv, still, still, blocks, gradient);
    }
#endif
    constrain_portals(scene, x, next, dx, still, -1, blocks, factor);
#if HAS_NARROW
    // the next node's lobe sees its light arrive from elsewhere and must send it on as before
    if (m + 1 < path->length && reference_of(scene, next) != REFERENCE_NORMAL) {
        for (int b = 0; b < blocks; b++) domega[b] = tangent_times(reference_tangent(scene, next, dv[b], zero), (real8)(-1.0));
        constrain_dependent_lobe(scene, next, reference_direction(scene, next, next->v), domega, blocks, factor);
    }
#endif
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
