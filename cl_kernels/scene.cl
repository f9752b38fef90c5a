// The scene as the kernels see it: one bundle of pointers, filled at the top of each kernel. The structs themselves
// (Material, TriangleInfo, ...) are generated from the numpy dtypes of pylmc/layout.py.
#ifndef PYLMC_SCENE
#define PYLMC_SCENE

#include "vectors.cl"
#include "traverse.cl"

// Work-items go their own ways through the tree; the hint keeps compilers from running several side by side. It is needed for
// more than speed: Intel's CPU compiler, left to itself, loses occlusions here (tests/test_devices_agree.py).
#define PATH_KERNEL __kernel __attribute__((vec_type_hint(float8)))

typedef struct {
    __global const BvhNode *nodes;
    __global const BvhLeaf *leaves;
    __global const float *vertices;
    __global const int *faces;
    __global const float *normals;
    __global const float *uvs;
    __global const TriangleInfo *triangles;
    __global const Material *materials;
    __global const TextureInfo *textures;
    __global const float *texels;
    __global const SceneObject *objects;
    __global const Emitter *emitters;
    __global const float *emitter_cdf;
    __global const int *emitter_triangles;
    __global const PointLight *points;
    __global const Aperture *apertures;
    __global const Target *targets;
    __global const Camera *camera;
    __global const float *evenness;
    uint rays;  // rays traced so far, a statistic
} Scene;

#define SCENE_PARAMETERS                                                                                           \
    __global const BvhNode *nodes, __global const BvhLeaf *leaves, __global const float *vertices,                \
        __global const int *faces, __global const float *normals, __global const float *uvs,                      \
        __global const TriangleInfo *triangles, __global const Material *materials,                               \
        __global const TextureInfo *textures, __global const float *texels, __global const SceneObject *objects,  \
        __global const Emitter *emitters, __global const float *emitter_cdf,                                      \
        __global const int *emitter_triangles, __global const PointLight *points,                                 \
        __global const Aperture *apertures, __global const Target *targets, __global const Camera *camera,                         \
        __global const float *evenness

#define SCENE_BUNDLE                                                                                               \
    { nodes, leaves, vertices, faces, normals, uvs, triangles, materials, textures, texels, objects, emitters,     \
      emitter_cdf, emitter_triangles, points, apertures, targets, camera, evenness, 0u }

float3 load3(__global const float *p, int i) { return vload3(i, p); }
float3 vec3(__global const float *p) { return (float3)(p[0], p[1], p[2]); }

bool trace(Scene *scene, float3 origin, float3 direction, Hit *hit) {
    scene->rays++;
    return closest_hit(scene->nodes, scene->leaves, origin, direction, INFINITY, hit);
}

#endif
