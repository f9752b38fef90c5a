"""A node stays on its small object, and a path's end on its emitter (12), (17), (19)."""

from __future__ import annotations

import numpy as np

from ..charts import Charts
from ..tangents import Tangents
from .rows import Rows


def add(rows: Rows, charts: Charts, tangents: Tangents) -> None:
    world, base = charts.world, charts.base
    nodes = tangents.of(lambda moved: moved.paths.x)
    for j in range(1, charts.m + 1):
        triangle, on = np.maximum(base.triangle[:, j], 0), base.triangle[:, j] >= 0
        thing = world.arrays["objects"][world.arrays["triangles"]["object"][triangle]]
        # an emitter binds the path's last node only, unless the scene has small objects: then wherever it is met
        binds = on & (thing["small"] != 0) & (bool(world.features["HAS_SMALL_OBJECTS"]) | (j == base.length))
        for k in range(3):
            axis = thing["axes"].reshape(-1, 3, 3)[:, k].astype(float)
            weight = thing["inverse_half"][:, k].astype(float)
            row = weight[:, None] * np.einsum("ni,nik->nk", axis, nodes[:, j])
            rows.add(("objects", j), row, binds & (weight > 0))
