// The small step (theory.md, 3): delta X = a dt + h T xi in the charts of X, h = sqrt(2 dt), and the log densities of the
// step and of its reverse, eqs. (5)-(10), in the solid-angle measure of the state:
//
//     p(X^|X) = G(xi) / (h^n |det T| prod_i dsigma_i/ddelta_i)
#ifndef PYLMC_SMALL_STEP
#define PYLMC_SMALL_STEP

#include "moves/blocks.cl"
#include "constraints/preconditioner.cl"

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
#if HAS_DEVIATION
        if (j > 1) {
            s = reference_direction(scene, here, here->v);
            p = transport_frame(scene, here, here->v, p, s);
        }
#endif
        if (!chart_direction(&charts[j], (real2)(delta[2 * j - 2], delta[2 * j - 1]), here->x, s, p, &v, &jacobian))
            return false;
        *log_jacobian += jacobian;
        if (j == 1) {
            // cheap refusals first: off the film, nothing needs tracing
            if (!is_positive(camera_importance(scene, v))) return false;
            p = *p_new = rotate_minimal(p, x->vertex[1].v, v);
        }
#if HAS_DEVIATION
        else
            p = rotate_minimal(p, s, v);
#endif
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

// Propose y from x by a small step of the block m, length h and normal numbers xi. log_forward and log_reverse: log p(X^|X) and
// log p(X|X^), but for the factor (2 pi)^{-m} h^{-2m} that they share.
int propose_small(Scene *scene, const Path *x, int m, real h, const real *xi, Path *y, Radiance *radiance, real *log_forward,
                  real *log_reverse) {
    Chart charts[MAX_DEPTH + 1];
    Factor factor;
    Row gradient;
    real3 p = any_tangent(x->vertex[1].v), p_new;
    if (!charts_of_path(scene, x, m, p, charts)) return STEP_NO_PATH;
    precondition(scene, x, m, p, charts, &factor, &gradient);
    int n = 2 * m;
    real shift[COLUMNS], delta[COLUMNS];  // in units of xi, and of the charts
    real forward = factor_log_determinant(&factor);
    for (int k = 0; k < n; k++) {
        shift[k] = xi[k];
        forward -= 0.5 * square(xi[k]);
    }
#if DRIFT
    real drift[COLUMNS];
    scaled_drift(&factor, &gradient, h, drift);
    for (int k = 0; k < n; k++) shift[k] += drift[k];
#endif
    factor_solve_transposed(&factor, shift, delta);
    for (int k = 0; k < n; k++) delta[k] *= h;

    real log_jacobian, log_jacobian_back = 0.0;
    if (!displaced_path(scene, x, m, delta, charts, p, &p_new, y, &log_jacobian)) return STEP_NO_PATH;
    *radiance = integrand(scene, y);
    if (is_minus_infinity(radiance->log_i)) return STEP_NO_PATH;
    if (m < y->length) {
        if (!visible(scene, &y->vertex[m], &y->vertex[m + 1])) return STEP_NO_PATH;
    }
    forward -= log_jacobian + joint_log_jacobian(y, m);

    // the reverse step, from X^ with its own charts and factor
    Chart charts_new[MAX_DEPTH + 1];
    if (!charts_of_path(scene, y, m, p_new, charts_new)) return STEP_NO_PATH;
    for (int j = 1; j <= m; j++) {
        real2 back;
        real jacobian;
        if (charts_new[j].kind != charts[j].kind) return STEP_NO_PATH;
        if (!chart_delta(&charts_new[j], x->vertex[j - 1].x, x->vertex[j].v, charts[j].omega, &back, &jacobian))
            return STEP_NO_PATH;
        delta[2 * j - 2] = back.x / h;
        delta[2 * j - 1] = back.y / h;
        log_jacobian_back += jacobian;
    }
    precondition(scene, y, m, p_new, charts_new, &factor, &gradient);
    factor_apply_transposed(&factor, delta, shift);
#if DRIFT
    scaled_drift(&factor, &gradient, h, drift);
    for (int k = 0; k < n; k++) shift[k] -= drift[k];
#endif
    real reverse = factor_log_determinant(&factor) - log_jacobian_back - joint_log_jacobian(x, m);
    for (int k = 0; k < n; k++) reverse -= 0.5 * square(shift[k]);
    *log_forward = forward;
    *log_reverse = reverse;
    return isfinite(reverse - forward) ? STEP_OK : STEP_NOT_FINITE;
}

#endif
