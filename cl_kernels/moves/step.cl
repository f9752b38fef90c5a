// What a step of a chain is made of, whichever move it is. A move is written in stages, a function each in its file: propose
// (random numbers, nothing traced), trace (a path, and whether it carries light) and weigh (the densities of the step and of its
// reverse); to decide is the same for all (markov_step.cl).
#ifndef PYLMC_STEP
#define PYLMC_STEP

#include "path/independent.cl"
#include "charts/tangent.cl"

typedef struct {
    int move;     // which of the moves
    int column;   // where it is counted: a move has one column or more
    int outcome;  // STEP_OK, ... (pylmc/device/tables.py)
    real h;
    int normals;        // how many normal numbers it drew
    real xi[COLUMNS];   // which
    real log_forward;   // log p(X^|X), as the move's weigh gives it; NAN without a proposal
    real log_reverse;   // log p(X|X^)
    real acceptance;    // its probability
    real drawn;         // the uniform number that it was compared with; NAN where it is zero
    Radiance radiance;  // of the proposal
} MarkovStep;

// Where a chain is.
typedef struct {
    const Path *path;
    real log_i;
    real log_p;  // of the path by the independent sampler; UNKNOWN until a large step first needs it
} Current;

// Not known, of a log density: a finite number, since with math="fast" a compiler may take NaN for impossible.
#define UNKNOWN -1e30
bool is_known(real log_density) { return fabs(log_density) < 1e29; }

#endif
