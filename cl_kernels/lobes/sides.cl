// Which side of the surface a direction is on, by the shading and by the geometric normal, which must agree.
#ifndef PYLMC_SIDES
#define PYLMC_SIDES

#include "path/path.cl"

// The normal on w's side, or zero where the shading and the geometric normal disagree on which side that is.
real3 facing_normal(const Vertex *vertex, real3 w) {
    real side_s = dot(vertex->ns, w), side_g = dot(vertex->ng, w);
    if (side_s * side_g <= 0.0) return (real3)(0.0);
    return side_s > 0.0 ? vertex->ns : -vertex->ns;
}

bool same_side(const Vertex *vertex, real3 a, real3 b) {
    return dot(vertex->ng, a) * dot(vertex->ng, b) > 0.0 && dot(vertex->ns, a) * dot(vertex->ns, b) > 0.0;
}

// The shading normal on the side of a direction that is known.
real3 normal_towards(const Vertex *vertex, real3 known) { return dot(vertex->ns, known) > 0.0 ? vertex->ns : -vertex->ns; }

#endif
