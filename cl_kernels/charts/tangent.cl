// Derivatives of vectors by a path's coordinates (theory.md, 4): eight coordinates lie side by side in a real8, so that one
// pass serves eight columns.
#ifndef PYLMC_TANGENT
#define PYLMC_TANGENT

#include "path/path.cl"

#define LANES 8
#define COLUMN_BLOCKS ((2 * MAX_DEPTH + LANES - 1) / LANES)
#define COLUMNS (LANES * COLUMN_BLOCKS)

// A three-vector for each of eight coordinates.
typedef struct {
    real8 x, y, z;
} Tangent;

Tangent tangent_zero(void) {
    Tangent r = {(real8)(0.0), (real8)(0.0), (real8)(0.0)};
    return r;
}
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

// d of the reflection of w about n.
Tangent reflection_tangent(real3 w, real3 n, Tangent dw, Tangent dn) {
    real8 twice = 2.0 * (tangent_dot(n, dw) + tangent_dot(w, dn));
    return tangent_sub(tangent_sub(dw, tangent_scaled(n, twice)), tangent_times(dn, (real8)(2.0 * dot(w, n))));
}

// d of rotate_minimal(u, a, b).
Tangent rotation_tangent(real3 u, real3 a, real3 b, Tangent du, Tangent da, Tangent db) {
    real inverse = 1.0 / fmax(1.0 + dot(a, b), 1e-6), k = dot(b, u) * inverse;
    real8 dk = inverse * (tangent_dot(u, db) + tangent_dot(b, du)) - k * inverse * (tangent_dot(b, da) + tangent_dot(a, db));
    Tangent turned = tangent_sub(du, tangent_scaled(a + b, dk));
    return tangent_sub(turned, tangent_times(tangent_add(da, db), (real8)(k)));
}

#endif
