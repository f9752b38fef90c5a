// The drift a = T T^T grad log pi (theory.md, 3), from the tangents of the preconditioner's sweep (compiled in on demand).
// The density that it climbs is that of the charts' own coordinates: log of luminance plus log dsigma/ddelta of each direction.
// Each lobe counts by its own luminance, as if colours were grey; the density's weight over the film and textures, all but
// constant at the scale of a step, are left out.
#ifndef PYLMC_DRIFT
#define PYLMC_DRIFT

#include "charts/sweep.cl"
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

// log dsigma/ddelta of a direction's chart: of an orthographic deviation, or log(|n.v| / |c + delta - x|^2) of a target chart.
void gradient_add_chart(const Segment *segment, Row *gradient) {
    const Chart *chart = segment->chart;
    for (int b = 0; b < segment->blocks; b++) {
        real8 unit1 = column_unit(b, 2 * segment->j - 2), unit2 = column_unit(b, 2 * segment->j - 1);
        if (CHART == CHART_ORTHOGRAPHIC && chart->kind == KIND_DEVIATION)
            gradient->block[b] +=
                (chart->omega.x * unit1 + chart->omega.y * unit2) / fmax(1.0 - dot(chart->omega, chart->omega), 1e-6);
        if (chart->kind < KIND_NODE) continue;
        Tangent moved =
            tangent_sub(tangent_add(tangent_scaled(chart->e1, unit1), tangent_scaled(chart->e2, unit2)), segment->dx_here[b]);
        real3 v = segment->next->v;
        gradient->block[b] += tangent_dot(chart->normal, segment->dv[b]) / dot(chart->normal, v) -
                              2.0 / distance(chart->anchor, segment->here->x) * tangent_dot(v, moved);
    }
}

// The joint's 1 / r^2, and |n.v| of the node that it leads to, unless that is a light without area.
void gradient_add_joint(const Segment *segment, Row *gradient) {
    const Vertex *next = segment->next;
    if (is_infinite(next)) return;
    for (int b = 0; b < segment->blocks; b++) {
        gradient->block[b] += 2.0 / next->t * tangent_dot(next->v, segment->dx_here[b]);
        if (next->place == PLACE_SURFACE) gradient->block[b] += tangent_dot(next->ng, segment->dv[b]) / dot(next->ng, next->v);
    }
}

// Everything that depends on this segment's direction.
void gradient_add_segment(const Scene *scene, const Segment *segment, Row *gradient) {
    if (segment->chart) gradient_add_chart(segment, gradient);
    if (segment->j == 1)
        gradient_add_camera(scene, segment->next->v, segment->dv, segment->blocks, gradient);
    else
        gradient_add_lobe(scene, segment->here, segment->next->v, segment->dv_here, segment->dv, segment->dn_here,
                          segment->blocks, gradient);
    if (!segment->chart && !segment->past) gradient_add_joint(segment, gradient);
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
