// The small step (theory.md, 3; pylmc/moves/small.py): delta X = a dt + h T xi in the charts of X, h = sqrt(2 dt), and the
// log densities of the step and of its reverse, eqs. (5)-(10), in the solid-angle measure of the state:
//
//     p(X^|X) = G(xi) / (h^n |det T| prod_i dsigma_i/ddelta_i)
//
// The factor (2 pi)^{-m} h^{-2m}, which both share, is left out of them.
#ifndef PYLMC_MOVE_SMALL
#define PYLMC_MOVE_SMALL

#include "constraints/preconditioner.cl"
#include "moves/blocks.cl"
#include "moves/displace.cl"
#include "moves/step.cl"

typedef struct {
    int m;                                // directions 1 .. m move
    real3 p, p_new;                       // frames at v_1 and v^_1
    real shift[COLUMNS], delta[COLUMNS];  // in units of xi, and of the charts
    real log_forward, log_jacobian;
    Chart charts[MAX_DEPTH + 1];
    Factor factor;
    Row gradient;
} SmallStep;

// numbers: the range of log h.
int small_propose(Scene *scene, const Current *now, __global const float *numbers, Rng *rng, SmallStep *small,
                  MarkovStep *step) {
    const Path *x = now->path;
    int m = small->m = choose_block(scene, x, rng_uniform(rng));
    step->column += m - 1;
    step->h = exp(numbers[0] + (numbers[1] - numbers[0]) * rng_uniform(rng));
    step->normals = 2 * m;
    for (int k = 0; k < 2 * m; k += 2) {
        real2 normal = rng_normal2(rng);
        step->xi[k] = normal.x;
        step->xi[k + 1] = normal.y;
    }
    small->p = any_tangent(x->vertex[1].v);
    if (!charts_of_path(scene, x, m, small->p, small->charts)) return STEP_NO_PATH;
    precondition(scene, x, m, small->p, small->charts, &small->factor, &small->gradient);
    int n = 2 * m;
    real forward = factor_log_determinant(&small->factor);
    for (int k = 0; k < n; k++) {
        small->shift[k] = step->xi[k];
        forward -= 0.5 * square(step->xi[k]);
    }
#if DRIFT
    real drift[COLUMNS];
    scaled_drift(&small->factor, &small->gradient, step->h, drift);
    for (int k = 0; k < n; k++) small->shift[k] += drift[k];
#endif
    factor_solve_transposed(&small->factor, small->shift, small->delta);
    for (int k = 0; k < n; k++) small->delta[k] *= step->h;
    small->log_forward = forward;
    return STEP_OK;
}

// The joint is looked along last, and only where light would pass.
int small_trace(Scene *scene, const Current *now, Rng *rng, SmallStep *small, Path *y, MarkovStep *step) {
    int m = small->m;
    if (!displaced_path(scene, now->path, m, small->delta, small->charts, small->p, &small->p_new, y, &small->log_jacobian))
        return STEP_NO_PATH;
    step->radiance = integrand(scene, y);
    if (is_minus_infinity(step->radiance.log_i)) return STEP_NO_PATH;
    return m == y->length || visible(scene, &y->vertex[m], &y->vertex[m + 1]) ? STEP_OK : STEP_NO_PATH;
}

// The reverse step goes from X^, with its own charts and factor.
int small_weigh(Scene *scene, Current *now, SmallStep *small, const Path *y, MarkovStep *step) {
    const Path *x = now->path;
    int m = small->m, n = 2 * m;
    real forward = small->log_forward - (small->log_jacobian + joint_log_jacobian(y, m)), log_jacobian_back = 0.0;
    Chart charts_new[MAX_DEPTH + 1];
    if (!charts_of_path(scene, y, m, small->p_new, charts_new)) return STEP_NO_PATH;
    for (int j = 1; j <= m; j++) {
        real2 back;
        real jacobian;
        if (charts_new[j].kind != small->charts[j].kind) return STEP_NO_PATH;
        if (!chart_delta(&charts_new[j], x->vertex[j - 1].x, x->vertex[j].v, small->charts[j].omega, &back, &jacobian))
            return STEP_NO_PATH;
        small->delta[2 * j - 2] = back.x / step->h;
        small->delta[2 * j - 1] = back.y / step->h;
        log_jacobian_back += jacobian;
    }
    precondition(scene, y, m, small->p_new, charts_new, &small->factor, &small->gradient);
    factor_apply_transposed(&small->factor, small->delta, small->shift);
#if DRIFT
    real drift[COLUMNS];
    scaled_drift(&small->factor, &small->gradient, step->h, drift);
    for (int k = 0; k < n; k++) small->shift[k] -= drift[k];
#endif
    real reverse = factor_log_determinant(&small->factor) - log_jacobian_back - joint_log_jacobian(x, m);
    for (int k = 0; k < n; k++) reverse -= 0.5 * square(small->shift[k]);
    step->log_forward = forward;
    step->log_reverse = reverse;
    return isfinite(reverse - forward) ? STEP_OK : STEP_NOT_FINITE;
}

#endif
