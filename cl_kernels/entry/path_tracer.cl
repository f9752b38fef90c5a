// integrator="path": a unidirectional path tracer with light sampling, multiple importance sampling (balance heuristic) and
// Russian roulette: the baseline that every renderer has. Each work-item owns one pixel, so its film needs no atomics.
#include "entry/path_kernel.cl"
#include "path/integrand.cl"

#define ROULETTE_FROM 4

// Light that reaches the vertex straight from a light without area, as seen from w_i.
real3 light_sample(Scene *scene, Vertex *vertex, real3 wi, Rng *rng) {
    real3 direct = (real3)(0.0);
#if HAS_LIGHTS
    int light = sample_light(scene, rng);
    Vertex end;
    place_at_light(scene, light, &end);
    real3 towards = is_infinite(&end) ? end.v : end.x - vertex->x;
    real distance2 = length2(towards), scale;
    real3 wo = towards * rsqrt(distance2);
    settle_lobe(scene, vertex, wi, wo);
    real3 value = lobe_value(scene, vertex, wi, wo, &scale);
    scale /= distance2 * light_probability(scene, light);
    if (scale > 0.0 && visible(scene, vertex, &end)) direct = scale * value * light_intensity(scene, light, -wo);
#endif
    return direct;
}

// The same from a sampled point of an emitter, weighted against meeting it by the lobe's own sampling.
real3 emitter_sample(Scene *scene, Vertex *vertex, real3 wi, Rng *rng) {
    real3 direct = (real3)(0.0);
#if HAS_EMITTERS
    Vertex light;
    sample_emitter(scene, rng, &light);
    real3 towards = light.x - vertex->x;
    real distance2 = length2(towards), scale;
    real3 wo = towards * rsqrt(distance2);
    real cosine = -dot(light.ng, wo);
    if (cosine <= 0.0 || !is_met(scene, &light)) return direct;
    settle_lobe(scene, vertex, wi, wo);
    real3 value = lobe_value(scene, vertex, wi, wo, &scale);
    real density = emitter_density(scene, &light) * distance2 / cosine;
    if (scale > 0.0 && visible(scene, vertex, &light))
        direct = scale / (density + lobe_density(scene, vertex, wi, wo)) * value * emitted_radiance(scene, &light, wo);
#endif
    return direct;
}

real3 trace_path(Scene *scene, real3 v, int max_depth, Rng *rng) {
    real3 radiance = (real3)(0.0), throughput = (real3)(1.0);
    Vertex vertices[2];
    Vertex start, *here = &start;
    start_at_camera(scene, &start);
    real density = INFINITY;  // of the direction v, by the lobe alone
    for (int depth = 1; depth <= max_depth; depth++) {
        Vertex *vertex = &vertices[depth & 1];
        if (!trace_to_vertex(scene, here, v, vertex)) break;
        here = vertex;
#if HAS_EMITTERS
        real3 emitted = emitted_radiance(scene, vertex, v);
        if (max_component(emitted) > 0.0) {
            real by_light = emitter_density(scene, vertex) * square(vertex->t) / fabs(dot(vertex->ng, v));
            radiance += throughput * emitted / (1.0 + (isinf(density) ? 0.0 : by_light / density));
        }
#endif
        if (depth == max_depth) break;
        int lobe = choose_lobe(scene, vertex->material, rng);
        vertex->lobe = lobe;
        throughput /= choice_probability(scene, lobe);
        // two statements: C does not say which of two operands draws its random numbers first
        radiance += throughput * light_sample(scene, vertex, -v, rng);
        radiance += throughput * emitter_sample(scene, vertex, -v, rng);
        vertex->lobe = lobe;
        real3 wo;
        real scale;
        if (!lobe_sample(scene, vertex, -v, rng, &wo)) break;
        density = lobe_density(scene, vertex, -v, wo);
        throughput *= lobe_value(scene, vertex, -v, wo, &scale);
        throughput *= scale / density;
        if (!is_positive(max_component(throughput)) || !isfinite(max_component(throughput))) break;
        if (depth >= ROULETTE_FROM) {
            real survive = fmin(0.95, max_component(throughput));
            if (rng_uniform(rng) >= survive) break;
            throughput /= survive;
        }
        v = wo;
    }
    return radiance;
}

PATH_KERNEL void render_paths(SCENE_PARAMETERS, uint seed, ulong first_step, int steps, int max_depth, int first_pixel,
                              int pixels, __global ChainCounters *counters, __global real *film) {
    int index = get_global_id(0);
    if (index >= pixels) return;
    int pixel = first_pixel + index;
    Scene scene = SCENE_BUNDLE;
    int width = scene.camera->width, height = scene.camera->height;
    real3 sum = (real3)(0.0);
    for (int step = 0; step < steps; step++) {
        Rng rng = rng_open(seed, (uint)pixel, first_step + step, PURPOSE_PATH);
        real x = rng_uniform(&rng), y = rng_uniform(&rng);
        real2 position = (real2)((pixel % width + x) / width, (pixel / width + y) / height);
        real3 radiance = trace_path(&scene, film_direction(&scene, position), max_depth, &rng);
        if (isfinite(radiance.x + radiance.y + radiance.z))
            sum += radiance;
        else
            counters[index].not_finite++;
    }
    vstore3(vload3(pixel, film) + sum, pixel, film);
    counters[index].rays += scene.rays;
}
