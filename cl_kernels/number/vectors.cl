// Small vector algebra: frames, minimal rotations, and the offset that keeps a ray off the surface it leaves.
#ifndef PYLMC_VECTORS
#define PYLMC_VECTORS

#include "number/finite.cl"

// LUMINANCE_RED, _GREEN and _BLUE come from pylmc/colour.py.

#define PI 3.141592653589793
#define INV_PI 0.3183098861837907

real square(real x) { return x * x; }
real length2(real3 a) { return dot(a, a); }
real luminance(real3 rgb) { return LUMINANCE_RED * rgb.x + LUMINANCE_GREEN * rgb.y + LUMINANCE_BLUE * rgb.z; }
real max_component(real3 a) { return fmax(a.x, fmax(a.y, a.z)); }

// A unit vector across the unit vector n (Duff et al. 2017). It jumps somewhere on the sphere, as every such rule must;
// nothing in the sampler depends on which one it is (theory.md, 2, Frames).
real3 any_tangent(real3 n) {
    real s = copysign(1.0, n.z);
    real a = -1.0 / (s + n.z);
    return (real3)(1.0 + s * n.x * n.x * a, s * n.x * n.y * a, -s * n.x);
}

// A vector across the axis, at an azimuth; and a unit vector at the cosine and sine of an angle with it.
real3 across_axis(real3 axis, real length, real azimuth) {
    real3 tangent = any_tangent(axis);
    return length * cos(azimuth) * tangent + length * sin(azimuth) * cross(axis, tangent);
}
real3 about_axis(real3 axis, real cosine, real sine, real azimuth) {
    return normalize(across_axis(axis, sine, azimuth) + cosine * axis);
}

// u, across the unit vector a, turned by the minimal rotation that takes a to the unit vector b (theory.md, 2, Frames).
// Undefined for b = -a, where the guard returns some finite vector.
real3 rotate_minimal(real3 u, real3 a, real3 b) { return u - dot(b, u) / fmax(1.0 + dot(a, b), 1e-12) * (a + b); }

real3 reflect_about(real3 v, real3 n) { return v - 2.0 * dot(v, n) * n; }

// The origin of a ray that leaves x along d, moved off the surface with geometric normal n. The scene is scaled to
// radius one (pylmc/sampling/compiled.py), and the intersection's error is a few roundings of that in the type rays are traced in.
#if BVH_DOUBLE
#define RAY_OFFSET 4e-15
#else
#define RAY_OFFSET 2e-6
#endif
real3 offset_from_surface(real3 x, real3 n, real3 d) { return x + copysign(RAY_OFFSET, dot(n, d)) * n; }

#endif
