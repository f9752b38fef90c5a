// Tangents dx_k, dv_k, dn_k of the path in each of its coordinates, carried along it (forward mode; theory.md, 4; eqs.
// (15), (18)). Eight coordinates lie side by side in a real8, so that one pass serves eight columns.
//
// With DIFFERENTIALS_REDUCED normals and frames count as fixed: dn = dp = 0. Any Q that is a function of the state keeps the
// chain exact, so this costs efficiency only (theory.md, 4).
#ifndef PYLMC_DIFFERENTIALS
#define PYLMC_DIFFERENTIALS

#include "charts/charts.cl"

#define LANES 8
#define COLUMN_BLOCKS ((2 * MAX_DEPTH + LANES - 1) / LANES)
#define COLUMNS (LANES * COLUMN_BLOCKS)

// A three-vector for each of eight coordinates.
typedef struct {
    real8 x, y, z;
} Tangent;

Tangent tangent_scaled(real3 a, real8 s) {
    Tangent r = {a.x * s, a.y * s, a.z * s};
    return r;
}
Tangent tangent_times(Tangent a, real8 s) {
    Tangent r = {a.x * s, a.y * s, a.z * s};
    return r;
}
Tangent tangent_add(Tangent a, Tangent b) {
    Tangent r = {a.x + b.x, a.y + b.y, a.z + b.z};
    return r;
}
Tangent tangent_sub(Tangent a, Tangent b) {
    Tangent r = {a.x - b.x, a.y - b.y, a.z - b.z};
    return r;
}
real8 tangent_dot(real3 a, Tangent b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Tangent tangent_cross(real3 a, Tangent b) {
    Tangent r = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return r;
}
Tangent tangent_across(real3 n, Tangent a) { return tangent_sub(a, tangent_scaled(n, tangent_dot(n, a))); }

// One in the lane of coordinate `column`, if it is in this block of columns.
real8 column_unit(int block, int column) {
    return convert_real8(-((int8)(0, 1, 2, 3, 4, 5, 6, 7) + LANES * block == (int8)(column)));
}

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

// d of the reflection of w about n.
Tangent reflection_tangent(real3 w, real3 n, Tangent dw, Tangent dn) {
    real8 twice = 2.0 * (tangent_dot(n, dw) + tangent_dot(w, dn));
    return tangent_sub(tangent_sub(dw, tangent_scaled(n, twice)), tangent_times(dn, (real8)(2.0 * dot(w, n))));
}

// ds of the lobe's reference direction.
Tangent reference_tangent(const Scene *scene, const Vertex *vertex, Tangent dv, Tangent dn) {
    real facing = dot(vertex->ns, vertex->v) < 0.0 ? 1.0 : -1.0;
    real3 n = facing * vertex->ns;
    dn = tangent_times(dn, (real8)(facing));
    if (vertex->lobe == LOBE_DIFFUSE) return dn;
#if HAS_TRANSMIT
    if (vertex->lobe == LOBE_TRANSMIT) {
        real eta = 1.0 / relative_ior(&scene->materials[vertex->material], vertex, -vertex->v);
        real ci = -dot(vertex->v, n), ct2 = 1.0 - eta * eta * (1.0 - ci * ci);
        real8 dci = -(tangent_dot(n, dv) + tangent_dot(vertex->v, dn));
        if (ct2 <= 0.0) {  // total reflection: s runs along the surface
            real3 along = eta * vertex->v + eta * ci * n;
            Tangent d = tangent_add(tangent_add(tangent_times(dv, (real8)(eta)), tangent_scaled(n, eta * dci)),
                                    tangent_times(dn, (real8)(eta * ci)));
            return tangent_times(tangent_across(normalize(along), d), (real8)(rsqrt(fmax(length2(along), 1e-12))));
        }
        real ct = sqrt(fmax(ct2, 1e-4));
        real8 dct = eta * eta * ci / ct * dci;
        return tangent_add(tangent_add(tangent_times(dv, (real8)(eta)), tangent_scaled(n, eta * dci - dct)),
                           tangent_times(dn, (real8)(eta * ci - ct)));
    }
#endif
    return reflection_tangent(vertex->v, n, dv, dn);
}

// d of rotate_minimal(u, a, b).
Tangent rotation_tangent(real3 u, real3 a, real3 b, Tangent du, Tangent da, Tangent db) {
    real inverse = 1.0 / fmax(1.0 + dot(a, b), 1e-6), k = dot(b, u) * inverse;
    real8 dk = inverse * (tangent_dot(u, db) + tangent_dot(b, du)) - k * inverse * (tangent_dot(b, da) + tangent_dot(a, db));
    Tangent turned = tangent_sub(du, tangent_scaled(a + b, dk));
    return tangent_sub(turned, tangent_times(tangent_add(da, db), (real8)(k)));
}

// dp of transport_frame.
Tangent frame_tangent(const Vertex *vertex, real3 p, real3 s, Tangent dp, Tangent dv, Tangent dn, Tangent ds) {
    if (vertex->lobe == LOBE_TRANSMIT) return rotation_tangent(p, vertex->v, s, dp, dv, ds);
    Tangent reflected = reflection_tangent(p, vertex->ns, dp, dn);
    if (vertex->lobe != LOBE_DIFFUSE) return reflected;
    return rotation_tangent(reflect_about(p, vertex->ns), reflect_about(vertex->v, vertex->ns), s, reflected,
                            reflection_tangent(vertex->v, vertex->ns, dv, dn), ds);
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

// dx of the node that the segment meets: dx_k = (1 - v n^T / (v.n)) (dx_{k-1} + t dv_k).
Tangent node_tangent(const Vertex *vertex, Tangent dx, Tangent dv) {
    Tangent moved = tangent_add(dx, tangent_times(dv, (real8)(vertex->t)));
    real cosine = dot(vertex->v, vertex->ng);
    cosine = copysign(fmax(fabs(cosine), 1e-6), cosine);
    return tangent_sub(moved, tangent_scaled(vertex->v, tangent_dot(vertex->ng, moved) / cosine));
}

#endif
