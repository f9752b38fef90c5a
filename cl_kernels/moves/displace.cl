// Where a displacement of a path's first m directions leads, in the charts of that path (theory.md, 2).
#ifndef PYLMC_DISPLACE
#define PYLMC_DISPLACE

#include "charts/charts.cl"
#include "lights/emitters.cl"
#include "path/camera.cl"

// Move directions 1 .. m of x by delta and trace; y is the new path. p, p_new: frames at v_1 and v^_1. The sum of the
// charts' log dsigma/ddelta comes back by pointer.
bool displaced_path(Scene *scene, const Path *x, int m, const real *delta, const Chart *charts, real3 p, real3 *p_new, Path *y,
                    real *log_jacobian) {
    y->length = x->length;
    y->ending = x->ending;
    y->light = x->light;
    y->vertex[0] = x->vertex[0];
    *log_jacobian = 0.0;
    for (int j = 1; j <= m; j++) {
        const Vertex *here = &y->vertex[j - 1];
        real3 s = p, v;  // s: of deviations only, which v_1 never is
        real jacobian;
        if (HAS_DEVIATION && j > 1) {
            s = reference_direction(scene, here, here->v);
            p = transport_frame(scene, here, here->v, p, s);
        }
        if (!chart_direction(&charts[j], (real2)(delta[2 * j - 2], delta[2 * j - 1]), here->x, s, p, &v, &jacobian))
            return false;
        *log_jacobian += jacobian;
        if (j == 1) {
            // cheap refusals first: off the film, nothing needs tracing
            if (!is_positive(camera_importance(scene, v))) return false;
            p = *p_new = rotate_minimal(p, x->vertex[1].v, v);
        } else if (HAS_DEVIATION)
            p = rotate_minimal(p, s, v);
        Vertex *next = &y->vertex[j];
        if (!trace_to_vertex(scene, here, v, next)) return false;
        if (j < y->length) {
            next->lobe = lobe_like(scene, next->material, scene->lobes[x->vertex[j].lobe].signature);
            if (next->lobe < 0) return false;
            if (is_narrow(scene, next) != is_narrow(scene, &x->vertex[j])) return false;
        }
    }
    for (int j = m + 1; j <= y->length; j++) y->vertex[j] = x->vertex[j];
    if (m == y->length) return emitter_at(scene, &y->vertex[m]) != 0;
    return join_nodes(&y->vertex[m], &y->vertex[m + 1]);
}

// log dsigma/dA of the direction that joins a shorter block to the fixed node x_{m+1}: its delta is zero in its own chart.
real joint_log_jacobian(const Path *path, int m) {
    if (m >= free_directions(path)) return 0.0;
    const Vertex *far = &path->vertex[m + 1];
    return log(fabs(dot(far->ng, far->v)) / square(far->t));
}

#endif
