// Another light for the same path, whose last segment alone changes (pylmc/moves/relight.py).
#ifndef PYLMC_MOVE_RELIGHT
#define PYLMC_MOVE_RELIGHT

#include "moves/step.cl"

typedef struct {
    int light;
} RelightStep;

int relight_propose(Scene *scene, const Current *now, __global const float *numbers, Rng *rng, RelightStep *relight,
                    MarkovStep *step) {
    if (now->path->ending != ENDING_CONNECT) return STEP_NO_PATH;
    relight->light = sample_light(scene, rng);
    return relight->light != now->path->light ? STEP_OK : STEP_NO_PATH;
}

int relight_trace(Scene *scene, const Current *now, Rng *rng, RelightStep *relight, Path *y, MarkovStep *step) {
    *y = *now->path;
    y->light = relight->light;
    Vertex *near = &y->vertex[y->length - 1], *far = &y->vertex[y->length];
    place_at_light(scene, y->light, far);
    if (!join_nodes(near, far)) return STEP_NO_PATH;
    settle_lobe(scene, near, -near->v, far->v);
    step->radiance = integrand(scene, y);
    return !is_minus_infinity(step->radiance.log_i) && visible(scene, near, far) ? STEP_OK : STEP_NO_PATH;
}

// The directions that are free do not move: the densities are the lights' chances.
int relight_weigh(Scene *scene, Current *now, RelightStep *relight, const Path *y, MarkovStep *step) {
    step->log_forward = log(light_probability(scene, y->light));
    step->log_reverse = log(light_probability(scene, now->path->light));
    return STEP_OK;
}

#endif
