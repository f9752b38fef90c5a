// The integrand C of theory.md, 1, in solid-angle measure, for the lobes of the path's signature:
//
//     C = W(v_1) prod_i f_i(-v_i, v_{i+1}) |n_i.v_{i+1}| times I_e / |y - x_N|^2 (connect) or L_e (hit)
//
// kept as a colour and a logarithm, C = colour * exp(log_scale): near-mirrors and narrow holes overflow float32 otherwise.
// Visibility is the business of whoever built the path.
//
// The chain's density may be any positive scalar of C: it is I = luminance of C, times a weight of the film position that
// evens out the noise of dark and bright parts (pylmc/sampling/evenness.py). Splats carry C / I, so the picture does not change.
#ifndef PYLMC_INTEGRAND
#define PYLMC_INTEGRAND

#include "path/camera.cl"
#include "lights/emitters.cl"
#include "lights/lights.cl"
#include "lobes/lobes.cl"

#define LOG_ZERO -INFINITY
// Whether x is the logarithm of something above zero; false of NaN.
bool is_log_of_some(real x) { return !isnan(x) && !is_minus_infinity(x); }

typedef struct {
    real3 colour;  // C / exp(log_scale)
    real log_i;    // log of I, the chain's density pi; LOG_ZERO where C = 0, and NaN is passed on, to be counted
    real weight;   // of the film position
} Radiance;

// C / I.
real3 colour_over_density(const Radiance *c) { return c->colour / (c->weight * luminance(c->colour)); }

Radiance integrand(const Scene *scene, const Path *path) {
    Radiance c;
    c.log_i = LOG_ZERO;
    c.colour = (real3)(1.0);
    real importance = camera_importance(scene, path->vertex[1].v);
    if (!is_positive(importance)) return c;
    real log_scale = log(importance);
    for (int i = 1; i < path->length; i++) {
        real scale;
        c.colour *= lobe_value(scene, &path->vertex[i], -path->vertex[i].v, path->vertex[i + 1].v, &scale);
        if (!is_positive(scale)) {
            if (isnan(scale)) c.log_i = scale;
            return c;
        }
        log_scale += log(scale);
    }
    const Vertex *last = &path->vertex[path->length];
#if HAS_LIGHTS
    if (path->ending == ENDING_CONNECT) {
        c.colour *= light_intensity(scene, path->light, -last->v);
        log_scale -= 2.0 * log(last->t);
    }
#endif
#if HAS_EMITTERS
    if (path->ending == ENDING_HIT) c.colour *= emitted_radiance(scene, last, last->v);
#endif
    real brightness = luminance(c.colour);
    c.weight = film_weight(scene, path->vertex[1].v);
    if (brightness != 0.0) c.log_i = log_scale + log(brightness * c.weight);
    return c;
}

#endif
