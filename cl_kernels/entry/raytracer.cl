// pylmc.RayTracer's kernels: one work-item per ray, arrays of three floats per ray in and flat arrays out.

#include "trace/traverse.cl"

// The hint keeps Intel's compiler from vectorising across these divergent work-items, six times slower.
__kernel __attribute__((vec_type_hint(float8))) void trace_closest(
    __global const BvhNode *nodes, __global const BvhLeaf *leaves, const int count, __global const float *origins,
    __global const float *directions, __global const float *t_max, __global float *t, __global int *triangle, __global float *u,
    __global float *v) {
    const int i = (int)get_global_id(0);
    if (i >= count) return;
    Hit hit;
    const bool found = closest_hit(nodes, leaves, vload3(i, origins), vload3(i, directions), t_max[i], &hit);
    t[i] = found ? hit.t : INFINITY;
    triangle[i] = found ? hit.triangle : -1;
    u[i] = found ? hit.u : 0.0f;
    v[i] = found ? hit.v : 0.0f;
}

__kernel __attribute__((vec_type_hint(float8))) void trace_any(__global const BvhNode *nodes, __global const BvhLeaf *leaves,
                                                               const int count, __global const float *origins,
                                                               __global const float *directions, __global const float *t_max,
                                                               __global uchar *occluded) {
    const int i = (int)get_global_id(0);
    if (i >= count) return;
    occluded[i] = any_hit(nodes, leaves, vload3(i, origins), vload3(i, directions), t_max[i]);
}
