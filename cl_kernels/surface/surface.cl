// From a ray's hit to a path's node: position, normals, material, texture; and visibility between two nodes.
#ifndef PYLMC_SURFACE
#define PYLMC_SURFACE

#include "path/path.cl"

#if HAS_TEXTURES
real3 texel(const Scene *scene, __global const TextureInfo *texture, int column, int row) {
    __global const float *rgb = scene->texels + 3 * (size_t)(texture->offset + row * texture->width + column);
    return (real3)(rgb[0], rgb[1], rgb[2]);
}

// Bilinear, repeated; row 0 is the top of the image, v = 1.
real3 texture_colour(const Scene *scene, int index, real2 uv) {
    __global const TextureInfo *texture = &scene->textures[index];
    real2 at = (real2)((uv.x - floor(uv.x)) * texture->width, (1.0 - (uv.y - floor(uv.y))) * texture->height) - 0.5;
    real2 low = floor(at);
    real2 weight = at - low;
    int width = texture->width, height = texture->height;
    int column = ((int)low.x + width) % width, row = ((int)low.y + height) % height;
    int next_column = (column + 1) % width, next_row = (row + 1) % height;
    real3 top = mix(texel(scene, texture, column, row), texel(scene, texture, next_column, row), weight.x);
    real3 bottom = mix(texel(scene, texture, column, next_row), texel(scene, texture, next_column, next_row), weight.x);
    return mix(top, bottom, weight.y);
}
#endif

// Fill in all of the node that follows from its triangle and barycentric coordinates.
void place_on_triangle(const Scene *scene, int triangle, real bu, real bv, Vertex *vertex) {
    int i0 = scene->faces[3 * triangle], i1 = scene->faces[3 * triangle + 1], i2 = scene->faces[3 * triangle + 2];
    real3 p0 = load3(scene->vertices, i0), p1 = load3(scene->vertices, i1), p2 = load3(scene->vertices, i2);
    real bw = 1.0 - bu - bv;
    __global const TriangleInfo *info = &scene->triangles[triangle];
    vertex->place = PLACE_SURFACE;
    vertex->triangle = triangle;
    vertex->bu = bu;
    vertex->bv = bv;
    vertex->material = info->material;
    vertex->x = bw * p0 + bu * p1 + bv * p2;
    vertex->ng = vec3(info->normal);
    vertex->ns = vertex->ng;
#if HAS_SMOOTH
    if (info->smooth) {
        real3 n = bw * load3(scene->normals, i0) + bu * load3(scene->normals, i1) + bv * load3(scene->normals, i2);
        real size2 = length2(n);
        if (size2 > 0.0) vertex->ns = n * rsqrt(size2);
        if (dot(vertex->ns, vertex->ng) < 0.0) vertex->ns = -vertex->ns;
    }
#endif
    vertex->tint = (real3)(1.0);
#if HAS_TEXTURES
    int texture = scene->materials[info->material].texture;
    if (texture >= 0) {
        real2 uv = bw * vload2(i0, scene->uvs) + bu * vload2(i1, scene->uvs) + bv * vload2(i2, scene->uvs);
        vertex->tint = texture_colour(scene, texture, uv);
    }
#endif
}

// A segment must leave and meet surfaces by more than the offset that keeps rays off them. Two points of one plane, joined,
// would else see each other, or through each other's back, by rounding alone, at any 1 / r^2.
bool keeps_off_surface(const Vertex *vertex, real3 segment) {
    return vertex->place != PLACE_SURFACE || fabs(dot(vertex->ng, segment)) > RAY_OFFSET;
}

// Where a ray that leaves the node along d starts.
real3 ray_origin(const Vertex *vertex, real3 d) {
    return vertex->place == PLACE_SURFACE ? offset_from_surface(vertex->x, vertex->ng, d) : vertex->x;
}

// The tree says which triangle a ray meets, in the precision of the tree and from an origin moved off the surface. Where on
// the triangle's plane is solved again from x itself, so that the node lies on the line from x along v as exactly as `real`
// can say. Rays that graze the plane, where the two disagree by more than an edge's width, keep what the tree said.
#define SOLVED_OUTSIDE 0.01
bool solve_triangle(const Scene *scene, int triangle, real3 x, real3 v, real outside, real *bu, real *bv) {
    int i0 = scene->faces[3 * triangle], i1 = scene->faces[3 * triangle + 1], i2 = scene->faces[3 * triangle + 2];
    real3 p0 = load3(scene->vertices, i0), e1 = load3(scene->vertices, i1) - p0, e2 = load3(scene->vertices, i2) - p0;
    real3 normal = vec3(scene->triangles[triangle].normal);
    real t = dot(p0 - x, normal) / dot(v, normal), area = dot(cross(e1, e2), normal);
    real3 offset = x + t * v - p0;
    real u = dot(cross(offset, e2), normal) / area, w = dot(cross(e1, offset), normal) / area;
    if (!(t > 0.0 && u > -outside && w > -outside && u + w < 1.0 + outside)) return false;
    *bu = u;
    *bv = w;
    return true;
}

// Where triangles lie on each other, rounding decides which of them the tree names, and decides otherwise for another ray. Who
// is met there is settled on the host (pylmc/geometry/coincident.py): each side of a triangle has a list of those that are met
// in its place, first come first served. The one that the line from x along v meets at `triangle`; bu and bv become its own.
int owner(const Scene *scene, int triangle, real3 x, real3 v, real *bu, real *bv) {
#if HAS_TIES
    int side = 2 * triangle + (dot(v, vec3(scene->triangles[triangle].normal)) > 0.0);
    for (int i = scene->ties[side]; i < scene->ties[side + 1]; i++)
        if (solve_triangle(scene, scene->ties[i], x, v, 0.0, bu, bv)) return scene->ties[i];
#endif
    return triangle;
}

// Is this point what a ray from the front of its triangle meets? A point of a lamp that is not gives no light.
bool is_met(const Scene *scene, const Vertex *vertex) {
#if HAS_TIES
    real bu, bv;
    return owner(scene, vertex->triangle, vertex->x + vertex->ng, -vertex->ng, &bu, &bv) == vertex->triangle;
#else
    return true;
#endif
}

// The node met by the ray from `from` along v; v and t are those of the segment just traced.
bool trace_to_vertex(Scene *scene, const Vertex *from, real3 v, Vertex *vertex) {
    real3 x = from->x;
    Hit hit;
    if (!trace(scene, ray_origin(from, v), v, &hit)) return false;
    real bu = hit.u, bv = hit.v;
    solve_triangle(scene, hit.triangle, x, v, SOLVED_OUTSIDE, &bu, &bv);
    int triangle = owner(scene, hit.triangle, x, v, &bu, &bv);
    place_on_triangle(scene, triangle, bu, bv, vertex);
    vertex->v = v;
    real3 segment = vertex->x - x;
    vertex->t = length(segment);
    return keeps_off_surface(vertex, segment) && keeps_off_surface(from, segment);
}

// The segment that joins two nodes, as travelled from the camera: far's v and t, which at infinity are what they are. False where
// the nodes are one point.
bool join_nodes(const Vertex *near, Vertex *far) {
    if (is_infinite(far)) return true;
    far->t = distance(far->x, near->x);
    if (!is_positive(far->t)) return false;
    far->v = (far->x - near->x) / far->t;
    return true;
}

// Does nothing block the segment from a to b? b may be at infinity.
bool visible(Scene *scene, const Vertex *a, const Vertex *b) {
#if HAS_INFINITE
    if (is_infinite(b)) {
        if (!keeps_off_surface(a, b->v)) return false;
        scene->rays++;
        return !any_hit(scene->nodes, scene->leaves, traced(ray_origin(a, b->v)), traced(b->v), INFINITY);
    }
#endif
    real3 towards = b->x - a->x;
    if (!keeps_off_surface(a, towards) || !keeps_off_surface(b, towards)) return false;
    real3 from = ray_origin(a, towards), to = ray_origin(b, -towards);
    scene->rays++;
    return !any_hit(scene->nodes, scene->leaves, traced(from), traced(to - from), 1.0f);
}

#endif
