// How a node, its normal and the direction that leaves it follow a moving path: derivatives in each of its coordinates (forward
// mode; theory.md, 4; eqs. (15), (18)).
//
// With DIFFERENTIALS_REDUCED normals and frames count as fixed: dn = dp = 0. Any Q that is a function of the state keeps the
// chain exact, so this costs efficiency only (theory.md, 4).
#ifndef PYLMC_DIFFERENTIALS
#define PYLMC_DIFFERENTIALS

#include "charts/charts.cl"
#include "charts/tangent.cl"

// How the shading normal turns as the node moves: dn = a (ga.dx) + b (gb.dx); all zero on flat faces.
typedef struct {
    real3 a, b, ga, gb;
    bool flat;
} Curvature;

Curvature curvature_at(const Scene *scene, const Vertex *vertex) {
    Curvature curvature;
    curvature.flat = true;
#if HAS_SMOOTH && !DIFFERENTIALS_REDUCED
    if (scene->triangles[vertex->triangle].smooth) {
        int i0 = scene->faces[3 * vertex->triangle], i1 = scene->faces[3 * vertex->triangle + 1],
            i2 = scene->faces[3 * vertex->triangle + 2];
        real3 p0 = load3(scene->vertices, i0), e1 = load3(scene->vertices, i1) - p0, e2 = load3(scene->vertices, i2) - p0;
        real3 n0 = load3(scene->normals, i0), n1 = load3(scene->normals, i1), n2 = load3(scene->normals, i2);
        real3 sum = (1.0 - vertex->bu - vertex->bv) * n0 + vertex->bu * n1 + vertex->bv * n2;
        real scale = copysign(rsqrt(fmax(length2(sum), 1e-20)), dot(sum, vertex->ns));
        real3 across1 = cross(e2, vertex->ng), across2 = cross(vertex->ng, e1);
        curvature.ga = across1 / dot(e1, across1);
        curvature.gb = across2 / dot(e2, across2);
        curvature.a = scale * (n1 - n0);
        curvature.b = scale * (n2 - n0);
        curvature.a -= dot(vertex->ns, curvature.a) * vertex->ns;
        curvature.b -= dot(vertex->ns, curvature.b) * vertex->ns;
        curvature.flat = length2(curvature.a) + length2(curvature.b) < 1e-12;  // vertex normals may all be equal
    }
#endif
    return curvature;
}

Tangent normal_tangent(const Curvature *curvature, Tangent dx) {
    if (curvature->flat) return tangent_scaled((real3)(0.0), (real8)(0.0));
    return tangent_add(tangent_scaled(curvature->a, tangent_dot(curvature->ga, dx)),
                       tangent_scaled(curvature->b, tangent_dot(curvature->gb, dx)));
}

// dv of a direction with a target chart, its node x moving by dx: aim at c + delta.
Tangent aimed_tangent(const Chart *chart, real3 x, real3 v, Tangent dx, real8 unit1, real8 unit2) {
    real3 towards = chart->anchor - x;
    Tangent moved = tangent_sub(tangent_add(tangent_scaled(chart->e1, unit1), tangent_scaled(chart->e2, unit2)), dx);
    return tangent_times(tangent_across(v, moved), (real8)(rsqrt(fmax(length2(towards), 1e-20))));
}

// dv of a direction with the deviation chart: the product rule on along * s + across * (Omega_p p + Omega_q q).
Tangent deviation_tangent(const Chart *chart, Tangent ds, Tangent dp, real8 unit1, real8 unit2) {
    real along, across;
    chart_coefficients(chart->omega, &along, &across);
    real2 slopes = chart_slopes(along, across);
    real8 half_drho2 = chart->omega.x * unit1 + chart->omega.y * unit2;
    real3 deviation = chart->omega.x * chart->e1 + chart->omega.y * chart->e2;
    Tangent dv = tangent_add(tangent_scaled(chart->anchor, slopes.x * half_drho2), tangent_times(ds, (real8)(along)));
    dv = tangent_add(dv, tangent_scaled(deviation, slopes.y * half_drho2));
    dv = tangent_add(dv, tangent_scaled(chart->e1, across * unit1));
    dv = tangent_add(dv, tangent_scaled(chart->e2, across * unit2));
#if !DIFFERENTIALS_REDUCED
    // q = s x p: dq = ds x p + s x dp
    Tangent dq = tangent_sub(tangent_cross(chart->anchor, dp), tangent_cross(chart->e1, ds));
    dv = tangent_add(dv, tangent_times(dp, (real8)(across * chart->omega.x)));
    dv = tangent_add(dv, tangent_times(dq, (real8)(across * chart->omega.y)));
#endif
    return dv;
}

// dv of a direction that has coordinates: x is the node that it leaves, dx how that moves; of a deviation, ds and dp are how its
// reference direction and frame do.
Tangent chart_tangent(const Chart *chart, real3 x, real3 v, Tangent dx, Tangent ds, Tangent dp, real8 unit1, real8 unit2) {
    if (HAS_DEVIATION && chart->kind == KIND_DEVIATION) return deviation_tangent(chart, ds, dp, unit1, unit2);
    if (!COORDINATES_TARGET && chart->kind == KIND_PROJECTION)
        return tangent_add(tangent_scaled(chart->e1, unit1), tangent_scaled(chart->e2, unit2));
    return aimed_tangent(chart, x, v, dx, unit1, unit2);
}

// dx of the node that the segment meets: dx_k = (1 - v n^T / (v.n)) (dx_{k-1} + t dv_k).
Tangent node_tangent(const Vertex *vertex, Tangent dx, Tangent dv) {
    Tangent moved = tangent_add(dx, tangent_times(dv, (real8)(vertex->t)));
    real cosine = dot(vertex->v, vertex->ng);
    cosine = copysign(fmax(fabs(cosine), 1e-6), cosine);
    return tangent_sub(moved, tangent_scaled(vertex->v, tangent_dot(vertex->ng, moved) / cosine));
}

#endif
