// The frame (p, q) that deviations are counted in, transported along the path (theory.md, 2, Frames): reflected or carried
// through with the light, turned minimally to the lobe's reference direction, and again to the direction taken. q = s x p.
#ifndef PYLMC_FRAMES
#define PYLMC_FRAMES

#include "lobes/lobes.cl"

// p, across v where the path arrives at the vertex, as it leaves: across the reference direction s.
real3 transport_frame(const Vertex *vertex, real3 v, real3 p, real3 s) {
    // A refracted direction is near v, and opposite to the mirror direction at normal incidence: turn from v itself.
    if (vertex->lobe == LOBE_TRANSMIT) return rotate_minimal(p, v, s);
    real3 reflected = reflect_about(p, vertex->ns);
    return vertex->lobe == LOBE_DIFFUSE ? rotate_minimal(reflected, reflect_about(v, vertex->ns), s) : reflected;
}

#endif
