// The drift a = T T^T grad log pi (theory.md, 3), from the tangents of the preconditioner's sweep (compiled in on demand).
// The density that it climbs is that of the charts' own coordinates: log of luminance plus log dsigma/ddelta of each direction.
// Each lobe counts by its own luminance, as if colours were grey; the density's weight over the film and textures, all but
// constant at the scale of a step, are left out.
#ifndef PYLMC_DRIFT
#define PYLMC_DRIFT

#include "constraints/factor.cl"
#include "lobes/lobes.cl"

// In units of xi the drift is (h/2) L^{-1} g; steps beyond this length only overshoot where log pi is far from linear.
#define DRIFT_LIMIT 1.0

// One node's lobe: arriving direction v (w_i = -v) and leaving direction wo with their tangents.
void gradient_add_lobe(const Scene *scene, const Vertex *vertex, real3 wo, const Tangent *dv, const Tangent *dwo,
                       const Tangent *dn, int blocks, Row *gradient) {
    LobeGradient g = lobe_gradient(scene, vertex, -vertex->v, wo);
    for (int b = 0; b < blocks; b++)
        gradient->block[b] += tangent_dot(g.out, dwo[b]) - tangent_dot(g.in, dv[b]) + tangent_dot(g.normal, dn[b]);
}

// The camera's W ~ 1 / cos^3.
void gradient_add_camera(const Scene *scene, real3 v, const Tangent *dv, int blocks, Row *gradient) {
    real3 forward = vec3(scene->camera->forward);
    for (int b = 0; b < blocks; b++) gradient->block[b] -= 3.0 / dot(v, forward) * tangent_dot(forward, dv[b]);
}

// log dsigma/ddelta = log(|n.v| / |c + delta - x|^2) of a target chart; `towards` is c - x, of tangent `moved`.
void gradient_add_target(real3 normal, real3 v, real distance, int block, Tangent dv, Tangent moved, Row *gradient) {
    gradient->block[block] += tangent_dot(normal, dv) / dot(normal, v) - 2.0 / distance * tangent_dot(v, moved);
}

// drift[k] in units of xi, for the step length h.
void scaled_drift(const Factor *factor, const Row *gradient, real h, real *drift) {
    real length_squared = 0.0;
    factor_solve(factor, gradient, drift);
    for (int k = 0; k < factor->n; k++) {
        drift[k] *= 0.5 * h;
        length_squared += square(drift[k]);
    }
    real shorten = length_squared > square(DRIFT_LIMIT) ? DRIFT_LIMIT * rsqrt(length_squared) : 1.0;
    for (int k = 0; k < factor->n; k++) drift[k] = isfinite(length_squared) ? shorten * drift[k] : 0.0;
}

#endif
