"""Coordinates of a path's first m directions, and the maps between them and directions (theory.md, 2 and 3).

PROJECTION is eq. (3) for v_1, or the preprint's other projection; DEVIATION counts from the lobe's reference direction in
a frame carried along the path; NODE and PORTAL + i are target charts, which aim at a point of a plane.
"""

from __future__ import annotations

import copy

import numpy as np

from pylmc.settings import Settings

from .lobes import Surface
from .paths import Paths, surface
from .references import reference_direction
from .scene import World
from .vectors import Array, any_tangent, dot, magnitude, mirror, norm, turn_minimally, unit

PROJECTION, DEVIATION, NODE, PORTAL = range(4)


def carry_frame(s: Surface, v: Array, frame: Array, reference: Array) -> Array:
    """The frame across v where the path arrives, as it leaves: across the reference direction.

    Reflected with the light, then turned from the mirror direction to the reference; refraction turns from v itself.
    """
    reflected = mirror(frame, s.ns)
    turned = np.where(
        s.refers_to("refracted")[:, None],
        turn_minimally(frame, v, reference),
        turn_minimally(reflected, mirror(v, s.ns), reference),
    )
    return np.where(s.refers_to("mirror")[:, None], reflected, turned)


def deviation_coefficients(rho2: Array, chart: str) -> tuple[Array, Array, Array]:
    """(component along s, factor across, log dσ/dΩ) of a deviation chart; NaN beyond its edge."""
    with np.errstate(invalid="ignore"):
        if chart == "equal-area":
            return 1 - rho2 / 2, np.sqrt(1 - rho2 / 4), np.zeros_like(rho2)
        along = np.sqrt(1 - rho2)
        jacobian = -np.log(along) if chart == "orthographic" else np.zeros_like(rho2)
        return along, np.ones_like(rho2), jacobian


def deviation(v: Array, s: Array, frame: Array, chart: str) -> Array:
    """Ω (n, 2) of the direction v; NaN where the chart does not reach it."""
    omega = np.stack([dot(v, frame), dot(v, np.cross(s, frame))], axis=-1)
    cosine = dot(s, v)[:, None]
    with np.errstate(invalid="ignore", divide="ignore"):
        if chart == "equal-area":
            return omega / np.sqrt(np.where(cosine > -1, (1 + cosine) / 2, np.nan))
        return np.where(cosine > 0, omega, np.nan)


class Charts:
    """The coordinates of directions 1 … m of ``paths``, p (n, 3) being the frame at v_1. Arrays are (n, m+1, …), from 1.

    anchor: the point or reference direction that delta = 0 leads to; e1, e2: the axes of delta; normal: the plane's;
    omega: the deviation as it is, NaN where its chart does not reach it.
    """

    def __init__(self, world: World, paths: Paths, m: int, settings: Settings, p: Array) -> None:
        self.world, self.base, self.m, self.settings = world, paths, m, settings
        self.p = unit(p - dot(p, paths.v[:, 1])[:, None] * paths.v[:, 1])
        n = len(paths.light)
        self.kinds = np.zeros((n, m + 1), int)
        self.anchor, self.e1, self.e2, self.normal = (np.zeros((n, m + 1, 3)) for _ in range(4))
        self.omega = np.zeros((n, m + 1, 2))
        frame = self.p
        for j in range(1, m + 1):
            v = s = paths.v[:, j]
            if j > 1:
                here = surface(world, paths, j - 1)
                s = reference_direction(here, paths.v[:, j - 1])
                frame = carry_frame(here, paths.v[:, j - 1], frame, s)
            self.kinds[:, j], crossing, portal = self.kind(j)
            self.anchor[:, j], self.e1[:, j], self.e2[:, j] = s, frame, np.cross(s, frame)
            deviates = (self.kinds[:, j] == DEVIATION)[:, None]
            self.omega[:, j] = np.where(deviates, deviation(v, s, frame, settings.chart), 0)
            node = self.kinds[:, j] == NODE
            self.anchor[node, j], self.normal[node, j] = paths.x[node, j], paths.ng[node, j]
            self.e1[node, j] = any_tangent(paths.ng[node, j])
            self.e2[node, j] = np.cross(paths.ng[node, j], self.e1[node, j])
            for k in np.unique(portal[portal >= 0]):
                use = portal == k
                record = world.arrays["portals"][k]
                self.anchor[use, j], self.normal[use, j] = crossing[use], record["normal"]
                self.e1[use, j] = record["axis"]
                self.e2[use, j] = np.cross(record["normal"].astype(float), record["axis"].astype(float))
            if j > 1:
                frame = turn_minimally(frame, s, v)

    def take(self, which: Array) -> Charts:
        """The charts of a part of the paths, or of each of them several times."""
        part = copy.copy(self)
        part.base = self.base.take(which)
        for name in ("p", "kinds", "anchor", "e1", "e2", "normal", "omega"):
            setattr(part, name, getattr(self, name)[which])
        return part

    def kind(self, j: int) -> tuple[Array, Array, Array]:
        """(kind, crossing point, portal or -1) of direction j, from theory.md, 2."""
        base, world = self.base, self.world
        n = len(base.light)
        crossing, portal = np.zeros((n, 3)), np.full(n, -1)
        if self.settings.coordinates != "target":
            return np.full(n, PROJECTION if j == 1 else DEVIATION), crossing, portal
        for k in range(len(world.arrays["portals"]) - 1, -1, -1):
            through, point = world.crossing(world.arrays["portals"][k], base.x[:, j - 1], base.v[:, j], base.t[:, j])
            portal[through], crossing[through] = k, point[through]
        kinds = np.where(portal >= 0, PORTAL + portal, NODE)
        if j > 1:
            narrow = surface(world, base, j - 1).narrow
            kinds, portal = np.where(narrow, DEVIATION, kinds), np.where(narrow, -1, portal)
        return kinds, crossing, portal

    def direction(self, j: int, delta: Array, x: Array, s: Array, frame: Array) -> tuple[Array, Array]:
        """(direction j after moving by delta (n, 2), log dσ/dδ there) from the moved node x with s and frame at it.

        NaN beyond the chart's domain.
        """
        kind = self.kinds[:, j]
        omega = self.omega[:, j] + delta
        along, across, deviation_log = deviation_coefficients((omega**2).sum(axis=-1), self.settings.chart)
        flat = omega[:, :1] * frame + omega[:, 1:] * np.cross(s, frame)
        deviated = along[:, None] * s + across[:, None] * flat
        offset = delta[:, :1] * self.e1[:, j] + delta[:, 1:] * self.e2[:, j]
        towards = self.anchor[:, j] + offset - x
        with np.errstate(invalid="ignore", divide="ignore"):
            if self.settings.projection == "normalise":
                projected = unit(self.anchor[:, j] + offset)
                projected_log = 3 * np.log(dot(projected, self.anchor[:, j]))
            else:
                cosine = np.sqrt(1 - (delta**2).sum(axis=-1))
                projected, projected_log = cosine[:, None] * self.anchor[:, j] + offset, -np.log(cosine)
            aimed = unit(towards)
            aimed_log = np.log(magnitude(dot(self.normal[:, j], aimed))) - 2 * np.log(norm(towards))
        choices = [kind == PROJECTION, kind == DEVIATION]
        v = np.select([c[:, None] for c in choices], [projected, deviated], aimed)
        return v, np.select(choices, [projected_log, deviation_log], aimed_log)

    def delta(self, j: int, x: Array, v: Array, omega: Array) -> tuple[Array, Array]:
        """The inverse, eqs. (6)-(7): (delta, log dσ/dδ) of a direction v from node x, of deviation omega; NaN: none."""
        kind = self.kinds[:, j]
        with np.errstate(all="ignore"):
            cosine = dot(v, self.anchor[:, j])
            if self.settings.projection == "normalise":
                offset, projected_log = v / cosine[:, None] - self.anchor[:, j], 3 * np.log(cosine)
            else:
                offset, projected_log = np.where(cosine[:, None] > 0, v, np.nan), -np.log(cosine)
            slope, height = dot(self.normal[:, j], v), dot(self.anchor[:, j] - x, self.normal[:, j])
            t = np.where(slope * height > 0, height / slope, np.nan)
            aimed_log = np.log(np.abs(slope)) - 2 * np.log(t)
            rho2 = (omega**2).sum(axis=-1)
            _, _, deviation_log = deviation_coefficients(rho2, self.settings.chart)
            target = x + t[:, None] * v - self.anchor[:, j]
            offset = np.where((kind == PROJECTION)[:, None], offset, target)
            in_plane = np.stack([dot(offset, self.e1[:, j]), dot(offset, self.e2[:, j])], axis=-1)
        deviates = kind == DEVIATION
        back = np.where(deviates[:, None], omega - self.omega[:, j], in_plane)
        return back, np.select([kind == PROJECTION, deviates], [projected_log, deviation_log], aimed_log)

    def size(self) -> Array:
        """Each coordinate's own size (n, 2 m): a length where it is one, an angle else."""
        distance = np.linalg.norm(self.anchor[:, 1:] - self.base.x[:, : self.m], axis=-1)
        return np.repeat(np.where(self.kinds[:, 1:] >= NODE, distance, 1.0), 2, axis=1)
