// One step of a chain (theory.md, 6): a large step (an independent path) with probability p_large, else a small one. The
// chains take it (chains.cl), and whoever wants to look at one step (inspect.cl).
#ifndef PYLMC_MARKOV_STEP
#define PYLMC_MARKOV_STEP

#include "path/chain_state.cl"
#include "moves/small_step.cl"

typedef struct {
    int move;     // 0: a large step; m: a small one of the block m
    int outcome;  // STEP_OK, ... (pylmc/device/tables.py)
    real h;
    real xi[COLUMNS];   // the small step's normal numbers
    real log_forward;   // log p(X^|X), as propose_small or log_independent_density gives it; NAN without a proposal
    real log_reverse;   // log p(X|X^)
    real acceptance;    // its probability
    real drawn;         // the uniform number that it was compared with; NAN where it is zero
    Radiance radiance;  // of the proposal
} MarkovStep;

// Not known, of a log density: a finite number, since with math="fast" a compiler may take NaN for impossible.
#define UNKNOWN -1e30
bool is_known(real log_density) { return fabs(log_density) < 1e29; }

bool step_accepted(const MarkovStep *step) { return step->drawn < step->acceptance; }

// Propose y from x and decide. log_p: of x by the independent sampler; UNKNOWN until a large step first needs it.
void markov_step(Scene *scene, const Path *x, real log_i, real *log_p, float p_large, float log_h_min, float log_h_max,
                 Rng *rng, Path *y, MarkovStep *step) {
    step->move = 0;
    step->outcome = STEP_NO_PATH;
    step->h = NAN;
    step->log_forward = NAN;
    step->log_reverse = NAN;
    step->drawn = NAN;
    step->radiance.log_i = LOG_ZERO;
    if (rng_uniform(rng) < p_large || !is_log_of_some(log_i)) {
        if (sample_path(scene, x->length, x->ending, rng, y, &step->radiance)) {
            if (!is_known(*log_p)) *log_p = log_independent_density(scene, x);
            step->log_forward = log_independent_density(scene, y);
            step->log_reverse = *log_p;
            step->outcome = STEP_OK;
        }
    } else {
        step->move = choose_block(scene, x, rng_uniform(rng));
        step->h = exp(log_h_min + (log_h_max - log_h_min) * rng_uniform(rng));
        for (int k = 0; k < 2 * step->move; k += 2) {
            real2 normal = rng_normal2(rng);
            step->xi[k] = normal.x;
            step->xi[k + 1] = normal.y;
        }
        step->outcome =
            propose_small(scene, x, step->move, step->h, step->xi, y, &step->radiance, &step->log_forward, &step->log_reverse);
    }
    real log_acceptance = -INFINITY;
    if (step->outcome == STEP_OK) log_acceptance = (step->radiance.log_i - log_i) + (step->log_reverse - step->log_forward);
    // a path that was drawn and whose density rounds to zero would be taken for sure and never be left again
    if (step->outcome == STEP_OK && !isfinite(step->log_forward)) log_acceptance = NAN;
    if (isnan(log_acceptance)) {
        step->outcome = STEP_NOT_FINITE;
        log_acceptance = -INFINITY;
    }
    step->acceptance = exp(fmin(log_acceptance, 0.0));
    if (step->acceptance > 0.0) step->drawn = rng_uniform(rng);
}

#endif
