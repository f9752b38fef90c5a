// The bidirectional independent sampler (theory.md, 6): pick a split k uniformly, draw x_1 .. x_k from the camera and the
// rest from the light. p_ind is the mean over all splits of the products of densities (the balance heuristic), in the
// solid-angle measure of the path's free directions, times the probability of the path's lobe choices.
#ifndef PYLMC_INDEPENDENT
#define PYLMC_INDEPENDENT

#include "path/integrand.cl"

int split_count(int length, int ending) { return ending == ENDING_HIT ? length + 1 : length; }

// x_1 .. x_k, from the camera.
bool draw_from_camera(Scene *scene, Path *path, int k, Rng *rng) {
    for (int i = 1; i <= k; i++) {
        real3 direction;
        if (i == 1) {
            direction = sample_camera(scene, rng);
            if (!is_positive(camera_importance(scene, direction))) return false;
        } else {
            Vertex *from = &path->vertex[i - 1];
            if (!lobe_sample(scene, from, -from->v, rng, &direction)) return false;
        }
        Vertex *vertex = &path->vertex[i];
        if (!trace_to_vertex(scene, &path->vertex[i - 1], direction, vertex)) return false;
        vertex->lobe = choose_lobe(scene, vertex->material, rng);
    }
    return true;
}

// x_K .. x_{k+1}, from the light.
bool draw_from_light(Scene *scene, Path *path, int k, Rng *rng) {
    int length = path->length;
    Vertex *last = &path->vertex[length];
    if (path->ending == ENDING_CONNECT) {
        path->light = sample_light(scene, rng);
        place_at_light(scene, path->light, last);
    } else {
        sample_emitter(scene, rng, last);
        if (!is_met(scene, last)) return false;
    }
    for (int j = length - 1; j > k; j--) {
        Vertex *from = &path->vertex[j + 1], *vertex = &path->vertex[j];
        real3 direction;
        if (j == length - 1)
            direction = path->ending == ENDING_HIT ? sample_emitter_emission(scene, last, rng)
                                                   : sample_light_emission(scene, path->light, rng, last);
        else if (!lobe_sample(scene, from, path->vertex[j + 2].v, rng, &direction))
            return false;
        if (!trace_to_vertex(scene, from, direction, vertex)) return false;
        from->v = -direction;  // segment j+1, as travelled from the camera
        from->t = is_infinite(from) ? 1.0 : vertex->t;
        vertex->lobe = choose_lobe(scene, vertex->material, rng);
    }
    return true;
}

// Which of a pair of lobes the finished path uses at each node: the directions say.
void settle_lobes(const Scene *scene, Path *path) {
    for (int i = 1; i < path->length; i++) settle_lobe(scene, &path->vertex[i], -path->vertex[i].v, path->vertex[i + 1].v);
}

int choose_split(int length, int ending, Rng *rng) { return rng_index(rng, split_count(length, ending)); }

// Draw a path of the given length, ending and split, and its integrand; false where the draw came to nothing (its weight is zero).
bool sample_split(Scene *scene, int length, int ending, int k, Rng *rng, Path *path, Radiance *radiance) {
    path->length = length;
    path->ending = ending;
    path->light = 0;
    start_at_camera(scene, &path->vertex[0]);
    if (!draw_from_camera(scene, path, k, rng)) return false;
    if (k < length) {
        if (!draw_from_light(scene, path, k, rng)) return false;
        Vertex *near = &path->vertex[k], *far = &path->vertex[k + 1];
        if (!join_nodes(near, far)) return false;
        if (k == 0 && !is_positive(camera_importance(scene, far->v))) return false;
        settle_lobes(scene, path);
        *radiance = integrand(scene, path);
        return !is_minus_infinity(radiance->log_i) && visible(scene, near, far);
    }
    settle_lobes(scene, path);
    *radiance = integrand(scene, path);
    return !is_minus_infinity(radiance->log_i);
}

bool sample_path(Scene *scene, int length, int ending, Rng *rng, Path *path, Radiance *radiance) {
    int k = choose_split(length, ending, rng);
    return sample_split(scene, length, ending, k, rng, path, radiance);
}

// log p_ind of any path.
real log_independent_density(const Scene *scene, const Path *path) {
    int length = path->length;
    bool hit = path->ending == ENDING_HIT;
    const Vertex *last = &path->vertex[length];
    // log of the densities of all x_j, j > k, drawn from the light, as k goes from K down; and the lobe choices
    real from_light[MAX_DEPTH + 1];
    real log_choices = 0.0;
    from_light[length] = 0.0;
    for (int k = length - 1; k >= 0; k--) {
        const Vertex *to = &path->vertex[k + 1];  // the node drawn here
        real density;
        if (k == length - 1) {
            // solid angle at x_{K-1} where the last direction is free, else the light's probability
            density = hit ? emitter_density(scene, last) * square(last->t) / fabs(dot(last->ng, last->v))
                          : light_probability(scene, path->light);
        } else {
            const Vertex *from = &path->vertex[k + 2];
            real3 direction = -from->v;
            if (k < length - 2)
                density = lobe_density(scene, from, path->vertex[k + 3].v, direction);
            else
                density = hit ? emitter_emission_density(scene, last, direction)
                              : light_emission_density(scene, path->light, to->x, direction);
            // from solid angle at x_{k+2} to solid angle at x_k
            density *= fabs(dot(to->ng, direction)) * square(to->t) / (square(from->t) * fabs(dot(to->ng, to->v)));
            log_choices += log(choice_probability(scene, to->lobe));
        }
        from_light[k] = from_light[k + 1] + log(density);
    }
    // run up from the camera, adding the splits
    int splits = split_count(length, path->ending);
    real from_camera = 0.0, log_sum = LOG_ZERO;
    for (int k = 0; k < splits; k++) {
        if (k > 0) {
            const Vertex *from = &path->vertex[k - 1];
            real3 direction = path->vertex[k].v;
            from_camera += log(k == 1 ? camera_density(scene, direction) : lobe_density(scene, from, -from->v, direction));
        }
        real term = from_camera + from_light[k];
        if (is_log_of_some(term)) {
            real high = fmax(log_sum, term), low = fmin(log_sum, term);
            log_sum = high + log(1.0 + exp(low - high));
        }
    }
    return log_sum - log((real)splits) + log_choices;
}

#endif
