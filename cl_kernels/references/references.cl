// The direction that a lobe's deviations are counted from (theory.md, 2): mirror, refracted, or normal on the side of arrival;
// and the frame (p, q) that they are counted in, transported along the path (theory.md, 2, Frames): reflected or carried through
// with the light, turned minimally to the reference direction, and again to the direction taken. q = s x p.
//
// REFERENCES(F) is F(NUMBER, name) for each kind that the scene's lobes have, REFERENCE_FILES are their files.
#ifndef PYLMC_REFERENCES
#define PYLMC_REFERENCES

#include "charts/tangent.cl"
#include "lobes/lobes.cl"
#include REFERENCE_FILES

int reference_of(const Scene *scene, const Vertex *vertex) { return scene->lobes[vertex->lobe].reference; }

// v is the direction of arrival (-w_i).
real3 reference_direction(const Scene *scene, const Vertex *vertex, real3 v) {
    __global const Lobe *lobe = &scene->lobes[vertex->lobe];
    real3 n = dot(vertex->ns, v) < 0.0 ? vertex->ns : -vertex->ns;
#define REFERENCE_CASE(NUMBER, name) \
    case NUMBER:                     \
        return name##_direction(lobe, vertex, n, v);
    switch (lobe->reference) { REFERENCES(REFERENCE_CASE) }
#undef REFERENCE_CASE
    return n;
}

// p, across v where the path arrives at the vertex, as it leaves: across the reference direction s.
real3 transport_frame(const Scene *scene, const Vertex *vertex, real3 v, real3 p, real3 s) {
#define REFERENCE_CASE(NUMBER, name) \
    case NUMBER:                     \
        return name##_transport(vertex, v, p, s);
    switch (reference_of(scene, vertex)) { REFERENCES(REFERENCE_CASE) }
#undef REFERENCE_CASE
    return p;
}

// ds of the reference direction, for a path that arrives along the vertex's own v.
Tangent reference_tangent(const Scene *scene, const Vertex *vertex, Tangent dv, Tangent dn) {
    __global const Lobe *lobe = &scene->lobes[vertex->lobe];
    real facing = dot(vertex->ns, vertex->v) < 0.0 ? 1.0 : -1.0;
    real3 n = facing * vertex->ns;
    dn = tangent_times(dn, (real8)(facing));
#define REFERENCE_CASE(NUMBER, name) \
    case NUMBER:                     \
        return name##_direction_tangent(lobe, vertex, n, dv, dn);
    switch (lobe->reference) { REFERENCES(REFERENCE_CASE) }
#undef REFERENCE_CASE
    return dn;
}

// dp of transport_frame.
Tangent frame_tangent(const Scene *scene, const Vertex *vertex, real3 p, real3 s, Tangent dp, Tangent dv, Tangent dn,
                      Tangent ds) {
#define REFERENCE_CASE(NUMBER, name) \
    case NUMBER:                     \
        return name##_transport_tangent(vertex, p, s, dp, dv, dn, ds);
    switch (reference_of(scene, vertex)) { REFERENCES(REFERENCE_CASE) }
#undef REFERENCE_CASE
    return dp;
}

// The lobe's two axes across its reference direction, in the plane of incidence and across it, and its width along each.
void lobe_axes(const Scene *scene, const Vertex *vertex, real3 s, real3 *inward, real3 *sideways, real2 *width) {
    __global const Lobe *lobe = &scene->lobes[vertex->lobe];
    real3 n = dot(vertex->ns, vertex->v) < 0.0 ? vertex->ns : -vertex->ns;
    real3 across = n - dot(n, s) * s;
    real size2 = length2(across);
    *inward = size2 > 1e-8 ? across * rsqrt(size2) : any_tangent(s);
    *sideways = cross(s, *inward);
    *width = (real2)(1.0);
#define REFERENCE_CASE(NUMBER, name)               \
    case NUMBER:                                   \
        *width = name##_width(lobe, vertex, n, s); \
        break;
    switch (lobe->reference) { REFERENCES(REFERENCE_CASE) }
#undef REFERENCE_CASE
}

#endif
