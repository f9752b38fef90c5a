// The GGX distribution of microfacet normals (Walter et al. 2007), its masking term, and the sampling of visible normals
// (Heitz 2018; spherical caps of Dupuy and Benyoub 2023). All directions point away from the surface; n is on w_i's side.
#ifndef PYLMC_MICROFACET
#define PYLMC_MICROFACET

#include "vectors.cl"

// D(h). The sine is a cross product and not sqrt(1 - cos^2): at alpha = 1e-4 the latter has no digits left.
float ggx_density(float3 h, float3 n, float alpha) {
    float a2 = alpha * alpha;
    float c = dot(h, n);
    float s2 = length2(cross(h, n));
    return 1.0f / (PI * a2 * square(c * c + s2 / a2));
}

// Smith's Lambda: G1 = 1 / (1 + Lambda).
float ggx_lambda(float3 w, float3 n, float alpha) {
    float c = dot(w, n);
    float tan2 = length2(cross(w, n)) / fmax(c * c, 1e-20f);
    return 0.5f * (sqrt(1.0f + alpha * alpha * tan2) - 1.0f);
}

// Masking and shadowing of both directions; height-correlated, or the separable product.
float ggx_masking(float lambda_i, float lambda_o, int separable) {
    return separable ? 1.0f / ((1.0f + lambda_i) * (1.0f + lambda_o)) : 1.0f / (1.0f + lambda_i + lambda_o);
}

// A visible normal, of density G1(w_i) D(h) |w_i.h| / |w_i.n|.
float3 ggx_sample_visible(float3 wi, float3 n, float alpha, float u1, float u2) {
    float3 tangent = any_tangent(n), bitangent = cross(n, tangent);
    float3 stretched = normalize((float3)(alpha * dot(wi, tangent), alpha * dot(wi, bitangent), dot(wi, n)));
    float z = (1.0f - u2) * (1.0f + stretched.z) - stretched.z;
    float sine = sqrt(fmax(0.0f, 1.0f - z * z));
    float angle = 2.0f * PI * u1;
    float3 cap = (float3)(sine * cos(angle), sine * sin(angle), z) + stretched;
    return normalize(alpha * cap.x * tangent + alpha * cap.y * bitangent + fmax(cap.z, 1e-12f) * n);
}

// Unpolarised Fresnel reflectance; eta is the index of the far side over that of the near side.
float fresnel_dielectric(float cosine_i, float eta) {
    float cosine_t2 = 1.0f - (1.0f - cosine_i * cosine_i) / (eta * eta);
    if (cosine_t2 <= 0.0f) return 1.0f;
    float cosine_t = sqrt(cosine_t2);
    float s = (cosine_i - eta * cosine_t) / (cosine_i + eta * cosine_t);
    float p = (eta * cosine_i - cosine_t) / (eta * cosine_i + cosine_t);
    return 0.5f * (s * s + p * p);
}

#endif
