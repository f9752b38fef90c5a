// The scene as the kernels see it: one bundle of pointers, filled at the top of each kernel. The structs themselves
// (Material, TriangleInfo, ...) are generated from the numpy dtypes of pylmc/device/tables.py.
#ifndef PYLMC_SCENE
#define PYLMC_SCENE

#include "number/vectors.cl"
#include "trace/traverse.cl"

// SCENE_MEMBERS, SCENE_PARAMETERS and SCENE_BUNDLE are made from the table of the scene's arrays (pylmc/device/tables.py): the
// bundle's members, a kernel's parameters, and the bundle's initialiser.
typedef struct {
    SCENE_MEMBERS
    uint rays;  // rays traced so far, a statistic
} Scene;

real3 load3(__global const real *p, int i) { return vload3(i, p); }
real3 vec3(__global const real *p) { return (real3)(p[0], p[1], p[2]); }

// A vector in the type that rays are traced in, which may be narrower than `real`.
bvh_real3 traced(real3 a) { return (bvh_real3)((BVH_REAL)a.x, (BVH_REAL)a.y, (BVH_REAL)a.z); }

bool trace(Scene *scene, real3 origin, real3 direction, Hit *hit) {
    scene->rays++;
    return closest_hit(scene->nodes, scene->leaves, traced(origin), traced(direction), INFINITY, hit);
}

#endif
