"""A direction stays in its lobe (13) to (16): as a unit block where it is free, else as its deviation depends on the block."""

from __future__ import annotations

import numpy as np

from ..charts import DEVIATION, Charts
from ..lobes import Surface
from ..paths import surface
from ..references import reference_direction
from ..tangents import Tangents
from ..vectors import Array, any_tangent, dot, unit
from .rows import Rows


def lobe_axes(s: Surface, v: Array, reference: Array) -> tuple[Array, Array, Array]:
    """(axis in the plane of incidence, axis across it, widths (n, 2)): constraints.cl, lobe_axes, in words there."""
    n = np.where(dot(s.ns, v)[:, None] < 0, s.ns, -s.ns)
    across = n - dot(n, reference)[:, None] * reference
    inward = np.where((dot(across, across) > 1e-8)[:, None], unit(across + 1e-300), any_tangent(reference))
    sideways = np.cross(reference, inward)
    ci = -dot(n, v)
    through = s.refers_to("refracted")
    eta = np.where(through, 1 / s.index_ratio(-v), 1.0)
    ct = np.where(through, np.maximum(np.abs(dot(n, reference)), 0.1), -ci)
    turn = np.abs(eta * ci - ct)
    widths = np.stack([turn / np.maximum(np.abs(ct), 0.1), np.maximum(turn, 0.2)], axis=-1)
    widths = np.minimum(s.material["alpha"].astype(float)[:, None] * widths, 1)
    return inward, sideways, np.where(s.refers_to("normal")[:, None], 1.0, widths)


def add(rows: Rows, charts: Charts, tangents: Tangents) -> None:
    for j in range(2, charts.m + 1):
        _free(rows, charts, j)
    _dependent(rows, charts, tangents)


def _free(rows: Rows, charts: Charts, j: int) -> None:
    """Direction j is counted from its lobe's reference direction."""
    kinds = charts.kinds[:, j]
    axes = lobe_axes(surface(charts.world, charts.base, j - 1), charts.base.v[:, j - 1], charts.anchor[:, j])
    for axis, width in zip(axes[:2], axes[2].T, strict=True):
        row = np.zeros((len(kinds), 2 * charts.m))
        row[:, 2 * j - 2] = dot(axis, charts.e1[:, j]) / width
        row[:, 2 * j - 1] = dot(axis, charts.e2[:, j]) / width
        rows.add(("lobes", j), row, kinds == DEVIATION)


def _dependent(rows: Rows, charts: Charts, tangents: Tangents) -> None:
    """The lobe at the block's last node (15), (16), and that at the node which it joins."""
    world, base, m = charts.world, charts.base, charts.m
    turned, references = tangents.of(lambda moved: moved.paths.v), tangents.of(lambda moved: moved.s)
    if m < base.length:
        here = surface(world, base, m)
        diffuse = here.refers_to("normal")
        s = np.where(diffuse[:, None], base.v[:, m + 1], reference_direction(here, base.v[:, m]))
        change = turned[:, m + 1] - np.where(diffuse[:, None, None], 0, references[:, m + 1])
        inward, sideways, widths = lobe_axes(here, base.v[:, m], s)
        for axis, width in ((inward, widths[:, 0]), (sideways, widths[:, 1])):
            rows.add(("lobes", "last"), np.einsum("ni,nik->nk", axis, change) / width[:, None], np.ones(len(s), bool))
    if m + 1 < base.length:
        here = surface(world, base, m + 1)
        glossy = ~here.refers_to("normal") & bool(world.features["HAS_NARROW"])
        inward, sideways, widths = lobe_axes(here, base.v[:, m + 1], reference_direction(here, base.v[:, m + 1]))
        for axis, width in ((inward, widths[:, 0]), (sideways, widths[:, 1])):
            rows.add(("lobes", "next"), -np.einsum("ni,nik->nk", axis, references[:, m + 2]) / width[:, None], glossy)
