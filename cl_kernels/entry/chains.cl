// The chains (theory.md, 6): each work-item runs one for some steps. Both states of a step are splatted with their expected
// values.
#include "entry/path_kernel.cl"
#include "path/film.cl"
#include "moves/markov_step.cl"

// A large step's weight counts in units of its group's b, and for no more than e to this: its square must stay finite.
#define MOST_LOG_WEIGHT 42.0

// numbers: the moves', see markov_step. places: by group.
PATH_KERNEL void run_chains(SCENE_PARAMETERS, uint seed, ulong first_step, int steps, uint chains,
                            __global const float *numbers, __global const FilmPlace *places, __global ChainState *states,
                            __global ChainCounters *counters, __global volatile uint *film, int film_pixels) {
    uint index = get_global_id(0);
    if (index >= chains) return;
    Scene scene = SCENE_BUNDLE;
    __global ChainState *state = &states[index];
    __global ChainCounters *count = &counters[index];
    Path paths[2];
    int now = 0;
    load_path(&scene, state, &paths[0]);
    Current current = {&paths[0], state->log_i, state->log_p};
    real3 colour = vec3(state->colour);
    int pixel = max(pixel_of(&scene, paths[0].vertex[1].v), 0);  // a chain that starts dark has none
    FilmPlace place = places[state->slot];
    size_t slot = (size_t)place.slot * film_pixels;
    // sums go on from where the last launch left them, so that they do not depend on where it ended
    real weight_sum = count->weight_sum, weight_square_sum = count->weight_square_sum, splatted = count->splatted;
    real brightness = luminance(colour);

    for (int step = 0; step < steps; step++) {
        Rng rng = rng_open(seed, index, first_step + step, PURPOSE_CHAIN);
        Path *y = &paths[1 - now];
        MarkovStep taken;
        markov_step(&scene, &current, numbers, &rng, y, &taken);
        real log_weight = taken.radiance.log_i - taken.log_forward - place.log_unit;
        if (taken.move == MOVE_LARGE && isfinite(log_weight)) {
            real weight = exp(fmin(log_weight, MOST_LOG_WEIGHT));
            weight_sum += weight;
            weight_square_sum += weight * weight;
        }
        if (taken.outcome == STEP_NOT_FINITE) count->not_finite++;
        count->proposed[taken.column]++;
        if (taken.acceptance < 1.0) {
            film_add(film, slot + pixel, place.scale * ((1.0 - taken.acceptance) * colour));
            splatted += (1.0 - taken.acceptance) * brightness;
        }
        if (taken.acceptance > 0.0) {
            real3 colour_new = colour_over_density(&taken.radiance);
            int pixel_new = pixel_of(&scene, y->vertex[1].v);
            film_add(film, slot + pixel_new, place.scale * (taken.acceptance * colour_new));
            real brightness_new = luminance(colour_new);
            splatted += taken.acceptance * brightness_new;
            count->acceptance[taken.column] += taken.acceptance;
            if (step_accepted(&taken)) {
                now = 1 - now;
                current.path = y;
                current.log_i = taken.radiance.log_i;
                current.log_p = taken.move == MOVE_LARGE ? taken.log_forward : UNKNOWN;
                colour = colour_new;
                brightness = brightness_new;
                pixel = pixel_new;
            }
        }
    }
    store_path(&scene, &paths[now], state);
    state->log_i = current.log_i;
    state->log_p = current.log_p;
    vstore3(colour, 0, state->colour);
    count->weight_sum = weight_sum;
    count->weight_square_sum = weight_square_sum;
    count->splatted = splatted;
    count->rays += scene.rays;
    real2 position;  // where on the film the chain is now: the trace behind ESS and R-hat
    film_position(&scene, paths[now].vertex[1].v, &position);
    vstore2(position, 0, count->trace);
}
