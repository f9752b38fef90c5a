// Rays against a wide BVH of triangles: closest_hit and any_hit, exact ties included.
//
// BVH_WIDTH (2, 4 or 8) children and triangles sit side by side in vectors, because CPU compilers do not vectorise
// across work-items once there is an inner loop. BVH_REAL (float, or double with BVH_DOUBLE, and BVH_INTEGER as wide) and
// BVH_STACK_SIZE come from the tree (pylmc/geometry/bvh/__init__.py, which also describes the layout).

#if BVH_DOUBLE
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#endif

// No contraction here, whatever the rest is allowed: triangles that share an edge must compute the same edge function for it
// (with contraction a sixth of the rays in the keyhole passed through its walls on PoCL 3.1).
#pragma OPENCL FP_CONTRACT OFF

#define BVH_CAT_(a, b) a##b
#define BVH_CAT(a, b) BVH_CAT_(a, b)
#define bvh_real BVH_REAL
#define bvh_real3 BVH_CAT(BVH_REAL, 3)
#define bvh_reals BVH_CAT(BVH_REAL, BVH_WIDTH)
#define bvh_integers BVH_CAT(BVH_INTEGER, BVH_WIDTH)

#if BVH_WIDTH == 8
#define BVH_LANES(F) F(s0) F(s1) F(s2) F(s3) F(s4) F(s5) F(s6) F(s7)
#elif BVH_WIDTH == 4
#define BVH_LANES(F) F(s0) F(s1) F(s2) F(s3)
#else
#define BVH_LANES(F) F(s0) F(s1)
#endif

typedef struct {
    bvh_reals plane[6];  // low x, y, z, then high x, y, z of each child's box
    bvh_integers child;  // an inner node if >= 0, else ~leaf; unused lanes hold inverted boxes
    bvh_integers unused;
} BvhNode;

typedef struct {
    bvh_reals corner[9];    // x, y, z of the first corner, of the second, of the third
    bvh_integers triangle;  // unused lanes hold -1, and three equal corners, which no ray hits
} BvhLeaf;

typedef struct {
    bvh_real t;
    int triangle;
    bvh_real u, v;
} Hit;

typedef struct {
    bvh_real3 origin, inverse;
    int3 near;           // which plane of each axis the ray meets first
    int3 axis;           // a permutation of the axes, the ray's longest last
    bvh_real3 permuted;  // the origin in that permutation
    bvh_real3 shear;     // maps the direction to (0, 0, 1) in that permutation
} BvhRay;

#define BVH_NONE INT_MAX

// Errors of t_near and t_far against each other: three roundings each, one of them of a 2.5 ulp division.
#if BVH_DOUBLE
#define BVH_BOX_SLACK 1.000000000000002
#else
#define BVH_BOX_SLACK 1.000001f
#endif

// A finite reciprocal keeps 0 * inf, hence NaN, out of the box test; boxes are padded, so a ray in a box's own plane
// still sees that plane on the outside.
bvh_real bvh_reciprocal(bvh_real x) { return fabs(x) > 1e-30f ? 1.0f / x : copysign((bvh_real)1e30f, x); }

BvhRay bvh_ray(bvh_real3 origin, bvh_real3 direction) {
    BvhRay ray;
    ray.origin = origin;
    ray.inverse = (bvh_real3)(bvh_reciprocal(direction.x), bvh_reciprocal(direction.y), bvh_reciprocal(direction.z));
    ray.near = (int3)(ray.inverse.x < 0.0f ? 3 : 0, ray.inverse.y < 0.0f ? 4 : 1, ray.inverse.z < 0.0f ? 5 : 2);
    const bvh_real3 size = fabs(direction);
    if (size.x >= size.y && size.x >= size.z) {
        ray.axis = (int3)(1, 2, 0);
        ray.permuted = origin.yzx;
        direction = direction.yzx;
    } else if (size.y >= size.z) {
        ray.axis = (int3)(2, 0, 1);
        ray.permuted = origin.zxy;
        direction = direction.zxy;
    } else {
        ray.axis = (int3)(0, 1, 2);
        ray.permuted = origin;
    }
    ray.shear = (bvh_real3)(direction.x / direction.z, direction.y / direction.z, 1.0f / direction.z);
    return ray;
}

// Which children's boxes the ray meets within (0, t_max), and where it enters them.
bvh_integers bvh_enter(__global const BvhNode *node, const BvhRay *ray, bvh_real t_max, bvh_reals *enter) {
    const int3 near = ray->near;
    const bvh_reals x0 = (node->plane[near.x] - ray->origin.x) * ray->inverse.x;
    const bvh_reals y0 = (node->plane[near.y] - ray->origin.y) * ray->inverse.y;
    const bvh_reals z0 = (node->plane[near.z] - ray->origin.z) * ray->inverse.z;
    const bvh_reals x1 = (node->plane[3 - near.x] - ray->origin.x) * ray->inverse.x;
    const bvh_reals y1 = (node->plane[5 - near.y] - ray->origin.y) * ray->inverse.y;
    const bvh_reals z1 = (node->plane[7 - near.z] - ray->origin.z) * ray->inverse.z;
    const bvh_reals t0 = max(max(x0, y0), max(z0, (bvh_reals)(0.0f)));
    const bvh_reals t1 = min(min(x1, y1), min(z1, (bvh_reals)(t_max)));
    *enter = t0;
    return t0 <= t1 * BVH_BOX_SLACK;
}

// Woop, Benthin and Wald's watertight test (2013) of a whole leaf. Triangles that share an edge compute the same edge
// function for it up to the sign, since contraction is off, so no ray slips between them. A zero determinant makes t
// NaN, which no comparison lets through.
bvh_integers bvh_leaf(__global const BvhLeaf *leaf, const BvhRay *ray, bvh_real t_max, bvh_reals *t_out, bvh_reals *u_out,
                      bvh_reals *v_out) {
    const int3 axis = ray->axis;
    const bvh_real3 o = ray->permuted, shear = ray->shear;
    const bvh_reals az = leaf->corner[axis.z] - o.z;
    const bvh_reals bz = leaf->corner[3 + axis.z] - o.z;
    const bvh_reals cz = leaf->corner[6 + axis.z] - o.z;
    const bvh_reals ax = leaf->corner[axis.x] - o.x - shear.x * az;
    const bvh_reals bx = leaf->corner[3 + axis.x] - o.x - shear.x * bz;
    const bvh_reals cx = leaf->corner[6 + axis.x] - o.x - shear.x * cz;
    const bvh_reals ay = leaf->corner[axis.y] - o.y - shear.y * az;
    const bvh_reals by = leaf->corner[3 + axis.y] - o.y - shear.y * bz;
    const bvh_reals cy = leaf->corner[6 + axis.y] - o.y - shear.y * cz;
    const bvh_reals a = cx * by - cy * bx, b = ax * cy - ay * cx, c = bx * ay - by * ax;
    const bvh_reals inverse = 1.0f / (a + b + c);
    const bvh_reals t = (a * az + b * bz + c * cz) * shear.z * inverse;
    *t_out = t;
    *u_out = b * inverse;
    *v_out = c * inverse;
    return (min(a, min(b, c)) >= 0.0f | max(a, max(b, c)) <= 0.0f) & (t > 0.0f) & (t <= t_max);
}

// The closest triangle with t in (0, t_max); the lowest number among equals. `direction` need not be a unit vector;
// t is in its units. The hit point is (1 - u - v) v0 + u v1 + v v2. On a miss, false, and `hit` is not to be read.
bool closest_hit(__global const BvhNode *nodes, __global const BvhLeaf *leaves, bvh_real3 origin, bvh_real3 direction,
                 bvh_real t_max, Hit *hit) {
    const BvhRay ray = bvh_ray(origin, direction);
    bvh_real stack_t[BVH_STACK_SIZE];
    int stack_child[BVH_STACK_SIZE];
    int top = 0;
    bvh_real best = t_max, best_u = 0.0f, best_v = 0.0f;
    int triangle = -1;
    int child = 0;
    for (;;) {
        while (child >= 0 && child != BVH_NONE) {
            bvh_reals enter;
            const bvh_integers inside = bvh_enter(nodes + child, &ray, best, &enter);
            const bvh_integers children = nodes[child].child;
            bvh_real nearest = INFINITY;
            child = BVH_NONE;
#define BVH_VISIT(lane)                         \
    if (inside.lane) {                          \
        if (enter.lane < nearest) {             \
            if (child != BVH_NONE) {            \
                stack_t[top] = nearest;         \
                stack_child[top++] = child;     \
            }                                   \
            nearest = enter.lane;               \
            child = children.lane;              \
        } else {                                \
            stack_t[top] = enter.lane;          \
            stack_child[top++] = children.lane; \
        }                                       \
    }
            BVH_LANES(BVH_VISIT)
        }
        if (child != BVH_NONE) {
            __global const BvhLeaf *leaf = leaves + ~child;
            bvh_reals t, u, v;
            const bvh_integers met = bvh_leaf(leaf, &ray, best, &t, &u, &v);
            if (any(met)) {
                const bvh_integers id = leaf->triangle;
#define BVH_TAKE(lane)                                                           \
    if (met.lane && (t.lane < best || (t.lane == best && id.lane < triangle))) { \
        best = t.lane;                                                           \
        best_u = u.lane;                                                         \
        best_v = v.lane;                                                         \
        triangle = id.lane;                                                      \
    }
                BVH_LANES(BVH_TAKE)
            }
        }
        do {
            if (top == 0) {
                hit->t = best;
                hit->triangle = triangle;
                hit->u = clamp(best_u, (bvh_real)0.0f, (bvh_real)1.0f);
                hit->v = clamp(best_v, (bvh_real)0.0f, 1.0f - hit->u);
                return triangle >= 0;
            }
            --top;
        } while (stack_t[top] > best);
        child = stack_child[top];
    }
}

// Whether anything lies at t in (0, t_max).
bool any_hit(__global const BvhNode *nodes, __global const BvhLeaf *leaves, bvh_real3 origin, bvh_real3 direction,
             bvh_real t_max) {
    const BvhRay ray = bvh_ray(origin, direction);
    int stack[BVH_STACK_SIZE];
    int top = 0;
    int child = 0;
    for (;;) {
        if (child >= 0) {
            bvh_reals enter;
            const bvh_integers inside = bvh_enter(nodes + child, &ray, t_max, &enter);
            const bvh_integers children = nodes[child].child;
#define BVH_PUSH(lane) \
    if (inside.lane) stack[top++] = children.lane;
            BVH_LANES(BVH_PUSH)
        } else {
            bvh_reals t, u, v;
            const bvh_integers met = bvh_leaf(leaves + ~child, &ray, t_max, &t, &u, &v);
            if (any(met & (t < t_max))) return true;
        }
        if (top == 0) return false;
        child = stack[--top];
    }
}

#if MATH_CONTRACT
#pragma OPENCL FP_CONTRACT ON
#endif
