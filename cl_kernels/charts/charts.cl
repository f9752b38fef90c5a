// The coordinates of each free direction of a path, and the maps between them and the direction (theory.md, 2).
//
//   PROJECTION  v_1 by eq. (3): v = (v_1 + p dV_p + q dV_q) / |...|, or by the preprint's other projection
//   DEVIATION   the deviation from the lobe's reference direction, for a direction that leaves a narrow lobe
//   NODE        a target chart: aim at c + delta in the tangent plane of the next node, c
//   PORTAL    a target chart: the same in the plane of the portal that the direction passes through
//
// With target charts dsigma/ddelta = |n.v| / |c + delta - x|^2. Which kind a direction takes is a function of the path.
#ifndef PYLMC_CHARTS
#define PYLMC_CHARTS

#include "surface/crossings.cl"
#include "charts/deviation_chart.cl"
#include "references/references.cl"

typedef struct {
    int kind;
    real3 anchor;  // c; or the reference direction s; or v_1
    real3 e1, e2;  // the plane's axes; or p, q
    real3 normal;  // of the plane
    real2 omega;   // the deviation as it is
} Chart;

int direction_kind(const Scene *scene, const Path *path, int j, real3 x, real3 *crossing) {
#if COORDINATES_TARGET
    if (j > 1 && is_narrow(scene, &path->vertex[j - 1])) return KIND_DEVIATION;
    int portal = portal_crossed(scene, x, path->vertex[j].v, path->vertex[j].t, crossing);
    return portal >= 0 ? KIND_PORTAL + portal : KIND_NODE;
#else
    return j == 1 ? KIND_PROJECTION : KIND_DEVIATION;
#endif
}

// The charts of directions 1 .. m. p is the frame at v_1. False where a direction is out of its own chart's reach.
bool charts_of_path(const Scene *scene, const Path *path, int m, real3 p, Chart *charts) {
    real3 x = path->vertex[0].x;
    for (int j = 1; j <= m; j++) {
        Chart *chart = &charts[j];
        const Vertex *next = &path->vertex[j];
        real3 crossing;
        chart->kind = direction_kind(scene, path, j, x, &crossing);
        real3 s;
#if HAS_DEVIATION
        if (j > 1) {
            const Vertex *here = &path->vertex[j - 1];
            s = reference_direction(scene, here, here->v);
            p = transport_frame(scene, here, here->v, p, s);
        }
#endif
        if (chart->kind == KIND_DEVIATION) {
            chart->anchor = s;
            chart->e1 = p;
            chart->e2 = cross(s, p);
            if (!deviation_of(next->v, s, p, &chart->omega)) return false;
        } else if (chart->kind == KIND_PROJECTION) {
            chart->anchor = next->v;
            chart->e1 = p;
            chart->e2 = cross(next->v, p);
        } else if (chart->kind == KIND_NODE) {
            chart->anchor = next->x;
            chart->normal = next->ng;
            chart->e1 = any_tangent(next->ng);
            chart->e2 = cross(next->ng, chart->e1);
        } else {
#if NUM_PORTALS > 0
            __global const Portal *portal = &scene->portals[chart->kind - KIND_PORTAL];
            chart->anchor = crossing;
            chart->normal = vec3(portal->normal);
            chart->e1 = vec3(portal->axis);
            chart->e2 = cross(chart->normal, chart->e1);
#endif
        }
#if HAS_DEVIATION
        if (j > 1) p = rotate_minimal(p, s, next->v);
#endif
        x = next->x;
    }
    return true;
}

// The direction that delta leads to from the moved node x. s and p: the reference direction and frame there.
// log_jacobian: log dsigma(v)/ddelta.
bool chart_direction(const Chart *chart, real2 delta, real3 x, real3 s, real3 p, real3 *v, real *log_jacobian) {
    if (chart->kind == KIND_DEVIATION) {
        real2 omega = chart->omega + delta;
        *log_jacobian = deviation_log_jacobian(omega);
        return deviation_direction(omega, s, p, v);
    }
    real3 offset = delta.x * chart->e1 + delta.y * chart->e2;
    if (chart->kind == KIND_PROJECTION) {
#if PROJECTION == PROJECTION_NORMALISE
        *v = normalize(chart->anchor + offset);
        *log_jacobian = 3.0 * log(dot(*v, chart->anchor));
        return true;
#else
        real across2 = dot(delta, delta);
        if (across2 >= 1.0) return false;
        real cosine = sqrt(1.0 - across2);
        *v = normalize(cosine * chart->anchor + offset);
        *log_jacobian = -log(cosine);
        return true;
#endif
    }
    real3 towards = chart->anchor + offset - x;
    real distance2 = length2(towards);
    *v = towards * rsqrt(distance2);
    real cosine = fabs(dot(chart->normal, *v));
    *log_jacobian = log(cosine / distance2);
    return cosine > 0.0 && distance2 > 0.0;
}

// The inverse of chart_direction: the delta that leads from the chart's own path to the direction v that leaves x and, for
// a deviation, has deviation omega in the aligned frame.
bool chart_delta(const Chart *chart, real3 x, real3 v, real2 omega, real2 *delta, real *log_jacobian) {
    if (chart->kind == KIND_DEVIATION) {
        *delta = omega - chart->omega;
        *log_jacobian = deviation_log_jacobian(omega);
        return true;
    }
    real3 offset;
    if (chart->kind == KIND_PROJECTION) {
        real cosine = dot(v, chart->anchor);
        if (cosine <= 0.0) return false;
#if PROJECTION == PROJECTION_NORMALISE
        offset = v / cosine - chart->anchor;  // eq. (6)
        *log_jacobian = 3.0 * log(cosine);
#else
        offset = v;
        *log_jacobian = -log(cosine);
#endif
    } else {
        real cosine = dot(chart->normal, v), height = dot(chart->anchor - x, chart->normal);
        if (!is_positive(cosine * height)) return false;
        real t = height / cosine;
        offset = x + t * v - chart->anchor;
        *log_jacobian = log(fabs(cosine) / (t * t));
    }
    *delta = (real2)(dot(offset, chart->e1), dot(offset, chart->e2));  // eq. (7)
    return true;
}

#endif
