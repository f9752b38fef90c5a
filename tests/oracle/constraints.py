"""Constraints and the preconditioner (theory.md, 5): rows, each the derivative of the function that it bounds, and Q."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pylmc.constraints.combination import combine

from .charts import DEVIATION, NODE, PORTAL, Charts
from .displaced import Moved
from .lobes import Surface
from .paths import Paths, surface
from .references import reference_direction
from .scene import World
from .tangents import Tangents
from .vectors import Array, any_tangent, dot, unit

KINDS = {"lobe": "lobes", "hole": "portals", "object": "objects", "normal": "normals"}  # as the setting calls them


@dataclass
class Rows:
    """Rows (n, 2m) over their widths, and which constraint each belongs to: M of eq. (21) counts constraints, not rows.

    A constraint's name begins with its kind; ``left_out`` are kinds that the setting leaves out.
    """

    left_out: set[str]
    rows: list[Array] = field(default_factory=list)
    owners: list[Array] = field(default_factory=list)
    names: dict[Any, int] = field(default_factory=dict)

    def add(self, name: tuple[Any, ...], row: Array, present: Array) -> None:
        """A row of constraint ``name``, for the paths that have it."""
        if name[0] in self.left_out:
            return
        self.rows.append(np.where(present[:, None], row, 0))
        self.owners.append(np.where(present, self.names.setdefault(name, len(self.names)), -1))

    def combined(self, rule: str) -> Array:
        """Q (n, 2m, 2m) of eq. (21) by the package's own float64 combination."""
        return combine(np.stack(self.rows, axis=1), np.stack(self.owners, axis=1), rule)

    def factor(self, rule: str) -> Array:
        """L, lower triangular, with Q = L Lᵀ, without Q: its condition number is the square of L's.

        By a QR factorisation of the rows: Q = w RᵀR.
        """
        rows, owners = np.stack(self.rows, axis=1), np.stack(self.owners, axis=1)
        upper = np.linalg.qr(rows, mode="r")
        upper = upper * np.where(np.einsum("nii->ni", upper) < 0, -1, 1)[..., None]
        present = np.where(np.any(rows != 0, axis=-1), owners, -1)
        count = np.array([len(np.unique(row[row >= 0])) for row in present])
        weight = {"sum": np.ones(len(count)), "mean": 1 / count, "rms": 1 / np.sqrt(count)}[rule]
        return np.swapaxes(upper, 1, 2) * np.sqrt(weight)[:, None, None]


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


def constraint_rows(charts: Charts, tangents: Tangents) -> Rows:
    """Every constraint that the paths have."""
    rows = Rows({kind for kind, word in KINDS.items() if word not in charts.settings.constraints})
    nodes, normals = tangents.of(lambda moved: moved.paths.x), tangents.of(lambda moved: moved.paths.ns)
    for j in range(1, charts.m + 1):
        _own_coordinates(rows, charts, j)
        _object(rows, charts.world, charts.base, j, nodes[:, j])
        _normal(rows, charts.world, charts.base, j, normals[:, j])
    for j in range(1, min(charts.m + 1, charts.base.length) + 1):
        _holes(rows, charts, tangents, j)
    _dependent_lobes(rows, charts, tangents)
    return rows


def _own_coordinates(rows: Rows, charts: Charts, j: int) -> None:
    """What binds direction j's own two coordinates: bounds, a portal that it has for a chart, its free lobe."""
    world, base = charts.world, charts.base
    kinds = charts.kinds[:, j]
    everyone = np.ones(len(kinds), bool)
    distance = np.where(kinds >= NODE, np.linalg.norm(charts.anchor[:, j] - base.x[:, j - 1], axis=-1), 1.0)
    bound = float(world.camera["bound"]) if j == 1 else 1.0  # one radian or chart unit; the film
    for k in (0, 1):
        column = np.zeros((len(kinds), 2 * charts.m))
        column[:, 2 * j - 2 + k] = 1
        rows.add(("bound", j), column / (distance * bound)[:, None], everyone)
        for index, portal in enumerate(world.arrays["portals"]):
            rows.add(("hole", j, index, k), column / float(portal["half_size"][k]), kinds == PORTAL + index)
    if j > 1:
        axes = lobe_axes(surface(world, base, j - 1), base.v[:, j - 1], charts.anchor[:, j])
        for axis, width in zip(axes[:2], axes[2].T, strict=True):
            row = np.zeros((len(kinds), 2 * charts.m))
            row[:, 2 * j - 2] = dot(axis, charts.e1[:, j]) / width
            row[:, 2 * j - 1] = dot(axis, charts.e2[:, j]) / width
            rows.add(("lobe", j), row, kinds == DEVIATION)


def _object(rows: Rows, world: World, base: Paths, j: int, dx: Array) -> None:
    """Node j stays on its small object (12), (17), (19)."""
    triangle, on = np.maximum(base.triangle[:, j], 0), base.triangle[:, j] >= 0
    thing = world.arrays["objects"][world.arrays["triangles"]["object"][triangle]]
    # an emitter binds the path's last node only, unless the scene has small objects: then wherever it is met
    binds = on & (thing["small"] != 0) & (bool(world.features["HAS_SMALL_OBJECTS"]) | (j == base.length))
    for k in range(3):
        axis = thing["axes"].reshape(-1, 3, 3)[:, k].astype(float)
        weight = thing["inverse_half"][:, k].astype(float)
        rows.add(("object", j), weight[:, None] * np.einsum("ni,nik->nk", axis, dx), binds & (weight > 0))


def _normal(rows: Rows, world: World, base: Paths, j: int, dn: Array) -> None:
    """The normal at node j keeps within a radian where the mesh is curved."""
    if not len(world.corner_normals):
        return
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
        rows.add(("normal", j), np.einsum("ni,nik->nk", axis, dn), bent)


def _holes(rows: Rows, charts: Charts, tangents: Tangents, j: int) -> None:
    """Segment j stays in the holes that it passes (11), (20), save one that is its own chart's."""
    world, base = charts.world, charts.base
    for index, portal in enumerate(world.arrays["portals"]):
        through, _ = world.crossing(portal, base.x[:, j - 1], base.v[:, j], base.reach[:, j])
        if j <= charts.m:
            through = through & (charts.kinds[:, j] != PORTAL + index)
        if not through.any():
            continue

        def meet(moved: Moved, portal: Any = portal) -> Array:
            return world.crossing(portal, moved.paths.x[:, j - 1], moved.paths.v[:, j], moved.paths.reach[:, j])[1]

        slope = tangents.of(meet)
        normal, axis = portal["normal"].astype(float), portal["axis"].astype(float)
        for k, e in enumerate((axis, np.cross(normal, axis))):
            row = np.nan_to_num(np.einsum("i,nik->nk", e, slope)) / float(portal["half_size"][k])
            rows.add(("hole", j, index, k), row, through)


def _dependent_lobes(rows: Rows, charts: Charts, tangents: Tangents) -> None:
    """The lobes whose deviation depends on the block: at its last node (15), (16), and at the node that it joins."""
    world, base, m = charts.world, charts.base, charts.m
    turned, references = tangents.of(lambda moved: moved.paths.v), tangents.of(lambda moved: moved.s)
    if m < base.length:
        here = surface(world, base, m)
        diffuse = here.refers_to("normal")
        s = np.where(diffuse[:, None], base.v[:, m + 1], reference_direction(here, base.v[:, m]))
        change = turned[:, m + 1] - np.where(diffuse[:, None, None], 0, references[:, m + 1])
        inward, sideways, widths = lobe_axes(here, base.v[:, m], s)
        for axis, width in ((inward, widths[:, 0]), (sideways, widths[:, 1])):
            rows.add(("lobe", "last"), np.einsum("ni,nik->nk", axis, change) / width[:, None], np.ones(len(s), bool))
    if m + 1 < base.length:
        here = surface(world, base, m + 1)
        glossy = ~here.refers_to("normal") & bool(world.features["HAS_NARROW"])
        inward, sideways, widths = lobe_axes(here, base.v[:, m + 1], reference_direction(here, base.v[:, m + 1]))
        for axis, width in ((inward, widths[:, 0]), (sideways, widths[:, 1])):
            rows.add(("lobe", "next"), -np.einsum("ni,nik->nk", axis, references[:, m + 2]) / width[:, None], glossy)


def preconditioner(charts: Charts, tangents: Tangents | None = None) -> Array:
    """Q (n, 2m, 2m) of eq. (21)."""
    return constraint_rows(charts, tangents or Tangents(charts)).combined(charts.settings.rule)


def proposal_factor(charts: Charts, tangents: Tangents | None = None) -> Array:
    """L (n, 2m, 2m) with Q = L Lᵀ; T = L⁻ᵀ."""
    return constraint_rows(charts, tangents or Tangents(charts)).factor(charts.settings.rule)
