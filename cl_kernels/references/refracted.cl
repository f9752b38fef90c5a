// Lobes about the refracted direction.
#ifndef PYLMC_REFERENCE_REFRACTED
#define PYLMC_REFERENCE_REFRACTED

#include "charts/tangent.cl"
#include "lobes/interface.cl"
#include "references/facet_width.cl"

real3 refracted_direction(__global const Lobe *lobe, const Vertex *vertex, real3 n, real3 v) {
    real eta = 1.0 / relative_ior(lobe, vertex, -v);
    real ci = -dot(v, n);
    real ct = sqrt(fmax(0.0, 1.0 - eta * eta * (1.0 - ci * ci)));
    return normalize(eta * v + (eta * ci - ct) * n);  // at total reflection: along the surface
}

// A refracted direction is near v, and opposite to the mirror direction at normal incidence: turn from v itself.
real3 refracted_transport(const Vertex *vertex, real3 v, real3 p, real3 s) { return rotate_minimal(p, v, s); }

Tangent refracted_direction_tangent(__global const Lobe *lobe, const Vertex *vertex, real3 n, Tangent dv, Tangent dn) {
    real eta = 1.0 / relative_ior(lobe, vertex, -vertex->v);
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

Tangent refracted_transport_tangent(const Vertex *vertex, real3 p, real3 s, Tangent dp, Tangent dv, Tangent dn, Tangent ds) {
    return rotation_tangent(p, vertex->v, s, dp, dv, ds);
}

real2 refracted_width(__global const Lobe *lobe, const Vertex *vertex, real3 n, real3 s) {
    real eta = 1.0 / relative_ior(lobe, vertex, -vertex->v);
    return facet_width(lobe->alpha, eta, -dot(n, vertex->v), fmax(fabs(dot(n, s)), 0.1));
}

#endif
