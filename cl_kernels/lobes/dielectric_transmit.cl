// The refracted part of a rough interface between dielectrics (Walter et al. 2007; pylmc/lobes/dielectric.py). Radiance
// carries the 1 / eta^2 of the solid angle's compression, as seen from the camera.
#ifndef PYLMC_DIELECTRIC_TRANSMIT
#define PYLMC_DIELECTRIC_TRANSMIT

#include "lobes/interface.cl"

real3 dielectric_transmit_value(__global const Lobe *lobe, const Vertex *vertex, real3 n, real3 wi, real3 wo, real *scale) {
    real ci = dot(n, wi), co = dot(n, wo);
    if (co >= 0.0 || dot(vertex->ng, wi) * dot(vertex->ng, wo) >= 0.0) return (real3)(0.0);
    real eta = relative_ior(lobe, vertex, wi);
    real3 m = wi + eta * wo;
    m *= copysign(rsqrt(fmax(length2(m), 1e-30)), dot(m, n));
    real im = dot(wi, m), om = dot(wo, m);
    if (im <= 0.0 || om >= 0.0) return (real3)(0.0);
    real masking = ggx_masking(ggx_lambda(wi, n, lobe->alpha), ggx_lambda(wo, n, lobe->alpha), lobe->separable);
    real transmitted = 1.0 - fresnel_dielectric(im, eta);
    *scale = transmitted * ggx_density(m, n, lobe->alpha) * masking * im * -om / (ci * square(im + eta * om));
    return (real3)(1.0);
}

real dielectric_transmit_density(const Scene *scene, __global const Lobe *lobe, const Vertex *vertex, real3 known,
                                 real3 other) {
    real3 n = normal_towards(vertex, known);
    real ci = dot(n, known), co = dot(n, other);
    real g1 = 1.0 / (1.0 + ggx_lambda(known, n, lobe->alpha));
    if (co >= 0.0) return 0.0;
    real eta = relative_ior(lobe, vertex, known);
    real3 m = known + eta * other;
    m *= copysign(rsqrt(fmax(length2(m), 1e-30)), dot(m, n));
    real im = dot(known, m), om = dot(other, m);
    if (im <= 0.0 || om >= 0.0) return 0.0;
    real visible_density = g1 * ggx_density(m, n, lobe->alpha) * im / fmax(ci, 1e-20);
    return (1.0 - fresnel_dielectric(im, eta)) * visible_density * eta * eta * -om / square(im + eta * om);
}

bool dielectric_transmit_sample(const Scene *scene, __global const Lobe *lobe, Vertex *vertex, real3 known, Rng *rng,
                                real3 *other) {
    return interface_sample(lobe, vertex, known, rng, other);
}

LobeGradient dielectric_transmit_gradient(__global const Lobe *lobe, const Vertex *vertex, real3 n, real side, real3 wi,
                                          real3 wo) {
    real eta = relative_ior(lobe, vertex, wi);
    Facet facet = facet_between(n, wi, wo, eta);
    real both = facet.xi + eta * facet.xo;
    real by_xi = -fresnel_slope(facet.xi, eta) / fmax(1.0 - fresnel_dielectric(facet.xi, eta), 1e-6);
    by_xi += 1.0 / facet.xi - 2.0 / both;
    real by_xo = 1.0 / facet.xo - 2.0 * eta / both;
    return facet_gradient(&facet, n, side, wi, wo, lobe->alpha, lobe->separable, eta, by_xi, by_xo);
}

#endif
