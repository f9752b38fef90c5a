// From a ray's hit to a path's node: position, normals, material, texture; and visibility between two nodes.
#ifndef PYLMC_SURFACE
#define PYLMC_SURFACE

#include "path.cl"

#if HAS_TEXTURES
float3 texel(const Scene *scene, __global const TextureInfo *texture, int column, int row) {
    return load3(scene->texels, texture->offset + row * texture->width + column);
}

// Bilinear, repeated; row 0 is the top of the image, v = 1.
float3 texture_colour(const Scene *scene, int index, float2 uv) {
    __global const TextureInfo *texture = &scene->textures[index];
    float2 at = (float2)((uv.x - floor(uv.x)) * texture->width, (1.0f - (uv.y - floor(uv.y))) * texture->height) - 0.5f;
    float2 low = floor(at);
    float2 weight = at - low;
    int width = texture->width, height = texture->height;
    int column = ((int)low.x + width) % width, row = ((int)low.y + height) % height;
    int next_column = (column + 1) % width, next_row = (row + 1) % height;
    float3 top = mix(texel(scene, texture, column, row), texel(scene, texture, next_column, row), weight.x);
    float3 bottom = mix(texel(scene, texture, column, next_row), texel(scene, texture, next_column, next_row), weight.x);
    return mix(top, bottom, weight.y);
}
#endif

// Fill in all of the node that follows from its triangle and barycentric coordinates.
void place_on_triangle(const Scene *scene, int triangle, float bu, float bv, Vertex *vertex) {
    int i0 = scene->faces[3 * triangle], i1 = scene->faces[3 * triangle + 1], i2 = scene->faces[3 * triangle + 2];
    float3 p0 = load3(scene->vertices, i0), p1 = load3(scene->vertices, i1), p2 = load3(scene->vertices, i2);
    float bw = 1.0f - bu - bv;
    __global const TriangleInfo *info = &scene->triangles[triangle];
    vertex->triangle = triangle;
    vertex->bu = bu;
    vertex->bv = bv;
    vertex->material = info->material;
    vertex->x = bw * p0 + bu * p1 + bv * p2;
    vertex->ng = vec3(info->normal);
    vertex->ns = vertex->ng;
#if HAS_SMOOTH
    if (info->smooth) {
        float3 n = bw * load3(scene->normals, i0) + bu * load3(scene->normals, i1) + bv * load3(scene->normals, i2);
        float size2 = length2(n);
        if (size2 > 0.0f) vertex->ns = n * rsqrt(size2);
        if (dot(vertex->ns, vertex->ng) < 0.0f) vertex->ns = -vertex->ns;
    }
#endif
    vertex->tint = (float3)(1.0f);
#if HAS_TEXTURES
    int texture = scene->materials[info->material].texture;
    if (texture >= 0) {
        float2 uv = bw * vload2(i0, scene->uvs) + bu * vload2(i1, scene->uvs) + bv * vload2(i2, scene->uvs);
        vertex->tint = texture_colour(scene, texture, uv);
    }
#endif
}

// A segment must leave and meet surfaces by more than the offset that keeps rays off them. Two points of one plane, joined,
// would else see each other, or through each other's back, by rounding alone, at any 1 / r^2. A point without a surface has normal zero.
bool leaves_surface(float3 normal, float3 segment) {
    return fabs(dot(normal, segment)) > RAY_OFFSET || length2(normal) == 0.0f;
}

// The node met by the ray from `from` (null: the camera) along v; v and t are those of the segment just traced.
bool trace_to_vertex(Scene *scene, const Vertex *from, float3 v, Vertex *vertex) {
    float3 origin = from ? offset_from_surface(from->x, from->ng, v) : vec3(scene->camera->origin);
    Hit hit;
    if (!trace(scene, origin, v, &hit)) return false;
    place_on_triangle(scene, hit.triangle, hit.u, hit.v, vertex);
    vertex->v = v;
    float3 segment = vertex->x - (from ? from->x : origin);
    vertex->t = length(segment);
    return leaves_surface(vertex->ng, segment) && (!from || leaves_surface(from->ng, segment));
}

// Does anything block the segment from a to b? Either end may be a point without a surface (normal zero).
bool visible(Scene *scene, float3 a, float3 normal_a, float3 b, float3 normal_b) {
    float3 towards = b - a;
    if (!leaves_surface(normal_a, towards) || !leaves_surface(normal_b, towards)) return false;
    float3 from = offset_from_surface(a, normal_a, towards), to = offset_from_surface(b, normal_b, -towards);
    scene->rays++;
    return !any_hit(scene->nodes, scene->leaves, from, to - from, 1.0f);
}

#endif
