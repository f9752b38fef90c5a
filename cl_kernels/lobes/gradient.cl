// The gradient of log(f |cos|) of a lobe with respect to w_i, w_o and the shading normal, for the drift (theory.md, 4).
//
// Reflection and refraction by microfacets alike are functions of the facet's normal m ~ w_i + bend w_o (bend: 1 in
// reflection, eta in refraction) through c = n.m, x_i = w_i.m and x_o = w_o.m, and of the cosines n.w_i and n.w_o.
#ifndef PYLMC_GRADIENT
#define PYLMC_GRADIENT

#include "lobes/microfacet.cl"

typedef struct {
    real3 in, out, normal;
} LobeGradient;

// Of a lobe that is the cosine alone. n is the normal on w_i's side, `side` what orients ns towards it.
LobeGradient cosine_gradient(real3 n, real side, real3 wo) {
    real co = dot(n, wo);
    LobeGradient g;
    g.in = (real3)(0.0);
    g.out = n / co;
    g.normal = side * wo / co;
    return g;
}

typedef struct {
    real3 m;
    real inverse;  // 1 / |w_i + bend w_o|, on n's side
    real xi, xo;
} Facet;

Facet facet_between(real3 n, real3 wi, real3 wo, real bend) {
    Facet facet;
    real3 m = wi + bend * wo;
    facet.inverse = copysign(rsqrt(fmax(length2(m), 1e-20)), dot(m, n));
    facet.m = m * facet.inverse;
    facet.xi = dot(wi, facet.m);
    facet.xo = dot(wo, facet.m);
    return facet;
}

// dLambda / d(cosine) of Smith's Lambda.
real ggx_lambda_slope(real cosine, real alpha) {
    real a2 = alpha * alpha, c2 = fmax(cosine * cosine, 1e-8);
    return -0.5 * a2 / (cosine * c2 * sqrt(1.0 + a2 * (1.0 / c2 - 1.0)));
}

// Of D times Smith's masking over cos theta_i, times a function whose logarithm has slopes by_xi and by_xo.
LobeGradient facet_gradient(const Facet *facet, real3 n, real side, real3 wi, real3 wo, real alpha, int separable, real bend,
                            real by_xi, real by_xo) {
    real3 m = facet->m;
    real ci = dot(n, wi), co = dot(n, wo), c = dot(n, m);
    real a2 = alpha * alpha, u = c * c + length2(cross(n, m)) / a2;
    real by_c = -4.0 * c * (1.0 - 1.0 / a2) / u;
    real li = ggx_lambda(wi, n, alpha), lo = ggx_lambda(wo, n, alpha);
    real slope_i = ggx_lambda_slope(ci, alpha), slope_o = copysign(1.0, co) * ggx_lambda_slope(fabs(co), alpha);
    real by_ci = -slope_i / (separable ? 1.0 + li : 1.0 + li + lo) - 1.0 / ci;
    real by_co = -slope_o / (separable ? 1.0 + lo : 1.0 + li + lo);
    real3 by_m = by_c * n + by_xi * wi + by_xo * wo;
    by_m = facet->inverse * (by_m - dot(m, by_m) * m);
    LobeGradient g;
    g.in = by_m + by_xi * m + by_ci * n;
    g.out = bend * by_m + by_xo * m + by_co * n;
    g.normal = side * (by_c * m + by_ci * wi + by_co * wo);
    return g;
}

#endif
