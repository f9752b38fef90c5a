// The gradient of log(f |cos|) of a lobe with respect to w_i, w_o and the normal, for the drift (theory.md, 4).
//
// Reflection and refraction alike are functions of the microfacet normal m ~ w_i + eta w_o (eta = 1 in reflection) through
// c = n.m, x_i = w_i.m and x_o = w_o.m, and of the cosines n.w_i and n.w_o.
#ifndef PYLMC_LOBE_GRADIENT
#define PYLMC_LOBE_GRADIENT

#include "lobes.cl"

typedef struct { float3 in, out, normal; } LobeGradient;

// dLambda / d(cosine) of Smith's Lambda.
float ggx_lambda_slope(float cosine, float alpha) {
    float a2 = alpha * alpha, c2 = fmax(cosine * cosine, 1e-8f);
    return -0.5f * a2 / (cosine * c2 * sqrt(1.0f + a2 * (1.0f / c2 - 1.0f)));
}

LobeGradient lobe_gradient(const Scene *scene, const Vertex *vertex, float3 wi, float3 wo) {
    __global const Material *material = &scene->materials[vertex->material];
    // the gradient with respect to ns itself; `side` orients it towards w_i
    float side = dot(vertex->ns, wi) > 0.0f ? 1.0f : -1.0f;
    float3 n = side * vertex->ns;
    float ci = dot(n, wi), co = dot(n, wo);
    LobeGradient g;
    g.in = (float3)(0.0f);
    g.out = n / co;
    g.normal = side * wo / co;
#if HAS_GLOSSY
    if (vertex->lobe == LOBE_DIFFUSE) return g;
    float alpha = material->alpha;
    bool through = vertex->lobe == LOBE_TRANSMIT;
    float eta = material->ior > 0.0f ? relative_ior(material, vertex, wi) : 1.0f;
    float bend = through ? eta : 1.0f;
    float3 m = wi + bend * wo;
    float inverse = copysign(rsqrt(fmax(length2(m), 1e-20f)), dot(m, n));
    m *= inverse;
    float c = dot(n, m), xi = dot(wi, m), xo = dot(wo, m);
    float a2 = alpha * alpha, u = c * c + length2(cross(n, m)) / a2;
    float by_c = -4.0f * c * (1.0f - 1.0f / a2) / u, by_xi = 0.0f, by_xo = 0.0f;
    if (material->ior > 0.0f) {
        float high = fmin(xi + 1e-3f, 1.0f), low = fmax(xi - 1e-3f, 0.0f);
        float slope = (fresnel_dielectric(high, eta) - fresnel_dielectric(low, eta)) / (high - low);
        float reflected = fresnel_dielectric(xi, eta);
        by_xi = through ? -slope / fmax(1.0f - reflected, 1e-6f) : slope / reflected;
    } else if (material->schlick) {
        float f0 = luminance(vec3(material->specular) + vec3(material->specular_tinted) * vertex->tint);
        float grazing = 1.0f - fmin(xi, 1.0f);
        float grazing4 = square(square(grazing));
        by_xi = -5.0f * (1.0f - f0) * grazing4 / (f0 + (1.0f - f0) * grazing4 * grazing);
    }
    if (through) {
        float both = xi + eta * xo;
        by_xi += 1.0f / xi - 2.0f / both;
        by_xo += 1.0f / xo - 2.0f * eta / both;
    }
    float li = ggx_lambda(wi, n, alpha), lo = ggx_lambda(wo, n, alpha);
    float slope_i = ggx_lambda_slope(ci, alpha), slope_o = copysign(1.0f, co) * ggx_lambda_slope(fabs(co), alpha);
    float by_ci = -slope_i / (material->separable ? 1.0f + li : 1.0f + li + lo) - 1.0f / ci;
    float by_co = -slope_o / (material->separable ? 1.0f + lo : 1.0f + li + lo);
    float3 by_m = by_c * n + by_xi * wi + by_xo * wo;
    by_m = inverse * (by_m - dot(m, by_m) * m);
    g.in = by_m + by_xi * m + by_ci * n;
    g.out = bend * by_m + by_xo * m + by_co * n;
    g.normal = side * (by_c * m + by_ci * wi + by_co * wo);
#endif
    return g;
}

#endif
