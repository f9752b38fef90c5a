// Lobes about the mirror direction.
#ifndef PYLMC_REFERENCE_MIRROR
#define PYLMC_REFERENCE_MIRROR

#include "charts/tangent.cl"
#include "references/facet_width.cl"

real3 mirror_direction(__global const Lobe *lobe, const Vertex *vertex, real3 n, real3 v) { return reflect_about(v, n); }

real3 mirror_transport(const Vertex *vertex, real3 v, real3 p, real3 s) { return reflect_about(p, vertex->ns); }

Tangent mirror_direction_tangent(__global const Lobe *lobe, const Vertex *vertex, real3 n, Tangent dv, Tangent dn) {
    return reflection_tangent(vertex->v, n, dv, dn);
}

Tangent mirror_transport_tangent(const Vertex *vertex, real3 p, real3 s, Tangent dp, Tangent dv, Tangent dn, Tangent ds) {
    return reflection_tangent(p, vertex->ns, dp, dn);
}

real2 mirror_width(__global const Lobe *lobe, const Vertex *vertex, real3 n, real3 s) {
    real ci = -dot(n, vertex->v);
    return facet_width(lobe->alpha, 1.0, ci, -ci);
}

#endif
