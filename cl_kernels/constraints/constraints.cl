// The constraints of theory.md, 5, as rows: a row is the differential of one function of the path over its width, so that
// the constraint is |row . delta X| <= 1. Widths that are infinite have no row. Which kinds are compiled in is decided by
// pylmc/constraints/plan.py: HAS_NARROW (lobes), HAS_SMALL_OBJECTS, NUM_PORTALS; the bounds are always there. The setting
// `constraints` leaves kinds out by name: USE_LOBES, USE_PORTALS, USE_OBJECTS, USE_NORMALS.
#ifndef PYLMC_CONSTRAINTS
#define PYLMC_CONSTRAINTS

#include "constraints/factor.cl"

// A free deviation (13), (14): a unit block on Omega, in the lobe's own axes.
void constrain_free_lobe(const Scene *scene, const Vertex *vertex, const Chart *chart, int column, Factor *factor) {
#if USE_LOBES
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
#endif
}

// A lobe whose deviation depends on the coordinates (15), (16): domega is d(v - s).
void constrain_dependent_lobe(const Scene *scene, const Vertex *vertex, real3 s, const Tangent *domega, int blocks,
                              Factor *factor) {
#if USE_LOBES
    real3 inward, sideways;
    real2 width;
    lobe_axes(scene, vertex, s, &inward, &sideways, &width);
    Row row;
    for (int b = 0; b < blocks; b++) row.block[b] = tangent_dot(inward, domega[b]) / width.x;
    factor_add_row(factor, &row, 0);
    for (int b = 0; b < blocks; b++) row.block[b] = tangent_dot(sideways, domega[b]) / width.y;
    factor_add_row(factor, &row, 0);
    factor->constraints++;
#endif
}

// A node stays on its small object (12), (17), (19); an emitter that the path must land on counts as small at any size.
void constrain_object(const Scene *scene, const Vertex *vertex, const Tangent *dx, int blocks, Factor *factor) {
#if USE_OBJECTS && (HAS_SMALL_OBJECTS || HAS_EMITTERS)
    __global const SceneObject *object = &scene->objects[scene->triangles[vertex->triangle].object];
    if (!object->small) return;
    for (int axis = 0; axis < 3; axis++) {
        real inverse = object->inverse_half[axis];
        if (inverse == 0.0) continue;
        real3 direction = vec3(object->axes + 3 * axis);
        Row row;
        for (int b = 0; b < blocks; b++) row.block[b] = inverse * tangent_dot(direction, dx[b]);
        factor_add_row(factor, &row, 0);
    }
    factor->constraints++;
#endif
}

// The normal keeps within one radian as the node moves (17), (19): on curved faces only. Not within the lobe: the deviation is
// counted from the reference direction, which turns with the normal, so that the path stays in its lobe wherever it goes.
void constrain_normal(const Vertex *vertex, const Curvature *curvature, const Tangent *dn, int blocks, Factor *factor) {
#if HAS_SMOOTH && USE_NORMALS && !DIFFERENTIALS_REDUCED
    if (curvature->flat) return;
    real3 axes[2];
    axes[0] = any_tangent(vertex->ns);
    axes[1] = cross(vertex->ns, axes[0]);
    for (int e = 0; e < 2; e++) {
        Row row;
        for (int b = 0; b < blocks; b++) row.block[b] = tangent_dot(axes[e], dn[b]);
        factor_add_row(factor, &row, 0);
    }
    factor->constraints++;
#endif
}

// The segment from x to next stays in each portal that it passes (11), (20); dx0 and dx1 are its ends' tangents. `skip`
// is the portal whose own chart the direction takes: there the constraint is a unit block, added by constrain_direction.
void constrain_portals(const Scene *scene, real3 x, const Vertex *next, const Tangent *dx0, const Tangent *dx1, int skip,
                       int blocks, Factor *factor) {
#if NUM_PORTALS > 0 && USE_PORTALS
    for (int i = 0; i < NUM_PORTALS; i++) {
        real3 point;
        __global const Portal *portal = &scene->portals[i];
        if (i == skip || !crosses_portal(portal, x, next->v, reach(next), &point)) continue;
        real3 normal = vec3(portal->normal), axes[2] = {vec3(portal->axis), cross(normal, vec3(portal->axis))};
        real share = dot(point - x, next->v) / reach(next);
        real cosine = dot(next->v, normal);
        Tangent moved[COLUMN_BLOCKS];
        for (int b = 0; b < blocks; b++)
            moved[b] = tangent_add(tangent_times(dx0[b], (real8)(1.0 - share)), tangent_times(dx1[b], (real8)(share)));
        for (int e = 0; e < 2; e++) {
            real3 slanted = axes[e] - dot(axes[e], next->v) / cosine * normal;
            Row row;
            for (int b = 0; b < blocks; b++) row.block[b] = tangent_dot(slanted, moved[b]) / portal->half_size[e];
            factor_add_row(factor, &row, 0);
        }
        factor->constraints += 2;
    }
#endif
}

// What binds a direction's own two coordinates: the bounds (one radian, one chart unit; the film for v_1), and its
// portal where it has that chart. Fills L's diagonal, which is still empty there.
void constrain_direction(const Scene *scene, const Chart *chart, int j, real3 x, Factor *factor) {
    real2 weight2 = (real2)(1.0);
    real angle = j == 1 ? scene->camera->bound : 1.0;
    if (chart->kind >= KIND_NODE) weight2 /= length2(chart->anchor - x);
    weight2 /= angle * angle;
#if NUM_PORTALS > 0 && USE_PORTALS
    if (chart->kind >= KIND_PORTAL) {
        __global const Portal *portal = &scene->portals[chart->kind - KIND_PORTAL];
        weight2 += (real2)(1.0 / square(portal->half_size[0]), 1.0 / square(portal->half_size[1]));
        factor->constraints += 2;
    }
#endif
    int column = 2 * (j - 1);
    for (int b = 0; b < COLUMN_BLOCKS; b++) {
        factor->column[column][b] = column_unit(b, column) * sqrt(weight2.x);
        factor->column[column + 1][b] = column_unit(b, column + 1) * sqrt(weight2.y);
    }
    factor->constraints++;
}

#endif
