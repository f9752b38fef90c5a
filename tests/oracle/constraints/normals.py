"""The normal at a node keeps within a radian where the mesh is curved (17), (19)."""

from __future__ import annotations

import numpy as np

from ..charts import Charts
from ..tangents import Tangents
from ..vectors import dot, unit
from .rows import Rows


def add(rows: Rows, charts: Charts, tangents: Tangents) -> None:
    world, base = charts.world, charts.base
    if not len(world.corner_normals):
        return
    normals = tangents.of(lambda moved: moved.paths.ns)
    for j in range(1, charts.m + 1):
        triangle, on = np.maximum(base.triangle[:, j], 0), base.triangle[:, j] >= 0
        smooth = on & (world.arrays["triangles"]["smooth"][triangle] != 0)
        corner, ns = world.corner_normals[triangle], base.ns[:, j]
        blended = np.einsum("nk,nki->ni", world.weights(triangle, base.x[:, j]), corner)
        scale = np.copysign(1 / np.maximum(np.linalg.norm(blended, axis=-1), 1e-300), dot(blended, ns))
        slopes = [scale[:, None] * (corner[:, k] - corner[:, 0]) for k in (1, 2)]
        a, b = (d - dot(d, ns)[:, None] * ns for d in slopes)
        bent = smooth & (dot(a, a) + dot(b, b) >= 1e-12)
        # any two axes across the normal: the sum of their rows' squares is the same
        first = unit(np.cross(ns, np.eye(3)[np.argmin(np.abs(ns), axis=1)]))
        for axis in (first, np.cross(ns, first)):
            rows.add(("normals", j), np.einsum("ni,nik->nk", axis, normals[:, j]), bent)
