// One sweep along a path carries the derivatives of its nodes and directions by all coordinates of its first m directions
// (theory.md, 4; eqs. (15), (18)). It goes through the segments in turn: those whose direction has coordinates, then the joint
// to the fixed node x_{m+1}, then the segment past that, which stays and whose lobe sees its light arrive from elsewhere.
#ifndef PYLMC_SWEEP
#define PYLMC_SWEEP

#include "charts/differentials.cl"
#include "references/references.cl"

// The segment from node j - 1 (here) to node j (next).
typedef struct {
    int j;
    int blocks;          // of eight coordinates each, in use
    bool past;           // beyond the joint
    const Chart *chart;  // the direction's own coordinates; null where it has none
    const Vertex *here, *next;
    // derivatives of node `here`, of the direction that arrives there, and of the normal there
    Tangent dx_here[COLUMN_BLOCKS], dv_here[COLUMN_BLOCKS], dn_here[COLUMN_BLOCKS];
    // of node `next`, of the segment's direction, and of the normal
    Tangent dx[COLUMN_BLOCKS], dv[COLUMN_BLOCKS], dn[COLUMN_BLOCKS];
    Curvature curvature;  // at next
    real3 p;              // the frame at the direction, and its derivatives
    Tangent dp[COLUMN_BLOCKS];
} Segment;

// Before the first segment, of n coordinates. p is the frame at v_1.
void sweep_start(int n, real3 p, Segment *segment) {
    segment->blocks = (n + LANES - 1) / LANES;
    segment->past = false;
    segment->p = p;
    for (int b = 0; b < segment->blocks; b++)
        segment->dx[b] = segment->dv[b] = segment->dn[b] = segment->dp[b] = tangent_zero();
}

// What was at the segment's far end is now at its near one.
void sweep_enter(const Path *path, int j, const Chart *chart, Segment *segment) {
    segment->j = j;
    segment->chart = chart;
    segment->here = &path->vertex[j - 1];
    segment->next = &path->vertex[j];
    for (int b = 0; b < segment->blocks; b++) {
        segment->dx_here[b] = segment->dx[b];
        segment->dv_here[b] = segment->dv[b];
        segment->dn_here[b] = segment->dn[b];
    }
}

// A direction that has coordinates. with_frame: whether a deviation at this direction or a later one needs the frame.
void sweep_own(const Scene *scene, const Path *path, int j, const Chart *chart, bool with_frame, Segment *segment) {
    sweep_enter(path, j, chart, segment);
    const Vertex *here = segment->here, *next = segment->next;
    bool turns = HAS_DEVIATION && with_frame && j > 1;
    real3 s, arriving_p = segment->p;
    if (turns) {
        s = reference_direction(scene, here, here->v);
        segment->p = transport_frame(scene, here, here->v, arriving_p, s);
    }
    for (int b = 0; b < segment->blocks; b++) {
        real8 unit1 = column_unit(b, 2 * j - 2), unit2 = column_unit(b, 2 * j - 1);
        Tangent ds = tangent_zero(), dp = tangent_zero();
        if (turns) {
            ds = reference_tangent(scene, here, segment->dv_here[b], segment->dn_here[b]);
            if (!DIFFERENTIALS_REDUCED)
                dp = frame_tangent(scene, here, arriving_p, s, segment->dp[b], segment->dv_here[b], segment->dn_here[b], ds);
        }
        segment->dv[b] = chart_tangent(chart, here->x, next->v, segment->dx_here[b], ds, dp, unit1, unit2);
        if (HAS_DEVIATION && with_frame && !DIFFERENTIALS_REDUCED) {
            // the first frame follows v_1 by the minimal rotation: dp = -(p.dv) v
            segment->dp[b] = j > 1 ? rotation_tangent(segment->p, s, next->v, dp, ds, segment->dv[b])
                                   : tangent_scaled(next->v, -tangent_dot(segment->p, segment->dv[b]));
        }
        segment->dx[b] = node_tangent(next, segment->dx_here[b], segment->dv[b]);
    }
    if (turns) segment->p = rotate_minimal(segment->p, s, next->v);
    segment->curvature = curvature_at(scene, next);
    for (int b = 0; b < segment->blocks; b++) segment->dn[b] = normal_tangent(&segment->curvature, segment->dx[b]);
}

// The joint: its near end moves and its far end stays. Light from infinity keeps its direction, whatever the node does.
void sweep_joint(const Path *path, int j, Segment *segment) {
    sweep_enter(path, j, 0, segment);
    const Vertex *next = segment->next;
    for (int b = 0; b < segment->blocks; b++) {
        segment->dx[b] = segment->dn[b] = tangent_zero();
        segment->dv[b] = is_infinite(next)
                             ? tangent_zero()
                             : tangent_times(tangent_across(next->v, segment->dx_here[b]), (real8)(-1.0 / next->t));
    }
}

// The segment past the joint.
void sweep_past(const Path *path, int j, Segment *segment) {
    sweep_enter(path, j, 0, segment);
    segment->past = true;
    for (int b = 0; b < segment->blocks; b++) segment->dv[b] = tangent_zero();
}

#endif
