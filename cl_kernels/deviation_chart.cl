// Direction from deviation, Omega, about a reference direction s with frame (p, q) (theory.md, 2, Charts):
//
//   equal-area    v = (1 - rho^2/2) s + sqrt(1 - rho^2/4) (Omega_p p + Omega_q q),   rho < 2,  dsigma/dOmega = 1
//   orthographic  v = sqrt(1 - rho^2) s + Omega_p p + Omega_q q,  eq. (2),           rho < 1,  dsigma/dOmega = 1/sqrt(1 - rho^2)
//
// orthographic-unit is the latter with the Jacobian taken as one, as the preprint prints it: biased, kept for comparison.
#ifndef PYLMC_DEVIATION_CHART
#define PYLMC_DEVIATION_CHART

#include "vectors.cl"

// v = along * s + across * (Omega_p p + Omega_q q); false outside the chart's domain.
bool chart_coefficients(float2 omega, float *along, float *across) {
    float rho2 = dot(omega, omega);
#if CHART == CHART_EQUAL_AREA
    *along = 1.0f - 0.5f * rho2;
    *across = sqrt(fmax(0.0f, 1.0f - 0.25f * rho2));
    return rho2 < 4.0f;
#else
    *along = sqrt(fmax(0.0f, 1.0f - rho2));
    *across = 1.0f;
    return rho2 < 1.0f;
#endif
}

bool deviation_direction(float2 omega, float3 s, float3 p, float3 *v) {
    float along, across;
    if (!chart_coefficients(omega, &along, &across)) return false;
    *v = normalize(along * s + across * (omega.x * p + omega.y * cross(s, p)));
    return true;
}

// The inverse. False where v is beyond the chart's reach.
bool deviation_of(float3 v, float3 s, float3 p, float2 *omega) {
    *omega = (float2)(dot(v, p), dot(v, cross(s, p)));
#if CHART == CHART_EQUAL_AREA
    float half_cosine2 = 0.5f * (1.0f + dot(s, v));
    *omega *= rsqrt(fmax(half_cosine2, 1e-20f));
    return half_cosine2 > 0.0f;
#else
    return dot(s, v) > 0.0f;
#endif
}

// log dsigma/dOmega.
float deviation_log_jacobian(float2 omega) {
#if CHART == CHART_ORTHOGRAPHIC
    return -0.5f * log(1.0f - dot(omega, omega));
#else
    return 0.0f;
#endif
}

// d(along) and d(across) per unit of d(rho^2)/2 = Omega.dOmega.
float2 chart_slopes(float along, float across) {
#if CHART == CHART_EQUAL_AREA
    return (float2)(-1.0f, -0.25f / fmax(across, 1e-4f));
#else
    return (float2)(-1.0f / fmax(along, 1e-4f), 0.0f);
#endif
}

#endif
