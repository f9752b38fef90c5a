// A light path x_0 (camera), x_1 ... x_K and its nodes. K is the number of segments.
//
// connect: x_K is a light without area; the directions v_1 .. v_{K-1} are free (theory.md, 1).
// hit:     x_K lies on an emitter; v_1 .. v_K are free.
//
// vertex[0] is the start and vertex[K] the end. What a node is, it says by its place: a point of a surface, or else a start or
// an end that no ray can meet, of which only the position counts.
#ifndef PYLMC_PATH
#define PYLMC_PATH

#include "surface/scene.cl"

typedef struct {
    int place;    // PLACE_SURFACE, ...
    real3 x;      // position
    real3 v;      // unit direction of the segment that arrives here, as travelled from the camera
    real3 ng;     // geometric normal (unit, as the mesh orients it)
    real3 ns;     // shading normal (unit, on ng's side)
    real3 tint;   // the material's texture here, or white
    real t;       // length of the arriving segment; one, if it comes from infinity: light falls off by 1 / t^2
    real bu, bv;  // barycentric coordinates of x
    int triangle;
    int material;
    int lobe;  // which of the scene's lobes the path takes here; at its end, none
} Vertex;

typedef struct {
    Vertex vertex[MAX_DEPTH + 1];
    int length;  // K
    int ending;
    int light;  // connect: which of the scene's lights
} Path;

int free_directions(const Path *path) { return path->ending == ENDING_HIT ? path->length : path->length - 1; }

// An end that has a position and nothing else.
void place_at_point(real3 position, Vertex *end) {
    end->place = PLACE_POINT;
    end->x = position;
}

// Is the node at infinity, where a direction is all there is to it?
bool is_infinite(const Vertex *vertex) {
#if HAS_INFINITE
    return vertex->place == PLACE_INFINITY;
#else
    return false;
#endif
}

// How far the segment that arrives at the node reaches through the scene, whose radius is about one.
#define FAR 1e30
real reach(const Vertex *vertex) { return is_infinite(vertex) ? FAR : vertex->t; }

// Where node i is shown: at infinity, one length away.
real3 node_position(const Path *path, int i) {
    const Vertex *vertex = &path->vertex[i];
    return is_infinite(vertex) ? path->vertex[i - 1].x + vertex->v : vertex->x;
}

// Does the node take part in scattering as a near-mirror? A property of its material and lobe alone.
bool is_narrow(const Scene *scene, const Vertex *vertex) {
#if HAS_NARROW
    return scene->lobes[vertex->lobe].narrow;
#else
    return false;
#endif
}

#endif
