// The lobes of a material: value, reference direction, sampling and its density.
//
// w_i points to the camera's side of the path (-v_i), w_o to the light's (v_{i+1}). Values are f |cos theta_o|, as radiance
// seen from the camera, so that a shading normal or a refraction counts alike whichever end a path was drawn from.
// Sampling is symmetric: from a known direction draw the other one, whichever of the two is known.
#ifndef PYLMC_LOBES
#define PYLMC_LOBES

#include "random.cl"
#include "surface.cl"
#include "microfacet.cl"
#include "aiming.cl"

// The normal on w's side, or zero where the shading and the geometric normal disagree on which side that is.
float3 facing_normal(const Vertex *vertex, float3 w) {
    float side_s = dot(vertex->ns, w), side_g = dot(vertex->ng, w);
    if (side_s * side_g <= 0.0f) return (float3)(0.0f);
    return side_s > 0.0f ? vertex->ns : -vertex->ns;
}

bool same_side(const Vertex *vertex, float3 a, float3 b) {
    return dot(vertex->ng, a) * dot(vertex->ng, b) > 0.0f && dot(vertex->ns, a) * dot(vertex->ns, b) > 0.0f;
}

// Index of the side that w_o is on over the side that w_i is on, were they opposite.
float relative_ior(__global const Material *material, const Vertex *vertex, float3 wi) {
    return dot(vertex->ns, wi) > 0.0f ? material->ior : 1.0f / material->ior;
}

// A material's own choice among its lobes, a function of the node alone. A dielectric's two lobes are one choice: which of
// them it is follows from the directions.
float choice_probability(__global const Material *material, int lobe) {
    if (lobe == LOBE_DIFFUSE) return material->choose_diffuse;
    return 1.0f - material->choose_diffuse;
}

int choose_lobe(__global const Material *material, Rng *rng) {
    if (material->choose_diffuse >= 1.0f) return LOBE_DIFFUSE;
    if (material->choose_diffuse > 0.0f && rng_uniform(rng) < material->choose_diffuse) return LOBE_DIFFUSE;
    return material->ior > 0.0f ? LOBE_DIELECTRIC_REFLECT : LOBE_REFLECT;
}

// Does a material have this lobe at all?
bool has_lobe(__global const Material *material, int lobe) {
    if (lobe == LOBE_DIFFUSE) return material->choose_diffuse > 0.0f;
    return material->choose_diffuse < 1.0f && (lobe != LOBE_REFLECT) == (material->ior > 0.0f);
}

// The value of the vertex's lobe: a colour, and its scale (f |cos|, of any size) by pointer; scale 0 where there is none.
float3 lobe_value(const Scene *scene, const Vertex *vertex, float3 wi, float3 wo, float *scale) {
    __global const Material *material = &scene->materials[vertex->material];
    *scale = 0.0f;
    float3 n = facing_normal(vertex, wi);
    float ci = dot(n, wi), co = dot(n, wo);
    if (ci <= 0.0f) return (float3)(0.0f);
#if HAS_TRANSMIT
    if (vertex->lobe == LOBE_TRANSMIT) {
        if (co >= 0.0f || dot(vertex->ng, wi) * dot(vertex->ng, wo) >= 0.0f) return (float3)(0.0f);
        float eta = relative_ior(material, vertex, wi);
        float3 m = wi + eta * wo;
        m *= copysign(rsqrt(fmax(length2(m), 1e-30f)), dot(m, n));
        float im = dot(wi, m), om = dot(wo, m);
        if (im <= 0.0f || om >= 0.0f) return (float3)(0.0f);
        float masking = ggx_masking(ggx_lambda(wi, n, material->alpha), ggx_lambda(wo, n, material->alpha), material->separable);
        float transmitted = 1.0f - fresnel_dielectric(im, eta);
        *scale = transmitted * ggx_density(m, n, material->alpha) * masking * im * -om / (ci * square(im + eta * om));
        return (float3)(1.0f);
    }
#endif
    if (!same_side(vertex, wi, wo)) return (float3)(0.0f);
#if HAS_DIFFUSE
    if (vertex->lobe == LOBE_DIFFUSE) {
        *scale = co * INV_PI;
        return vec3(material->diffuse) * vertex->tint;
    }
#endif
#if HAS_GLOSSY
    float3 h = normalize(wi + wo);
    float masking = ggx_masking(ggx_lambda(wi, n, material->alpha), ggx_lambda(wo, n, material->alpha), material->separable);
    *scale = ggx_density(h, n, material->alpha) * masking / (4.0f * ci);
    if (vertex->lobe == LOBE_DIELECTRIC_REFLECT)
        return (float3)(fresnel_dielectric(dot(wi, h), relative_ior(material, vertex, wi)));
    float3 f0 = vec3(material->specular) + vec3(material->specular_tinted) * vertex->tint;
    if (!material->schlick) return f0;
    float grazing = 1.0f - fmin(fabs(dot(wi, h)), 1.0f);
    return f0 + (1.0f - f0) * (square(square(grazing)) * grazing);
#else
    return (float3)(0.0f);
#endif
}

// Density, in solid angle, of drawing `other` at the vertex when `known` is given.
float lobe_density(const Scene *scene, const Vertex *vertex, float3 known, float3 other) {
    __global const Material *material = &scene->materials[vertex->material];
#if HAS_DIFFUSE
    if (vertex->lobe == LOBE_DIFFUSE) {
        float co = same_side(vertex, known, other) ? fabs(dot(vertex->ns, other)) : 0.0f;
        return aimed_density(scene, vertex->x, other, co * INV_PI, AIM_FROM_NODE);
    }
#endif
#if HAS_GLOSSY
    float3 n = dot(vertex->ns, known) > 0.0f ? vertex->ns : -vertex->ns;
    float ci = dot(n, known), co = dot(n, other);
    float g1 = 1.0f / (1.0f + ggx_lambda(known, n, material->alpha));
#if HAS_TRANSMIT
    if (vertex->lobe == LOBE_TRANSMIT) {
        if (co >= 0.0f) return 0.0f;
        float eta = relative_ior(material, vertex, known);
        float3 m = known + eta * other;
        m *= copysign(rsqrt(fmax(length2(m), 1e-30f)), dot(m, n));
        float im = dot(known, m), om = dot(other, m);
        if (im <= 0.0f || om >= 0.0f) return 0.0f;
        float visible_density = g1 * ggx_density(m, n, material->alpha) * im / fmax(ci, 1e-20f);
        return (1.0f - fresnel_dielectric(im, eta)) * visible_density * eta * eta * -om / square(im + eta * om);
    }
#endif
    if (co <= 0.0f || ci <= 0.0f) return 0.0f;
    float3 h = normalize(known + other);
    float density = g1 * ggx_density(h, n, material->alpha) / (4.0f * ci);
    if (vertex->lobe == LOBE_DIELECTRIC_REFLECT)
        density *= fresnel_dielectric(dot(known, h), relative_ior(material, vertex, known));
    return density;
#else
    return 0.0f;
#endif
}

// Draw the other direction. For a dielectric the choice of reflection or refraction is made here and written to the lobe.
bool lobe_sample(const Scene *scene, Vertex *vertex, float3 known, Rng *rng, float3 *other) {
    __global const Material *material = &scene->materials[vertex->material];
    float3 n = dot(vertex->ns, known) > 0.0f ? vertex->ns : -vertex->ns;
#if HAS_DIFFUSE
    if (vertex->lobe == LOBE_DIFFUSE) {
        if (sample_aim(scene, vertex->x, AIM_FROM_NODE, rng, other)) return true;
        float radius2 = rng_uniform(rng), angle = 2.0f * PI * rng_uniform(rng), radius = sqrt(radius2);
        float3 tangent = any_tangent(n);
        *other = normalize(radius * cos(angle) * tangent + radius * sin(angle) * cross(n, tangent) + sqrt(1.0f - radius2) * n);
        return true;
    }
#endif
#if HAS_GLOSSY
    float u1 = rng_uniform(rng), u2 = rng_uniform(rng);
    float3 h = ggx_sample_visible(known, n, material->alpha, u1, u2);
    float kh = dot(known, h);
    if (kh <= 0.0f) return false;
#if HAS_TRANSMIT
    if (material->ior > 0.0f) {
        float eta = relative_ior(material, vertex, known);
        vertex->lobe = LOBE_DIELECTRIC_REFLECT;
        if (rng_uniform(rng) >= fresnel_dielectric(kh, eta)) {
            vertex->lobe = LOBE_TRANSMIT;
            float cosine_t = sqrt(fmax(0.0f, 1.0f - (1.0f - kh * kh) / (eta * eta)));
            *other = normalize((kh / eta - cosine_t) * h - known / eta);
            return dot(*other, n) < 0.0f;
        }
    }
#endif
    *other = normalize(2.0f * kh * h - known);
    return dot(*other, n) > 0.0f;
#else
    return false;
#endif
}

// The direction that the lobe's deviation is counted from (theory.md, 2): mirror, refracted, or normal on w_i's side.
// v is the direction of arrival (-w_i).
float3 reference_direction(const Scene *scene, const Vertex *vertex, float3 v) {
    float3 n = dot(vertex->ns, v) < 0.0f ? vertex->ns : -vertex->ns;
    if (vertex->lobe == LOBE_DIFFUSE) return n;
#if HAS_TRANSMIT
    if (vertex->lobe == LOBE_TRANSMIT) {
        float eta = 1.0f / relative_ior(&scene->materials[vertex->material], vertex, -v);
        float ci = -dot(v, n);
        float ct = sqrt(fmax(0.0f, 1.0f - eta * eta * (1.0f - ci * ci)));
        return normalize(eta * v + (eta * ci - ct) * n);  // at total reflection: along the surface
    }
#endif
    return reflect_about(v, n);
}

#endif
