// Lobes about the normal, on the side of arrival: the wide ones.
#ifndef PYLMC_REFERENCE_NORMAL
#define PYLMC_REFERENCE_NORMAL

#include "charts/tangent.cl"

real3 normal_direction(__global const Lobe *lobe, const Vertex *vertex, real3 n, real3 v) { return n; }

// Reflected with the light, then turned minimally from the mirror direction to the normal.
real3 normal_transport(const Vertex *vertex, real3 v, real3 p, real3 s) {
    return rotate_minimal(reflect_about(p, vertex->ns), reflect_about(v, vertex->ns), s);
}

Tangent normal_direction_tangent(__global const Lobe *lobe, const Vertex *vertex, real3 n, Tangent dv, Tangent dn) {
    return dn;
}

Tangent normal_transport_tangent(const Vertex *vertex, real3 p, real3 s, Tangent dp, Tangent dv, Tangent dn, Tangent ds) {
    Tangent reflected = reflection_tangent(p, vertex->ns, dp, dn);
    return rotation_tangent(reflect_about(p, vertex->ns), reflect_about(vertex->v, vertex->ns), s, reflected,
                            reflection_tangent(vertex->v, vertex->ns, dv, dn), ds);
}

// One radian.
real2 normal_width(__global const Lobe *lobe, const Vertex *vertex, real3 n, real3 s) { return (real2)(1.0); }

#endif
