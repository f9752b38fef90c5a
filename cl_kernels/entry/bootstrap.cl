// The exact start (theory.md, 6): weigh many independent paths by I / p_ind, and draw again those that the host resampled in
// proportion to it. A path is named by its group and number, so only weights and film positions leave the device.
#include "entry/path_kernel.cl"
#include "path/chain_state.cl"

// log(I / p_ind); LOG_ZERO where the draw comes to nothing, NaN where a density of a path that was drawn is not a number.
real log_path_weight(Scene *scene, uint seed, uint group, uint number, int length, int ending, Path *path, Radiance *radiance,
                     real *log_p) {
    Rng rng = rng_open(seed, number, group, PURPOSE_BOOTSTRAP);
    if (!sample_path(scene, length, ending, &rng, path, radiance)) return LOG_ZERO;
    *log_p = log_independent_density(scene, path);
    real weight = radiance->log_i - *log_p;
    return isfinite(weight) ? weight : NAN;
}

PATH_KERNEL void weigh_candidates(SCENE_PARAMETERS, uint seed, uint group, int length, int ending, uint first, uint count,
                                  __global real *log_weights, __global real *positions) {
    uint index = get_global_id(0);
    if (index >= count) return;
    Scene scene = SCENE_BUNDLE;
    Path path;
    Radiance radiance;
    real log_p;
    real2 position = (real2)(NAN);
    log_weights[index] = log_path_weight(&scene, seed, group, first + index, length, ending, &path, &radiance, &log_p);
    if (is_log_of_some(log_weights[index])) film_position(&scene, path.vertex[1].v, &position);
    vstore2(position, index, positions);
}

PATH_KERNEL void start_chains(SCENE_PARAMETERS, uint seed, uint chains, __global const ChainStart *starts,
                              __global ChainState *states) {
    uint index = get_global_id(0);
    if (index >= chains) return;
    Scene scene = SCENE_BUNDLE;
    Path path = {0};
    Radiance radiance;
    ChainStart start = starts[index];
    __global ChainState *state = &states[index];
    real log_p;
    bool found = is_log_of_some(
        log_path_weight(&scene, seed, start.group, start.number, start.length, start.ending, &path, &radiance, &log_p));
    // A compiler may round differently here than in weigh_candidates, so that a path on the edge of existence is not found
    // again: its chain starts dark, and leaves by its first large step.
    path.length = start.length;
    path.ending = start.ending;
    store_path(&scene, &path, state);
    state->slot = start.slot;
    state->log_i = found ? radiance.log_i : LOG_ZERO;
    state->log_p = found ? log_p : 0.0;
    vstore3(found ? colour_over_density(&radiance) : (real3)(0.0), 0, state->colour);
}
