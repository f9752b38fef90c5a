// The lobes of a material: value, reference direction, sampling and its density.
//
// w_i points to the camera's side of the path (-v_i), w_o to the light's (v_{i+1}). Values are f |cos theta_o|, as radiance
// seen from the camera, so that a shading normal or a refraction counts alike whichever end a path was drawn from.
// Sampling is symmetric: from a known direction draw the other one, whichever of the two is known.
#ifndef PYLMC_LOBES
#define PYLMC_LOBES

#include "number/random.cl"
#include "surface/surface.cl"
#include "lobes/microfacet.cl"
#include "lights/aiming.cl"

// The normal on w's side, or zero where the shading and the geometric normal disagree on which side that is.
real3 facing_normal(const Vertex *vertex, real3 w) {
    real side_s = dot(vertex->ns, w), side_g = dot(vertex->ng, w);
    if (side_s * side_g <= 0.0) return (real3)(0.0);
    return side_s > 0.0 ? vertex->ns : -vertex->ns;
}

bool same_side(const Vertex *vertex, real3 a, real3 b) {
    return dot(vertex->ng, a) * dot(vertex->ng, b) > 0.0 && dot(vertex->ns, a) * dot(vertex->ns, b) > 0.0;
}

// Index of the side that w_o is on over the side that w_i is on, were they opposite.
real relative_ior(__global const Material *material, const Vertex *vertex, real3 wi) {
    return dot(vertex->ns, wi) > 0.0 ? material->ior : 1.0 / material->ior;
}

// A material's own choice among its lobes, a function of the node alone. A dielectric's two lobes are one choice: which of
// them it is follows from the directions.
real choice_probability(__global const Material *material, int lobe) {
    if (lobe == LOBE_DIFFUSE) return material->choose_diffuse;
    return 1.0 - material->choose_diffuse;
}

int choose_lobe(__global const Material *material, Rng *rng) {
    if (material->choose_diffuse >= 1.0) return LOBE_DIFFUSE;
    if (material->choose_diffuse > 0.0 && rng_uniform(rng) < material->choose_diffuse) return LOBE_DIFFUSE;
    return material->ior > 0.0 ? LOBE_DIELECTRIC_REFLECT : LOBE_REFLECT;
}

// Does a material have this lobe at all?
bool has_lobe(__global const Material *material, int lobe) {
    if (lobe == LOBE_DIFFUSE) return material->choose_diffuse > 0.0;
    return material->choose_diffuse < 1.0 && (lobe != LOBE_REFLECT) == (material->ior > 0.0);
}

// The value of the vertex's lobe: a colour, and its scale (f |cos|, of any size) by pointer; scale 0 where there is none.
real3 lobe_value(const Scene *scene, const Vertex *vertex, real3 wi, real3 wo, real *scale) {
    __global const Material *material = &scene->materials[vertex->material];
    *scale = 0.0;
    real3 n = facing_normal(vertex, wi);
    real ci = dot(n, wi), co = dot(n, wo);
    if (ci <= 0.0) return (real3)(0.0);
#if HAS_TRANSMIT
    if (vertex->lobe == LOBE_TRANSMIT) {
        if (co >= 0.0 || dot(vertex->ng, wi) * dot(vertex->ng, wo) >= 0.0) return (real3)(0.0);
        real eta = relative_ior(material, vertex, wi);
        real3 m = wi + eta * wo;
        m *= copysign(rsqrt(fmax(length2(m), 1e-30)), dot(m, n));
        real im = dot(wi, m), om = dot(wo, m);
        if (im <= 0.0 || om >= 0.0) return (real3)(0.0);
        real masking = ggx_masking(ggx_lambda(wi, n, material->alpha), ggx_lambda(wo, n, material->alpha), material->separable);
        real transmitted = 1.0 - fresnel_dielectric(im, eta);
        *scale = transmitted * ggx_density(m, n, material->alpha) * masking * im * -om / (ci * square(im + eta * om));
        return (real3)(1.0);
    }
#endif
    if (!same_side(vertex, wi, wo)) return (real3)(0.0);
#if HAS_DIFFUSE
    if (vertex->lobe == LOBE_DIFFUSE) {
        *scale = co * INV_PI;
        return vec3(material->diffuse) * vertex->tint;
    }
#endif
#if HAS_GLOSSY
    real3 h = normalize(wi + wo);
    real masking = ggx_masking(ggx_lambda(wi, n, material->alpha), ggx_lambda(wo, n, material->alpha), material->separable);
    *scale = ggx_density(h, n, material->alpha) * masking / (4.0 * ci);
    if (vertex->lobe == LOBE_DIELECTRIC_REFLECT)
        return (real3)(fresnel_dielectric(dot(wi, h), relative_ior(material, vertex, wi)));
    real3 f0 = vec3(material->specular) + vec3(material->specular_tinted) * vertex->tint;
    if (!material->schlick) return f0;
    real grazing = 1.0 - fmin(fabs(dot(wi, h)), 1.0);
    return f0 + (1.0 - f0) * (square(square(grazing)) * grazing);
#else
    return (real3)(0.0);
#endif
}

// Density, in solid angle, of drawing `other` at the vertex when `known` is given.
real lobe_density(const Scene *scene, const Vertex *vertex, real3 known, real3 other) {
    __global const Material *material = &scene->materials[vertex->material];
#if HAS_DIFFUSE
    if (vertex->lobe == LOBE_DIFFUSE) {
        real co = same_side(vertex, known, other) ? fabs(dot(vertex->ns, other)) : 0.0;
        return aimed_density(scene, vertex->x, other, co * INV_PI, AIM_FROM_NODE);
    }
#endif
#if HAS_GLOSSY
    real3 n = dot(vertex->ns, known) > 0.0 ? vertex->ns : -vertex->ns;
    real ci = dot(n, known), co = dot(n, other);
    real g1 = 1.0 / (1.0 + ggx_lambda(known, n, material->alpha));
#if HAS_TRANSMIT
    if (vertex->lobe == LOBE_TRANSMIT) {
        if (co >= 0.0) return 0.0;
        real eta = relative_ior(material, vertex, known);
        real3 m = known + eta * other;
        m *= copysign(rsqrt(fmax(length2(m), 1e-30)), dot(m, n));
        real im = dot(known, m), om = dot(other, m);
        if (im <= 0.0 || om >= 0.0) return 0.0;
        real visible_density = g1 * ggx_density(m, n, material->alpha) * im / fmax(ci, 1e-20);
        return (1.0 - fresnel_dielectric(im, eta)) * visible_density * eta * eta * -om / square(im + eta * om);
    }
#endif
    if (co <= 0.0 || ci <= 0.0) return 0.0;
    real3 h = normalize(known + other);
    real density = g1 * ggx_density(h, n, material->alpha) / (4.0 * ci);
    if (vertex->lobe == LOBE_DIELECTRIC_REFLECT)
        density *= fresnel_dielectric(dot(known, h), relative_ior(material, vertex, known));
    return density;
#else
    return 0.0;
#endif
}

// Draw the other direction. For a dielectric the choice of reflection or refraction is made here and written to the lobe.
bool lobe_sample(const Scene *scene, Vertex *vertex, real3 known, Rng *rng, real3 *other) {
    __global const Material *material = &scene->materials[vertex->material];
    real3 n = dot(vertex->ns, known) > 0.0 ? vertex->ns : -vertex->ns;
#if HAS_DIFFUSE
    if (vertex->lobe == LOBE_DIFFUSE) {
        if (sample_aim(scene, vertex->x, AIM_FROM_NODE, rng, other)) return true;
        real radius2 = rng_uniform(rng), angle = 2.0 * PI * rng_uniform(rng), radius = sqrt(radius2);
        real3 tangent = any_tangent(n);
        *other = normalize(radius * cos(angle) * tangent + radius * sin(angle) * cross(n, tangent) + sqrt(1.0 - radius2) * n);
        return true;
    }
#endif
#if HAS_GLOSSY
    real u1 = rng_uniform(rng), u2 = rng_uniform(rng);
    real3 h = ggx_sample_visible(known, n, material->alpha, u1, u2);
    real kh = dot(known, h);
    if (kh <= 0.0) return false;
#if HAS_TRANSMIT
    if (material->ior > 0.0) {
        real eta = relative_ior(material, vertex, known);
        vertex->lobe = LOBE_DIELECTRIC_REFLECT;
        if (rng_uniform(rng) >= fresnel_dielectric(kh, eta)) {
            vertex->lobe = LOBE_TRANSMIT;
            real cosine_t = sqrt(fmax(0.0, 1.0 - (1.0 - kh * kh) / (eta * eta)));
            *other = normalize((kh / eta - cosine_t) * h - known / eta);
            return dot(*other, n) < 0.0;
        }
    }
#endif
    *other = normalize(2.0 * kh * h - known);
    return dot(*other, n) > 0.0;
#else
    return false;
#endif
}

// The direction that the lobe's deviation is counted from (theory.md, 2): mirror, refracted, or normal on w_i's side.
// v is the direction of arrival (-w_i).
real3 reference_direction(const Scene *scene, const Vertex *vertex, real3 v) {
    real3 n = dot(vertex->ns, v) < 0.0 ? vertex->ns : -vertex->ns;
    if (vertex->lobe == LOBE_DIFFUSE) return n;
#if HAS_TRANSMIT
    if (vertex->lobe == LOBE_TRANSMIT) {
        real eta = 1.0 / relative_ior(&scene->materials[vertex->material], vertex, -v);
        real ci = -dot(v, n);
        real ct = sqrt(fmax(0.0, 1.0 - eta * eta * (1.0 - ci * ci)));
        return normalize(eta * v + (eta * ci - ct) * n);  // at total reflection: along the surface
    }
#endif
    return reflect_about(v, n);
}

#endif
