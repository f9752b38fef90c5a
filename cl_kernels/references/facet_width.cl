// What a turn of the microfacet's normal by alpha does to the direction that leaves: its width in the plane of incidence and
// across it. ci, ct: cosines with the normal of arriving and leaving; eta: the side of arrival's index over the other's.
#ifndef PYLMC_FACET_WIDTH
#define PYLMC_FACET_WIDTH

#include "number/vectors.cl"

real2 facet_width(real alpha, real eta, real ci, real ct) {
    real turn = fabs(eta * ci - ct);
    return fmin(alpha * (real2)(turn / fmax(fabs(ct), 0.1), fmax(turn, 0.2)), (real2)(1.0));
}

#endif
