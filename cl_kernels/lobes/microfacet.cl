// The GGX distribution of microfacet normals (Walter et al. 2007), its masking term, and the sampling of visible normals
// (Heitz 2018; spherical caps of Dupuy and Benyoub 2023). All directions point away from the surface; n is on w_i's side.
#ifndef PYLMC_MICROFACET
#define PYLMC_MICROFACET

#include "number/vectors.cl"

// D(h). The sine is a cross product and not sqrt(1 - cos^2): at alpha = 1e-4 the latter has no digits left.
real ggx_density(real3 h, real3 n, real alpha) {
    real a2 = alpha * alpha;
    real c = dot(h, n);
    real s2 = length2(cross(h, n));
    return 1.0 / (PI * a2 * square(c * c + s2 / a2));
}

// Smith's Lambda: G1 = 1 / (1 + Lambda).
real ggx_lambda(real3 w, real3 n, real alpha) {
    real c = dot(w, n);
    real tan2 = length2(cross(w, n)) / fmax(c * c, 1e-20);
    return 0.5 * (sqrt(1.0 + alpha * alpha * tan2) - 1.0);
}

// Masking and shadowing of both directions; height-correlated, or the separable product.
real ggx_masking(real lambda_i, real lambda_o, int separable) {
    return separable ? 1.0 / ((1.0 + lambda_i) * (1.0 + lambda_o)) : 1.0 / (1.0 + lambda_i + lambda_o);
}

// A visible normal, of density G1(w_i) D(h) |w_i.h| / |w_i.n|.
real3 ggx_sample_visible(real3 wi, real3 n, real alpha, real u1, real u2) {
    real3 tangent = any_tangent(n), bitangent = cross(n, tangent);
    real3 stretched = normalize((real3)(alpha * dot(wi, tangent), alpha * dot(wi, bitangent), dot(wi, n)));
    real z = (1.0 - u2) * (1.0 + stretched.z) - stretched.z;
    real sine = sqrt(fmax(0.0, 1.0 - z * z));
    real angle = 2.0 * PI * u1;
    real3 cap = (real3)(sine * cos(angle), sine * sin(angle), z) + stretched;
    return normalize(alpha * cap.x * tangent + alpha * cap.y * bitangent + fmax(cap.z, 1e-12) * n);
}

// Unpolarised Fresnel reflectance; eta is the index of the far side over that of the near side.
real fresnel_dielectric(real cosine_i, real eta) {
    real cosine_t2 = 1.0 - (1.0 - cosine_i * cosine_i) / (eta * eta);
    if (cosine_t2 <= 0.0) return 1.0;
    real cosine_t = sqrt(cosine_t2);
    real s = (cosine_i - eta * cosine_t) / (cosine_i + eta * cosine_t);
    real p = (eta * cosine_i - cosine_t) / (eta * cosine_i + cosine_t);
    return 0.5 * (s * s + p * p);
}

// Its derivative in cosine_i; zero at total reflection. It has a pole at the critical angle, cut off here.
real fresnel_slope(real cosine_i, real eta) {
    real cosine_t2 = 1.0 - (1.0 - cosine_i * cosine_i) / (eta * eta);
    if (cosine_t2 <= 0.0) return 0.0;
    real cosine_t = sqrt(fmax(cosine_t2, 1e-6));
    real across = cosine_i + eta * cosine_t, within = eta * cosine_i + cosine_t;
    real s = (cosine_i - eta * cosine_t) / across, p = (eta * cosine_i - cosine_t) / within;
    return 2.0 * (eta * eta - 1.0) / (eta * cosine_t) * (s / square(across) + p / square(within));
}

#endif
