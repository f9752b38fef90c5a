// The large step: an independent path of the same length and ending (theory.md, 6; pylmc/moves/large.py).
#ifndef PYLMC_MOVE_LARGE
#define PYLMC_MOVE_LARGE

#include "moves/step.cl"

typedef struct {
    int split;
} LargeStep;

int large_propose(Scene *scene, const Current *now, __global const float *numbers, Rng *rng, LargeStep *large,
                  MarkovStep *step) {
    large->split = choose_split(now->path->length, now->path->ending, rng);
    return STEP_OK;
}

// Each direction is drawn at the node that the last one led to, so that this stage takes random numbers as well.
int large_trace(Scene *scene, const Current *now, Rng *rng, LargeStep *large, Path *y, MarkovStep *step) {
    return sample_split(scene, now->path->length, now->path->ending, large->split, rng, y, &step->radiance) ? STEP_OK
                                                                                                            : STEP_NO_PATH;
}

int large_weigh(Scene *scene, Current *now, LargeStep *large, const Path *y, MarkovStep *step) {
    if (!is_known(now->log_p)) now->log_p = log_independent_density(scene, now->path);
    step->log_forward = log_independent_density(scene, y);
    step->log_reverse = now->log_p;
    return STEP_OK;
}

#endif
