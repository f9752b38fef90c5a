// The independent sampler alone: integrator="bdpt", and groups of which the chains' start found no path. Each work-item draws
// paths of its group and splats C / p_ind, times the group's scale. Its counters begin at first; weights are counted in units
// of one over the scale.
#include "entry/path_kernel.cl"
#include "path/chain_state.cl"
#include "path/film.cl"

PATH_KERNEL void render_independent(SCENE_PARAMETERS, uint seed, ulong first_step, int steps, uint streams, uint first,
                                    __global const ChainStart *groups, __global const FilmPlace *places,
                                    __global ChainCounters *counters, __global volatile uint *film, int film_pixels) {
    uint index = get_global_id(0);
    if (index >= streams) return;
    Scene scene = SCENE_BUNDLE;
    ChainStart group = groups[index];
    __global ChainCounters *count = &counters[first + index];
    FilmPlace place = places[group.slot];
    size_t slot = (size_t)place.slot * film_pixels;
    for (int step = 0; step < steps; step++) {
        Rng rng = rng_open(seed, index, first_step + step, PURPOSE_BDPT);
        Path path;
        count->proposed[0]++;
        Radiance radiance;
        if (!sample_path(&scene, group.length, group.ending, &rng, &path, &radiance)) continue;
        real weight = exp(radiance.log_i - log_independent_density(&scene, &path));
        if (!isfinite(weight)) {
            count->not_finite++;
            continue;
        }
        count->acceptance[0] += 1.0;
        weight *= group.scale;
        real3 colour = weight * colour_over_density(&radiance);
        film_add(film, slot + pixel_of(&scene, path.vertex[1].v), place.scale * colour);
        count->weight_sum += weight;
        count->weight_square_sum += weight * weight;
        count->splatted += luminance(colour);
    }
    count->rays += scene.rays;
}
