// Rays against a wide BVH of triangles: closest_hit and any_hit, exact ties included.
//
// BVH_WIDTH (2, 4 or 8) children and triangles sit side by side in vectors, because CPU compilers do not vectorise
// across work-items once there is an inner loop. BVH_STACK_SIZE comes from the tree (pylmc/bvh.py, which also
// describes the layout).

#define BVH_CAT_(a, b) a##b
#define BVH_CAT(a, b) BVH_CAT_(a, b)
#define bvh_float BVH_CAT(float, BVH_WIDTH)
#define bvh_int BVH_CAT(int, BVH_WIDTH)

#if BVH_WIDTH == 8
#define BVH_LANES(F) F(s0) F(s1) F(s2) F(s3) F(s4) F(s5) F(s6) F(s7)
#elif BVH_WIDTH == 4
#define BVH_LANES(F) F(s0) F(s1) F(s2) F(s3)
#else
#define BVH_LANES(F) F(s0) F(s1)
#endif

typedef struct {
    bvh_float plane[6]; // low x, y, z, then high x, y, z of each child's box
    bvh_int child;      // an inner node if >= 0, else ~leaf; unused lanes hold inverted boxes
    bvh_int unused;
} BvhNode;

typedef struct {
    bvh_float corner[3];
    bvh_float edge1[3];
    bvh_float edge2[3];
    bvh_int triangle; // ascending, so that the first of equal hits is the lowest; unused lanes have edges of length 0
} BvhLeaf;

typedef struct {
    float t;
    int triangle;
    float u, v;
} Hit;

typedef struct {
    float3 origin, direction, inverse;
    int3 near; // which plane of each axis the ray meets first
} BvhRay;

#define BVH_NONE INT_MAX

// Errors of t_near and t_far against each other: three roundings each, one of them of a 2.5 ulp division.
#define BVH_BOX_SLACK 1.000001f

// Barycentric slack: rounding must not open a crack between two triangles that share an edge.
#define BVH_EDGE_SLACK 1e-6f

// A finite reciprocal keeps 0 * inf, hence NaN, out of the box test; boxes are padded, so a ray in a box's own plane
// still sees that plane on the outside.
float bvh_reciprocal(float x) {
    return fabs(x) > 1e-30f ? 1.0f / x : copysign(1e30f, x);
}

BvhRay bvh_ray(float3 origin, float3 direction) {
    BvhRay ray;
    ray.origin = origin;
    ray.direction = direction;
    ray.inverse = (float3)(bvh_reciprocal(direction.x), bvh_reciprocal(direction.y), bvh_reciprocal(direction.z));
    ray.near = (int3)(ray.inverse.x < 0.0f ? 3 : 0, ray.inverse.y < 0.0f ? 4 : 1, ray.inverse.z < 0.0f ? 5 : 2);
    return ray;
}

// Which children's boxes the ray meets within (0, t_max), and where it enters them.
bvh_int bvh_enter(__global const BvhNode *node, const BvhRay *ray, float t_max, bvh_float *enter) {
    const int3 near = ray->near;
    const bvh_float x0 = (node->plane[near.x] - ray->origin.x) * ray->inverse.x;
    const bvh_float y0 = (node->plane[near.y] - ray->origin.y) * ray->inverse.y;
    const bvh_float z0 = (node->plane[near.z] - ray->origin.z) * ray->inverse.z;
    const bvh_float x1 = (node->plane[3 - near.x] - ray->origin.x) * ray->inverse.x;
    const bvh_float y1 = (node->plane[5 - near.y] - ray->origin.y) * ray->inverse.y;
    const bvh_float z1 = (node->plane[7 - near.z] - ray->origin.z) * ray->inverse.z;
    const bvh_float t0 = max(max(x0, y0), max(z0, (bvh_float)(0.0f)));
    const bvh_float t1 = min(min(x1, y1), min(z1, (bvh_float)(t_max)));
    *enter = t0;
    return t0 <= t1 * BVH_BOX_SLACK;
}

// Möller and Trumbore's test of a whole leaf. A zero determinant makes u or v infinite or NaN, which no comparison
// lets through.
bvh_int bvh_leaf(__global const BvhLeaf *leaf, const BvhRay *ray, float t_max,
                 bvh_float *t_out, bvh_float *u_out, bvh_float *v_out) {
    const float3 d = ray->direction;
    const bvh_float ax = leaf->edge1[0], ay = leaf->edge1[1], az = leaf->edge1[2];
    const bvh_float bx = leaf->edge2[0], by = leaf->edge2[1], bz = leaf->edge2[2];
    const bvh_float px = d.y * bz - d.z * by, py = d.z * bx - d.x * bz, pz = d.x * by - d.y * bx;
    const bvh_float inverse = 1.0f / (ax * px + ay * py + az * pz);
    const bvh_float sx = ray->origin.x - leaf->corner[0];
    const bvh_float sy = ray->origin.y - leaf->corner[1];
    const bvh_float sz = ray->origin.z - leaf->corner[2];
    const bvh_float u = (sx * px + sy * py + sz * pz) * inverse;
    const bvh_float qx = sy * az - sz * ay, qy = sz * ax - sx * az, qz = sx * ay - sy * ax;
    const bvh_float v = (d.x * qx + d.y * qy + d.z * qz) * inverse;
    const bvh_float t = (bx * qx + by * qy + bz * qz) * inverse;
    *t_out = t;
    *u_out = u;
    *v_out = v;
    return (u >= -BVH_EDGE_SLACK) & (v >= -BVH_EDGE_SLACK) & (u + v <= 1.0f + BVH_EDGE_SLACK) & (t > 0.0f) & (t <= t_max);
}

// The closest triangle with t in (0, t_max); the lowest number among equals. `direction` need not be a unit vector;
// t is in its units. The hit point is (1 - u - v) v0 + u v1 + v v2. On a miss, false, and `hit` is not to be read.
bool closest_hit(__global const BvhNode *nodes, __global const BvhLeaf *leaves, float3 origin, float3 direction,
                 float t_max, Hit *hit) {
    const BvhRay ray = bvh_ray(origin, direction);
    float stack_t[BVH_STACK_SIZE];
    int stack_child[BVH_STACK_SIZE];
    int top = 0;
    float best = t_max, best_u = 0.0f, best_v = 0.0f;
    int triangle = -1;
    int child = 0;
    for (;;) {
        while (child >= 0 && child != BVH_NONE) {
            bvh_float enter;
            const bvh_int inside = bvh_enter(nodes + child, &ray, best, &enter);
            const bvh_int children = nodes[child].child;
            float nearest = INFINITY;
            child = BVH_NONE;
#define BVH_VISIT(lane)                                                                                                \
    if (inside.lane) {                                                                                                 \
        if (enter.lane < nearest) {                                                                                    \
            if (child != BVH_NONE) {                                                                                   \
                stack_t[top] = nearest;                                                                                \
                stack_child[top++] = child;                                                                            \
            }                                                                                                          \
            nearest = enter.lane;                                                                                      \
            child = children.lane;                                                                                     \
        } else {                                                                                                       \
            stack_t[top] = enter.lane;                                                                                 \
            stack_child[top++] = children.lane;                                                                        \
        }                                                                                                              \
    }
            BVH_LANES(BVH_VISIT)
        }
        if (child != BVH_NONE) {
            __global const BvhLeaf *leaf = leaves + ~child;
            bvh_float t, u, v;
            const bvh_int met = bvh_leaf(leaf, &ray, best, &t, &u, &v);
            if (any(met)) {
                const bvh_int id = leaf->triangle;
#define BVH_TAKE(lane)                                                                                                 \
    if (met.lane && (t.lane < best || (t.lane == best && id.lane < triangle))) {                                       \
        best = t.lane;                                                                                                 \
        best_u = u.lane;                                                                                               \
        best_v = v.lane;                                                                                               \
        triangle = id.lane;                                                                                            \
    }
                BVH_LANES(BVH_TAKE)
            }
        }
        do {
            if (top == 0) {
                hit->t = best;
                hit->triangle = triangle;
                hit->u = clamp(best_u, 0.0f, 1.0f);
                hit->v = clamp(best_v, 0.0f, 1.0f - hit->u);
                return triangle >= 0;
            }
            --top;
        } while (stack_t[top] > best);
        child = stack_child[top];
    }
}

// Whether anything lies at t in (0, t_max).
bool any_hit(__global const BvhNode *nodes, __global const BvhLeaf *leaves, float3 origin, float3 direction,
             float t_max) {
    const BvhRay ray = bvh_ray(origin, direction);
    int stack[BVH_STACK_SIZE];
    int top = 0;
    int child = 0;
    for (;;) {
        if (child >= 0) {
            bvh_float enter;
            const bvh_int inside = bvh_enter(nodes + child, &ray, t_max, &enter);
            const bvh_int children = nodes[child].child;
#define BVH_PUSH(lane)                                                                                                 \
    if (inside.lane) stack[top++] = children.lane;
            BVH_LANES(BVH_PUSH)
        } else {
            bvh_float t, u, v;
            const bvh_int met = bvh_leaf(leaves + ~child, &ray, t_max, &t, &u, &v);
            if (any(met & (t < t_max))) return true;
        }
        if (top == 0) return false;
        child = stack[--top];
    }
}
