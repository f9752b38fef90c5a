// What binds a direction's own two coordinates, in every scene: the bounds (one radian, one chart unit; the film for v_1), and
// its portal where it has that chart. Fills L's diagonal, which is still empty there.
#ifndef PYLMC_BOUNDS
#define PYLMC_BOUNDS

#include "charts/charts.cl"
#include "constraints/factor.cl"

void constrain_direction(const Scene *scene, const Chart *chart, int j, real3 x, Factor *factor) {
    real2 weight2 = (real2)(1.0);
    real angle = j == 1 ? scene->camera->bound : 1.0;
    if (chart->kind >= KIND_NODE) weight2 /= length2(chart->anchor - x);
    weight2 /= angle * angle;
#if NUM_PORTALS > 0 && USE_PORTALS
    if (chart->kind >= KIND_PORTAL) {
        __global const Portal *portal = &scene->portals[chart->kind - KIND_PORTAL];
        weight2 += (real2)(1.0 / square(portal->half_size[0]), 1.0 / square(portal->half_size[1]));
        factor->constraints += 2;
    }
#endif
    int column = 2 * (j - 1);
    for (int b = 0; b < COLUMN_BLOCKS; b++) {
        factor->column[column][b] = column_unit(b, column) * sqrt(weight2.x);
        factor->column[column + 1][b] = column_unit(b, column + 1) * sqrt(weight2.y);
    }
    factor->constraints++;
}

#endif
