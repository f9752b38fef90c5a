// The last segment stays in its spot light's cone (pylmc/constraints/cones.py): its direction moves across the cone's axis by the
// sine of the cone's half-angle at most.
#ifndef PYLMC_CONSTRAINT_CONES
#define PYLMC_CONSTRAINT_CONES

#include "charts/sweep.cl"
#include "constraints/factor.cl"

void constrain_cones(const Scene *scene, const Path *path, const Segment *segment, Factor *factor) {
    if (segment->past || segment->j != path->length || path->ending != ENDING_CONNECT) return;
    __global const Light *light = &scene->lights[path->light];
    if (light->kind != LIGHT_SPOT || light->spread >= 1.0) return;
    real3 axes[2];
    axes[0] = any_tangent(vec3(light->direction));
    axes[1] = cross(vec3(light->direction), axes[0]);
    real inverse = rsqrt(light->spread * (2.0 - light->spread));
    for (int e = 0; e < 2; e++) {
        Row row;
        for (int b = 0; b < segment->blocks; b++) row.block[b] = inverse * tangent_dot(axes[e], segment->dv[b]);
        factor_add_row(factor, &row, 0);
    }
    factor->constraints++;
}

#endif
