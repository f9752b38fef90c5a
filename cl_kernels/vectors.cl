// Small vector algebra: frames, minimal rotations, and the offset that keeps a ray off the surface it leaves.
#ifndef PYLMC_VECTORS
#define PYLMC_VECTORS

#define PI 3.14159265358979f
#define INV_PI 0.318309886183791f

float square(float x) { return x * x; }
float length2(float3 a) { return dot(a, a); }
float luminance(float3 rgb) { return 0.212671f * rgb.x + 0.715160f * rgb.y + 0.072169f * rgb.z; }
float max_component(float3 a) { return fmax(a.x, fmax(a.y, a.z)); }

// A unit vector across the unit vector n (Duff et al. 2017). It jumps somewhere on the sphere, as every such rule must;
// nothing in the sampler depends on which one it is (theory.md, 2, Frames).
float3 any_tangent(float3 n) {
    float s = copysign(1.0f, n.z);
    float a = -1.0f / (s + n.z);
    return (float3)(1.0f + s * n.x * n.x * a, s * n.x * n.y * a, -s * n.x);
}

// u, across the unit vector a, turned by the minimal rotation that takes a to the unit vector b (theory.md, 2, Frames).
// Undefined for b = -a, where the guard returns some finite vector.
float3 rotate_minimal(float3 u, float3 a, float3 b) {
    return u - dot(b, u) / fmax(1.0f + dot(a, b), 1e-12f) * (a + b);
}

float3 reflect_about(float3 v, float3 n) { return v - 2.0f * dot(v, n) * n; }

// The origin of a ray that leaves x along d, moved off the surface with geometric normal n. The scene is scaled to
// radius one (pylmc/compiled.py), and the intersection's error in float32 is a few 1e-7 of that.
#define RAY_OFFSET 2e-6f
float3 offset_from_surface(float3 x, float3 n, float3 d) {
    return x + copysign(RAY_OFFSET, dot(n, d)) * n;
}

#endif
