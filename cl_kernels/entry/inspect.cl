// The chains laid open, for the Sampler's arrays and for tests: nodes, directions, deviations, densities, the factor L, and
// where a given displacement in the charts or one step of the chain leads.
#include "entry/path_kernel.cl"
#include "constraints/preconditioner.cl"
#include "moves/displace.cl"
#include "moves/markov_step.cl"

// block: how many leading directions; 0: all free ones. A path with a direction out of its chart's reach has no kinds and no L.
PATH_KERNEL void describe_chains(SCENE_PARAMETERS, uint chains, __global const ChainState *states, int block,
                                 __global real *node_out, __global real *directions, __global real *deviations,
                                 __global int *kinds, __global int *lobes_out, __global real *densities, __global real *factors,
                                 __global real *gradients) {
    uint index = get_global_id(0);
    if (index >= chains) return;
    Scene scene = SCENE_BUNDLE;
    Path path;
    load_path(&scene, &states[index], &path);
    int m = block > 0 ? min(block, free_directions(&path)) : free_directions(&path);
    Radiance radiance = integrand(&scene, &path);
    densities[2 * index] = radiance.log_i;
    densities[2 * index + 1] = log_independent_density(&scene, &path);
    real3 p = any_tangent(path.vertex[1].v);
    Chart charts[MAX_DEPTH + 1];
    bool charted = charts_of_path(&scene, &path, m, p, charts);
    for (int i = 1; i <= path.length; i++) {
        size_t at = (size_t)index * MAX_DEPTH + i - 1;
        vstore3(node_position(&path, i), at, node_out);
        vstore3(path.vertex[i].v, at, directions);
        lobes_out[at] = i < path.length ? scene.lobes[path.vertex[i].lobe].signature : -1;
        kinds[at] = charted && i <= m ? charts[i].kind : -1;
    }
    // Omega_i, the deviation of v_{i+1}, i = 1 .. K-1
    for (int i = 1; i < path.length; i++) {
        const Vertex *here = &path.vertex[i];
        real3 s = reference_direction(&scene, here, here->v);
        real2 omega;
        p = transport_frame(&scene, here, here->v, p, s);
        deviation_of(path.vertex[i + 1].v, s, p, &omega);
        vstore2(omega, (size_t)index * MAX_DEPTH + i - 1, deviations);
        p = rotate_minimal(p, s, path.vertex[i + 1].v);
    }
    if (!charted) return;
    Factor factor;
    Row gradient;
    precondition(&scene, &path, m, any_tangent(path.vertex[1].v), charts, &factor, &gradient);
    for (int i = 0; i < factor.n; i++)
        for (int k = 0; k <= i; k++)
            factors[((size_t)index * 2 * MAX_DEPTH + i) * 2 * MAX_DEPTH + k] = factor_entry(&factor, i, k);
    for (int k = 0; k < factor.n; k++) gradients[(size_t)index * 2 * MAX_DEPTH + k] = row_entry(&gradient, k);
}

// Move each chain's path by deltas (2 * MAX_DEPTH a chain) and report the new nodes and directions; NaN where there is none.
PATH_KERNEL void displace_chains(SCENE_PARAMETERS, uint chains, __global const ChainState *states, int block,
                                 __global const real *deltas, __global real *node_out, __global real *directions) {
    uint index = get_global_id(0);
    if (index >= chains) return;
    Scene scene = SCENE_BUNDLE;
    Path path, moved;
    load_path(&scene, &states[index], &path);
    int m = block > 0 ? min(block, free_directions(&path)) : free_directions(&path);
    real3 p = any_tangent(path.vertex[1].v), p_new;
    Chart charts[MAX_DEPTH + 1];
    real delta[COLUMNS], log_jacobian;
    for (int k = 0; k < 2 * m; k++) delta[k] = deltas[(size_t)index * 2 * MAX_DEPTH + k];
    bool ok = charts_of_path(&scene, &path, m, p, charts) &&
              displaced_path(&scene, &path, m, delta, charts, p, &p_new, &moved, &log_jacobian);
    for (int i = 1; i <= path.length; i++) {
        size_t at = (size_t)index * MAX_DEPTH + i - 1;
        vstore3(ok ? node_position(&moved, i) : (real3)(NAN), at, node_out);
        vstore3(ok ? moved.vertex[i].v : (real3)(NAN), at, directions);
    }
}

// One step of each chain, which stay as they are: what was drawn, proposed and decided. numbers: the moves', see
// markov_step. drawn: what it is counted as, and its outcome; values:
// h, log p(X^|X), log p(X|X^), log of the density, acceptance, and the number that it was compared with.
PATH_KERNEL void try_step(SCENE_PARAMETERS, uint seed, ulong step, uint chains, __global const float *numbers,
                          __global const ChainState *states, __global int *drawn, __global real *values, __global real *xi_out,
                          __global real *node_out, __global real *directions, __global int *lobes_out,
                          __global int *triangles_met) {
    uint index = get_global_id(0);
    if (index >= chains) return;
    Scene scene = SCENE_BUNDLE;
    Path path, proposal;
    load_path(&scene, &states[index], &path);
    Current current = {&path, states[index].log_i, states[index].log_p};
    Rng rng = rng_open(seed, index, step, PURPOSE_CHAIN);
    MarkovStep taken;
    markov_step(&scene, &current, numbers, &rng, &proposal, &taken);
    drawn[2 * index] = taken.column;
    drawn[2 * index + 1] = taken.outcome;
    __global real *out = values + 6 * index;
    out[0] = taken.h;
    out[1] = taken.log_forward;
    out[2] = taken.log_reverse;
    out[3] = taken.radiance.log_i;
    out[4] = taken.acceptance;
    out[5] = taken.drawn;
    for (int k = 0; k < taken.normals; k++) xi_out[(size_t)index * 2 * MAX_DEPTH + k] = taken.xi[k];
    if (taken.outcome == STEP_NO_PATH) return;
    for (int i = 1; i <= path.length; i++) {
        size_t at = (size_t)index * MAX_DEPTH + i - 1;
        vstore3(node_position(&proposal, i), at, node_out);
        vstore3(proposal.vertex[i].v, at, directions);
        bool on_light = path.ending == ENDING_CONNECT && i == path.length;
        triangles_met[at] = on_light ? -1 : proposal.vertex[i].triangle;
        lobes_out[at] = i < path.length ? scene.lobes[proposal.vertex[i].lobe].signature : -1;
    }
}
