// The gradient of log(f |cos|) of a lobe with respect to w_i, w_o and the normal, for the drift (theory.md, 4).
//
// Reflection and refraction alike are functions of the microfacet normal m ~ w_i + eta w_o (eta = 1 in reflection) through
// c = n.m, x_i = w_i.m and x_o = w_o.m, and of the cosines n.w_i and n.w_o.
#ifndef PYLMC_LOBE_GRADIENT
#define PYLMC_LOBE_GRADIENT

#include "lobes/lobes.cl"

typedef struct {
    real3 in, out, normal;
} LobeGradient;

// dLambda / d(cosine) of Smith's Lambda.
real ggx_lambda_slope(real cosine, real alpha) {
    real a2 = alpha * alpha, c2 = fmax(cosine * cosine, 1e-8);
    return -0.5 * a2 / (cosine * c2 * sqrt(1.0 + a2 * (1.0 / c2 - 1.0)));
}

LobeGradient lobe_gradient(const Scene *scene, const Vertex *vertex, real3 wi, real3 wo) {
    __global const Material *material = &scene->materials[vertex->material];
    // the gradient with respect to ns itself; `side` orients it towards w_i
    real side = dot(vertex->ns, wi) > 0.0 ? 1.0 : -1.0;
    real3 n = side * vertex->ns;
    real ci = dot(n, wi), co = dot(n, wo);
    LobeGradient g;
    g.in = (real3)(0.0);
    g.out = n / co;
    g.normal = side * wo / co;
#if HAS_GLOSSY
    if (vertex->lobe == LOBE_DIFFUSE) return g;
    real alpha = material->alpha;
    bool through = vertex->lobe == LOBE_TRANSMIT;
    real eta = material->ior > 0.0 ? relative_ior(material, vertex, wi) : 1.0;
    real bend = through ? eta : 1.0;
    real3 m = wi + bend * wo;
    real inverse = copysign(rsqrt(fmax(length2(m), 1e-20)), dot(m, n));
    m *= inverse;
    real c = dot(n, m), xi = dot(wi, m), xo = dot(wo, m);
    real a2 = alpha * alpha, u = c * c + length2(cross(n, m)) / a2;
    real by_c = -4.0 * c * (1.0 - 1.0 / a2) / u, by_xi = 0.0, by_xo = 0.0;
    if (material->ior > 0.0) {
        real slope = fresnel_slope(xi, eta), reflected = fresnel_dielectric(xi, eta);
        by_xi = through ? -slope / fmax(1.0 - reflected, 1e-6) : slope / reflected;
    } else if (material->schlick) {
        real f0 = luminance(vec3(material->specular) + vec3(material->specular_tinted) * vertex->tint);
        real grazing = 1.0 - fmin(xi, 1.0);
        real grazing4 = square(square(grazing));
        by_xi = -5.0 * (1.0 - f0) * grazing4 / (f0 + (1.0 - f0) * grazing4 * grazing);
    }
    if (through) {
        real both = xi + eta * xo;
        by_xi += 1.0 / xi - 2.0 / both;
        by_xo += 1.0 / xo - 2.0 * eta / both;
    }
    real li = ggx_lambda(wi, n, alpha), lo = ggx_lambda(wo, n, alpha);
    real slope_i = ggx_lambda_slope(ci, alpha), slope_o = copysign(1.0, co) * ggx_lambda_slope(fabs(co), alpha);
    real by_ci = -slope_i / (material->separable ? 1.0 + li : 1.0 + li + lo) - 1.0 / ci;
    real by_co = -slope_o / (material->separable ? 1.0 + lo : 1.0 + li + lo);
    real3 by_m = by_c * n + by_xi * wi + by_xo * wo;
    by_m = inverse * (by_m - dot(m, by_m) * m);
    g.in = by_m + by_xi * m + by_ci * n;
    g.out = bend * by_m + by_xo * m + by_co * n;
    g.normal = side * (by_c * m + by_ci * wi + by_co * wo);
#endif
    return g;
}

#endif
