// Tangents dx_k, dv_k, dn_k of the path in each of its coordinates, carried along it (forward mode; theory.md, 4; eqs.
// (15), (18)). Eight coordinates lie side by side in a float8, so that one pass serves eight columns.
#ifndef PYLMC_DIFFERENTIALS
#define PYLMC_DIFFERENTIALS

#include "charts.cl"

#define LANES 8
#define COLUMN_BLOCKS ((2 * MAX_DEPTH + LANES - 1) / LANES)
#define COLUMNS (LANES * COLUMN_BLOCKS)

// A three-vector for each of eight coordinates.
typedef struct { float8 x, y, z; } Tangent;

Tangent tangent_scaled(float3 a, float8 s) { Tangent r = {a.x * s, a.y * s, a.z * s}; return r; }
Tangent tangent_times(Tangent a, float8 s) { Tangent r = {a.x * s, a.y * s, a.z * s}; return r; }
Tangent tangent_add(Tangent a, Tangent b) { Tangent r = {a.x + b.x, a.y + b.y, a.z + b.z}; return r; }
Tangent tangent_sub(Tangent a, Tangent b) { Tangent r = {a.x - b.x, a.y - b.y, a.z - b.z}; return r; }
float8 tangent_dot(float3 a, Tangent b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Tangent tangent_cross(float3 a, Tangent b) {
    Tangent r = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return r;
}
Tangent tangent_across(float3 n, Tangent a) { return tangent_sub(a, tangent_scaled(n, tangent_dot(n, a))); }

// One in the lane of coordinate `column`, if it is in this block of columns.
float8 column_unit(int block, int column) {
    return convert_float8(-((int8)(0, 1, 2, 3, 4, 5, 6, 7) + LANES * block == (int8)(column)));
}

// How the shading normal turns as the node moves: dn = a (ga.dx) + b (gb.dx); all zero on flat faces.
typedef struct { float3 a, b, ga, gb; bool flat; } Curvature;

Curvature curvature_at(const Scene *scene, const Vertex *vertex) {
    Curvature curvature;
    curvature.flat = true;
#if HAS_SMOOTH
    if (scene->triangles[vertex->triangle].smooth) {
        int i0 = scene->faces[3 * vertex->triangle], i1 = scene->faces[3 * vertex->triangle + 1], i2 = scene->faces[3 * vertex->triangle + 2];
        float3 p0 = load3(scene->vertices, i0), e1 = load3(scene->vertices, i1) - p0, e2 = load3(scene->vertices, i2) - p0;
        float3 n0 = load3(scene->normals, i0), n1 = load3(scene->normals, i1), n2 = load3(scene->normals, i2);
        float3 sum = (1.0f - vertex->bu - vertex->bv) * n0 + vertex->bu * n1 + vertex->bv * n2;
        float scale = copysign(rsqrt(fmax(length2(sum), 1e-20f)), dot(sum, vertex->ns));
        float3 across1 = cross(e2, vertex->ng), across2 = cross(vertex->ng, e1);
        curvature.ga = across1 / dot(e1, across1);
        curvature.gb = across2 / dot(e2, across2);
        curvature.a = scale * (n1 - n0);
        curvature.b = scale * (n2 - n0);
        curvature.a -= dot(vertex->ns, curvature.a) * vertex->ns;
        curvature.b -= dot(vertex->ns, curvature.b) * vertex->ns;
        curvature.flat = length2(curvature.a) + length2(curvature.b) < 1e-12f;  // vertex normals may all be equal
    }
#endif
    return curvature;
}

Tangent normal_tangent(const Curvature *curvature, Tangent dx) {
    if (curvature->flat) return tangent_scaled((float3)(0.0f), (float8)(0.0f));
    return tangent_add(tangent_scaled(curvature->a, tangent_dot(curvature->ga, dx)), tangent_scaled(curvature->b, tangent_dot(curvature->gb, dx)));
}

// d of the reflection of w about n.
Tangent reflection_tangent(float3 w, float3 n, Tangent dw, Tangent dn) {
    float8 twice = 2.0f * (tangent_dot(n, dw) + tangent_dot(w, dn));
    return tangent_sub(tangent_sub(dw, tangent_scaled(n, twice)), tangent_times(dn, (float8)(2.0f * dot(w, n))));
}

// ds of the lobe's reference direction.
Tangent reference_tangent(const Scene *scene, const Vertex *vertex, Tangent dv, Tangent dn) {
    float facing = dot(vertex->ns, vertex->v) < 0.0f ? 1.0f : -1.0f;
    float3 n = facing * vertex->ns;
    dn = tangent_times(dn, (float8)(facing));
    if (vertex->lobe == LOBE_DIFFUSE) return dn;
#if HAS_TRANSMIT
    if (vertex->lobe == LOBE_TRANSMIT) {
        float eta = 1.0f / relative_ior(&scene->materials[vertex->material], vertex, -vertex->v);
        float ci = -dot(vertex->v, n), ct2 = 1.0f - eta * eta * (1.0f - ci * ci);
        float8 dci = -(tangent_dot(n, dv) + tangent_dot(vertex->v, dn));
        if (ct2 <= 0.0f) {  // total reflection: s runs along the surface
            float3 along = eta * vertex->v + eta * ci * n;
            Tangent d = tangent_add(tangent_add(tangent_times(dv, (float8)(eta)), tangent_scaled(n, eta * dci)), tangent_times(dn, (float8)(eta * ci)));
            return tangent_times(tangent_across(normalize(along), d), (float8)(rsqrt(fmax(length2(along), 1e-12f))));
        }
        float ct = sqrt(fmax(ct2, 1e-4f));
        float8 dct = eta * eta * ci / ct * dci;
        return tangent_add(tangent_add(tangent_times(dv, (float8)(eta)), tangent_scaled(n, eta * dci - dct)), tangent_times(dn, (float8)(eta * ci - ct)));
    }
#endif
    return reflection_tangent(vertex->v, n, dv, dn);
}

// d of rotate_minimal(u, a, b).
Tangent rotation_tangent(float3 u, float3 a, float3 b, Tangent du, Tangent da, Tangent db) {
    float inverse = 1.0f / fmax(1.0f + dot(a, b), 1e-6f), k = dot(b, u) * inverse;
    float8 dk = inverse * (tangent_dot(u, db) + tangent_dot(b, du)) - k * inverse * (tangent_dot(b, da) + tangent_dot(a, db));
    Tangent turned = tangent_sub(du, tangent_scaled(a + b, dk));
    return tangent_sub(turned, tangent_times(tangent_add(da, db), (float8)(k)));
}

// dp of transport_frame.
Tangent frame_tangent(const Vertex *vertex, float3 p, float3 s, Tangent dp, Tangent dv, Tangent dn, Tangent ds) {
    if (vertex->lobe == LOBE_TRANSMIT) return rotation_tangent(p, vertex->v, s, dp, dv, ds);
    Tangent reflected = reflection_tangent(p, vertex->ns, dp, dn);
    if (vertex->lobe != LOBE_DIFFUSE) return reflected;
    return rotation_tangent(reflect_about(p, vertex->ns), reflect_about(vertex->v, vertex->ns), s, reflected, reflection_tangent(vertex->v, vertex->ns, dv, dn), ds);
}

// dv of a direction with a target chart, its node x moving by dx: aim at c + delta.
Tangent aimed_tangent(const Chart *chart, float3 x, float3 v, Tangent dx, float8 unit1, float8 unit2) {
    float3 towards = chart->anchor - x;
    Tangent moved = tangent_sub(tangent_add(tangent_scaled(chart->e1, unit1), tangent_scaled(chart->e2, unit2)), dx);
    return tangent_times(tangent_across(v, moved), (float8)(rsqrt(fmax(length2(towards), 1e-20f))));
}

// dv of a direction with the deviation chart: the product rule on along * s + across * (Omega_p p + Omega_q q).
Tangent deviation_tangent(const Chart *chart, Tangent ds, Tangent dp, float8 unit1, float8 unit2) {
    float along, across;
    chart_coefficients(chart->omega, &along, &across);
    float2 slopes = chart_slopes(along, across);
    float8 half_drho2 = chart->omega.x * unit1 + chart->omega.y * unit2;
    float3 deviation = chart->omega.x * chart->e1 + chart->omega.y * chart->e2;
    // q = s x p: dq = ds x p + s x dp
    Tangent dq = tangent_sub(tangent_cross(chart->anchor, dp), tangent_cross(chart->e1, ds));
    Tangent dv = tangent_add(tangent_scaled(chart->anchor, slopes.x * half_drho2), tangent_times(ds, (float8)(along)));
    dv = tangent_add(dv, tangent_scaled(deviation, slopes.y * half_drho2));
    dv = tangent_add(dv, tangent_scaled(chart->e1, across * unit1));
    dv = tangent_add(dv, tangent_scaled(chart->e2, across * unit2));
    dv = tangent_add(dv, tangent_times(dp, (float8)(across * chart->omega.x)));
    return tangent_add(dv, tangent_times(dq, (float8)(across * chart->omega.y)));
}

// dx of the node that the segment meets: dx_k = (1 - v n^T / (v.n)) (dx_{k-1} + t dv_k).
Tangent node_tangent(const Vertex *vertex, Tangent dx, Tangent dv) {
    Tangent moved = tangent_add(dx, tangent_times(dv, (float8)(vertex->t)));
    float cosine = dot(vertex->v, vertex->ng);
    cosine = copysign(fmax(fabs(cosine), 1e-6f), cosine);
    return tangent_sub(moved, tangent_scaled(vertex->v, tangent_dot(vertex->ng, moved) / cosine));
}

#endif
