// One step of a chain (theory.md, 6): one of the moves, and Hastings' rule. The chains take it (chains.cl), and whoever wants to
// look at one step (inspect.cl).
//
// MOVES(F) is F(NUMBER, name, State, column, numbers) for each of them, MOVE_FILES are their files (pylmc/moves). A file defines
// the stages name_propose, name_trace and name_weigh and what they hand on, as moves/large.cl does.
#ifndef PYLMC_MARKOV_STEP
#define PYLMC_MARKOV_STEP

#include "moves/step.cl"
#include "path/chain_state.cl"
#include MOVE_FILES

bool step_accepted(const MarkovStep *step) { return step->drawn < step->acceptance; }

// Which move: numbers begin with the moves' cumulative chances. A chain that is nowhere can only be sent elsewhere.
int choose_move(__global const float *numbers, real log_i, real u) {
    if (!is_log_of_some(log_i)) return MOVE_LARGE;
    int move = 0;
    while (move < NUM_MOVES - 1 && u >= numbers[move]) move++;
    return move;
}

// Hastings' rule, and the number that decides.
void decide(const Current *now, Rng *rng, MarkovStep *step) {
    real log_acceptance = -INFINITY;
    if (step->outcome == STEP_OK)
        log_acceptance = (step->radiance.log_i - now->log_i) + (step->log_reverse - step->log_forward);
    // a path that was drawn and whose density rounds to zero would be taken for sure and never be left again
    if (step->outcome == STEP_OK && !isfinite(step->log_forward)) log_acceptance = NAN;
    if (isnan(log_acceptance)) {
        step->outcome = STEP_NOT_FINITE;
        log_acceptance = -INFINITY;
    }
    step->acceptance = exp(fmin(log_acceptance, 0.0));
    if (step->acceptance > 0.0) step->drawn = rng_uniform(rng);
}

// Propose y and decide. numbers: the moves' cumulative chances, then each one's own numbers (pylmc/moves).
void markov_step(Scene *scene, Current *now, __global const float *numbers, Rng *rng, Path *y, MarkovStep *step) {
    step->h = NAN;
    step->normals = 0;
    step->log_forward = NAN;
    step->log_reverse = NAN;
    step->drawn = NAN;
    step->radiance.log_i = LOG_ZERO;
    step->move = choose_move(numbers, now->log_i, rng_uniform(rng));
#define MOVE_CASE(NUMBER, name, State, first_column, first_number)                                    \
    case NUMBER: {                                                                                    \
        State state;                                                                                  \
        step->column = first_column;                                                                  \
        step->outcome = name##_propose(scene, now, numbers + first_number, rng, &state, step);        \
        if (step->outcome == STEP_OK) step->outcome = name##_trace(scene, now, rng, &state, y, step); \
        if (step->outcome == STEP_OK) step->outcome = name##_weigh(scene, now, &state, y, step);      \
        break;                                                                                        \
    }
    switch (step->move) { MOVES(MOVE_CASE) }
#undef MOVE_CASE
    decide(now, rng, step);
}

#endif
