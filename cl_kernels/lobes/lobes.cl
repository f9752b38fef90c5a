// The lobes of a material: which of them a node uses, and the dispatch to their values, sampling, densities and gradients.
//
// w_i points to the camera's side of the path (-v_i), w_o to the light's (v_{i+1}). Values are f |cos theta_o|, as radiance
// seen from the camera, so that a shading normal or a refraction counts alike whichever end a path was drawn from.
// Sampling is symmetric: from a known direction draw the other one, whichever of the two is known.
//
// LOBES(F) is F(NUMBER, name) for each kind that the scene has, LOBE_FILES are their files (pylmc/device/tables.py). A file
// defines name_value, name_density, name_sample and name_gradient, as lobes/diffuse.cl does.
#ifndef PYLMC_LOBES
#define PYLMC_LOBES

#include "lobes/sides.cl"
#include LOBE_FILES

// A material's own choice among its lobes, a function of the node alone. `choose` is the cumulative probability; of a pair,
// which is one choice, both lobes have the first one's.
real choice_probability(const Scene *scene, int lobe) { return scene->lobes[lobe].choose - scene->lobes[lobe].choose_before; }

int choose_lobe(const Scene *scene, int material, Rng *rng) {
    int lobe = scene->materials[material].first_lobe;
    if (scene->materials[material].choices == 1) return lobe;
    real u = rng_uniform(rng);
    while (u >= scene->lobes[lobe].choose) lobe++;
    return lobe;
}

// The material's lobe of a path's signature, or -1. A signature is a lobe's kind, and which of its material's of that kind.
int lobe_like(const Scene *scene, int material, int signature) {
    int first = scene->materials[material].first_lobe, end = first + scene->materials[material].lobes;
    for (int lobe = first; lobe < end; lobe++)
        if (scene->lobes[lobe].signature == signature) return lobe;
    return -1;
}

// Which of a pair joins the known directions.
void settle_lobe(const Scene *scene, Vertex *vertex, real3 wi, real3 wo) {
#if HAS_PAIRS
    int pair = scene->lobes[vertex->lobe].pair;
    if (pair == 0) return;
    int through = dot(vertex->ng, wi) * dot(vertex->ng, wo) < 0.0;
    vertex->lobe += through - (pair < 0);
#endif
}

// The value of the vertex's lobe: a colour, and its scale (f |cos|, of any size) by pointer; scale 0 where there is none.
real3 lobe_value(const Scene *scene, const Vertex *vertex, real3 wi, real3 wo, real *scale) {
    __global const Lobe *lobe = &scene->lobes[vertex->lobe];
    *scale = 0.0;
    real3 n = facing_normal(vertex, wi);
    if (dot(n, wi) <= 0.0) return (real3)(0.0);
#define LOBE_CASE(NUMBER, name) \
    case NUMBER:                \
        return name##_value(lobe, vertex, n, wi, wo, scale);
    switch (lobe->kind) { LOBES(LOBE_CASE) }
#undef LOBE_CASE
    return (real3)(0.0);
}

// Density, in solid angle, of drawing `other` at the vertex when `known` is given.
real lobe_density(const Scene *scene, const Vertex *vertex, real3 known, real3 other) {
    __global const Lobe *lobe = &scene->lobes[vertex->lobe];
#define LOBE_CASE(NUMBER, name) \
    case NUMBER:                \
        return name##_density(scene, lobe, vertex, known, other);
    switch (lobe->kind) { LOBES(LOBE_CASE) }
#undef LOBE_CASE
    return 0.0;
}

// Draw the other direction. Of a pair, the choice between its two lobes is made here and written to the vertex.
bool lobe_sample(const Scene *scene, Vertex *vertex, real3 known, Rng *rng, real3 *other) {
    __global const Lobe *lobe = &scene->lobes[vertex->lobe];
#define LOBE_CASE(NUMBER, name) \
    case NUMBER:                \
        return name##_sample(scene, lobe, vertex, known, rng, other);
    switch (lobe->kind) { LOBES(LOBE_CASE) }
#undef LOBE_CASE
    return false;
}

// d log(f |cos|) by w_i, w_o and the shading normal.
LobeGradient lobe_gradient(const Scene *scene, const Vertex *vertex, real3 wi, real3 wo) {
    __global const Lobe *lobe = &scene->lobes[vertex->lobe];
    real side = dot(vertex->ns, wi) > 0.0 ? 1.0 : -1.0;
    real3 n = side * vertex->ns;
#define LOBE_CASE(NUMBER, name) \
    case NUMBER:                \
        return name##_gradient(lobe, vertex, n, side, wi, wo);
    switch (lobe->kind) { LOBES(LOBE_CASE) }
#undef LOBE_CASE
    return cosine_gradient(n, side, wo);
}

#endif
