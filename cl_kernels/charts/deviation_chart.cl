// Direction from deviation, Omega, about a reference direction s with frame (p, q) (theory.md, 2, Charts):
//
//   equal-area    v = (1 - rho^2/2) s + sqrt(1 - rho^2/4) (Omega_p p + Omega_q q),   rho < 2,  dsigma/dOmega = 1
//   orthographic  v = sqrt(1 - rho^2) s + Omega_p p + Omega_q q,  eq. (2),           rho < 1,  dsigma/dOmega = 1/sqrt(1 - rho^2)
//
// orthographic-unit is the latter with the Jacobian taken as one, as the preprint prints it: biased, kept for comparison.
#ifndef PYLMC_DEVIATION_CHART
#define PYLMC_DEVIATION_CHART

#include "number/vectors.cl"

// v = along * s + across * (Omega_p p + Omega_q q); false outside the chart's domain.
bool chart_coefficients(real2 omega, real *along, real *across) {
    real rho2 = dot(omega, omega);
#if CHART == CHART_EQUAL_AREA
    *along = 1.0 - 0.5 * rho2;
    *across = sqrt(fmax(0.0, 1.0 - 0.25 * rho2));
    return rho2 < 4.0;
#else
    *along = sqrt(fmax(0.0, 1.0 - rho2));
    *across = 1.0;
    return rho2 < 1.0;
#endif
}

bool deviation_direction(real2 omega, real3 s, real3 p, real3 *v) {
    real along, across;
    if (!chart_coefficients(omega, &along, &across)) return false;
    *v = normalize(along * s + across * (omega.x * p + omega.y * cross(s, p)));
    return true;
}

// The inverse. False where v is beyond the chart's reach.
bool deviation_of(real3 v, real3 s, real3 p, real2 *omega) {
    *omega = (real2)(dot(v, p), dot(v, cross(s, p)));
#if CHART == CHART_EQUAL_AREA
    real half_cosine2 = 0.5 * (1.0 + dot(s, v));
    *omega *= rsqrt(fmax(half_cosine2, 1e-20));
    return half_cosine2 > 0.0;
#else
    return dot(s, v) > 0.0;
#endif
}

// log dsigma/dOmega.
real deviation_log_jacobian(real2 omega) {
#if CHART == CHART_ORTHOGRAPHIC
    return -0.5 * log(1.0 - dot(omega, omega));
#else
    return 0.0;
#endif
}

// d(along) and d(across) per unit of d(rho^2)/2 = Omega.dOmega.
real2 chart_slopes(real along, real across) {
#if CHART == CHART_EQUAL_AREA
    return (real2)(-1.0, -0.25 / fmax(across, 1e-4));
#else
    return (real2)(-1.0 / fmax(along, 1e-4), 0.0);
#endif
}

#endif
