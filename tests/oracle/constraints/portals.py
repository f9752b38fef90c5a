"""A segment stays in the portals that it passes (11), (20); where one is its own chart's, by a unit block."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..charts import PORTAL, Charts
from ..displaced import Moved
from ..tangents import Tangents
from ..vectors import Array
from .rows import Rows


def add(rows: Rows, charts: Charts, tangents: Tangents) -> None:
    world, base = charts.world, charts.base
    for j in range(1, min(charts.m + 1, base.length) + 1):
        for index, portal in enumerate(world.arrays["portals"]):
            through, _ = world.crossing(portal, base.x[:, j - 1], base.v[:, j], base.reach[:, j])
            if j <= charts.m:
                own = charts.kinds[:, j] == PORTAL + index
                through = through & ~own
                for k in (0, 1):
                    column = np.zeros((len(own), 2 * charts.m))
                    column[:, 2 * j - 2 + k] = 1 / float(portal["half_size"][k])
                    rows.add(("portals", j, index, k), column, own)
            if not through.any():
                continue

            def meet(moved: Moved, portal: Any = portal, j: int = j) -> Array:
                return world.crossing(portal, moved.paths.x[:, j - 1], moved.paths.v[:, j], moved.paths.reach[:, j])[1]

            slope = tangents.of(meet)
            normal, axis = portal["normal"].astype(float), portal["axis"].astype(float)
            for k, e in enumerate((axis, np.cross(normal, axis))):
                row = np.nan_to_num(np.einsum("i,nik->nk", e, slope)) / float(portal["half_size"][k])
                rows.add(("portals", j, index, k), row, through)
