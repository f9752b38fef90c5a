// A diffuse base under a dielectric coat: f = diffuse / pi t(cos theta_i) t(cos theta_o) (pylmc/lobes/coated_diffuse.py).
#ifndef PYLMC_COATED_DIFFUSE
#define PYLMC_COATED_DIFFUSE

#include "lobes/cosine.cl"
#include "lobes/gradient.cl"

// t and its slope at a cosine: linear between the table's entries, which are at cosines from 0 to 1.
real2 coat_transmitted(__global const Lobe *lobe, real cosine) {
    const int last = sizeof(lobe->transmitted) / sizeof(lobe->transmitted[0]) - 1;
    real at = fmin(fabs(cosine), 1.0) * last;
    int i = min((int)at, last - 1);
    real low = lobe->transmitted[i], step = lobe->transmitted[i + 1] - low;
    return (real2)(low + (at - i) * step, step * last);
}

real3 coated_diffuse_value(__global const Lobe *lobe, const Vertex *vertex, real3 n, real3 wi, real3 wo, real *scale) {
    if (!same_side(vertex, wi, wo)) return (real3)(0.0);
    real co = dot(n, wo);
    *scale = co * INV_PI * coat_transmitted(lobe, dot(n, wi)).x * coat_transmitted(lobe, co).x;
    return vec3(lobe->diffuse) * vertex->tint;
}

real coated_diffuse_density(const Scene *scene, __global const Lobe *lobe, const Vertex *vertex, real3 known, real3 other) {
    return cosine_density(scene, vertex, known, other);
}

bool coated_diffuse_sample(const Scene *scene, __global const Lobe *lobe, Vertex *vertex, real3 known, Rng *rng, real3 *other) {
    return cosine_sample(scene, vertex, known, rng, other);
}

LobeGradient coated_diffuse_gradient(__global const Lobe *lobe, const Vertex *vertex, real3 n, real side, real3 wi, real3 wo) {
    real2 in = coat_transmitted(lobe, dot(n, wi)), out = coat_transmitted(lobe, dot(n, wo));
    LobeGradient g = cosine_gradient(n, side, wo);
    g.in += in.y / in.x * n;
    g.out += out.y / out.x * n;
    g.normal += side * (in.y / in.x * wi + out.y / out.x * wo);
    return g;
}

#endif
