// The Markov kernel (theory.md, 6): each work-item runs one chain for some steps. A step is large (an independent path) with
// probability p_large, else small. Both states are splatted with their expected values.
#include "chain_state.cl"
#include "film.cl"
#include "small_step.cl"

#define PURPOSE_CHAIN 1u

PATH_KERNEL void run_chains(SCENE_PARAMETERS, uint seed, ulong first_step, int steps, uint chains, float p_large, float log_h_min, float log_h_max,
                         __global ChainState *states, __global ChainCounters *counters, __global volatile uint *film, int film_pixels) {
    uint index = get_global_id(0);
    if (index >= chains) return;
    Scene scene = SCENE_BUNDLE;
    __global ChainState *state = &states[index];
    __global ChainCounters *count = &counters[index];
    Path paths[2];
    int now = 0;
    load_path(&scene, state, &paths[0]);
    real log_i = state->log_i, log_p = state->log_p;
    real3 colour = vec3(state->colour);
    int pixel = max(pixel_of(&scene, paths[0].vertex[1].v), 0);  // a chain that starts dark has none
    size_t slot = (size_t)state->slot * film_pixels;
    real weight_sum = 0.0, weight_square_sum = 0.0;

    for (int step = 0; step < steps; step++) {
        Rng rng = rng_open(seed, index, first_step + step, PURPOSE_CHAIN);
        Path *x = &paths[now], *y = &paths[1 - now];
        Radiance radiance;
        real log_acceptance = -INFINITY, log_p_new = NAN;
        int move = 0;
        if (rng_uniform(&rng) < p_large || !(log_i > LOG_ZERO)) {
            real weight = 0.0;
            if (sample_path(&scene, x->length, x->ending, &rng, y)) {
                radiance = integrand(&scene, y);
                log_p_new = log_independent_density(&scene, y);
                if (isnan(log_p)) log_p = log_independent_density(&scene, x);
                log_acceptance = (radiance.log_i - log_p_new) - (log_i - log_p);
                if (isfinite(radiance.log_i - log_p_new)) weight = exp(radiance.log_i - log_p_new);
                if (isnan(log_acceptance)) {
                    count->not_finite++;
                    log_acceptance = -INFINITY;
                }
            }
            weight_sum += weight;
            weight_square_sum += weight * weight;
        } else {
            move = choose_block(&scene, x, rng_uniform(&rng));
            real h = exp(log_h_min + (log_h_max - log_h_min) * rng_uniform(&rng)), log_ratio;
            int outcome = propose_small(&scene, x, move, h, &rng, y, &radiance, &log_ratio);
            if (outcome == STEP_OK) log_acceptance = radiance.log_i - log_i + log_ratio;
            if (outcome == STEP_NOT_FINITE) count->not_finite++;
        }
        count->proposed[move]++;
        real acceptance = exp(fmin(log_acceptance, 0.0));
        if (acceptance < 1.0) film_add(film, slot + pixel, (1.0 - acceptance) * colour);
        if (acceptance > 0.0) {
            real3 colour_new = colour_over_target(&radiance);
            int pixel_new = pixel_of(&scene, y->vertex[1].v);
            film_add(film, slot + pixel_new, acceptance * colour_new);
            count->acceptance[move] += acceptance;
            if (rng_uniform(&rng) < acceptance) {
                now = 1 - now;
                log_i = radiance.log_i;
                log_p = log_p_new;
                colour = colour_new;
                pixel = pixel_new;
            }
        }
    }
    store_path(&paths[now], state);
    state->log_i = log_i;
    state->log_p = log_p;
    vstore3(colour, 0, state->colour);
    count->weight_sum += weight_sum;
    count->weight_square_sum += weight_square_sum;
    count->rays += scene.rays;
    real2 position;  // where on the film the chain is now: the trace behind ESS and R-hat
    film_position(&scene, paths[now].vertex[1].v, &position);
    vstore2(position, 0, count->trace);
}
