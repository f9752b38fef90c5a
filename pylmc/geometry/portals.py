"""Holes in walls, found without being told: the inner boundary loops of open, flat pieces of the scene."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .flat_pieces import Outline, outlines
from .mesh import Mesh
from .topology import DOUBLE, SINGLE, roundoff

FLATNESS = 1e-5  # a piece is flat if its outline leaves its plane by less than this part of its size
NARROWEST = 1e-6  # a loop narrower than this part of its length is a crack between triangles, not a hole


class Hole(NamedTuple):
    """A rectangle: ``centre``, unit ``normal``, unit in-plane ``axis``, ``half_size`` along axis and normal × axis."""

    centre: np.ndarray
    normal: np.ndarray
    axis: np.ndarray
    half_size: tuple[float, float]


def find_portals(mesh: Mesh) -> list[Hole]:
    """The holes of all flat open pieces, each fitted with the rectangle of least area around its loop.

    A piece is what coplanar triangles form that share edges or parts of edges (also across shapes: a wall may be four
    rectangles around a hole); a hole is an inner loop of its outline along which the shape ends. A hole through a
    solid wall, whose rim carries on as a tunnel, is no such loop and is left to the caller; so is a hole in a curved
    surface. Positions are taken as exact to float64, and, where that finds no hole, to float32.
    """
    vertices, faces, owner = mesh.vertices, mesh.faces, mesh.shape_of_face
    if len(faces) == 0:
        return []
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    if not np.all(np.isfinite(middle)):  # beyond float64's range: no hole could be told from rounding
        return []
    for precision in (DOUBLE, SINGLE):
        found = [hole for outline in outlines(vertices, faces, owner, precision) for hole in _holes(outline, precision)]
        if found:
            return found
    return []


def _holes(outline: Outline, precision: float) -> list[Hole]:
    """The holes in one piece."""
    away = (outline.points - outline.points[0]) @ outline.normal
    size = np.linalg.norm(np.ptp(outline.points, axis=0))
    allowed = roundoff(outline.points, precision)
    if np.ptp(away) > FLATNESS * size + allowed:
        return []
    across = np.eye(3)[np.argmin(np.abs(outline.normal))]
    first = np.cross(across, outline.normal)
    first /= np.linalg.norm(first)
    second = np.cross(outline.normal, first)
    found = []
    for loop in _trace(outline, first, second):
        origin = outline.points[loop[0]]
        local = outline.points[loop] - origin
        flat = np.column_stack([local @ first, local @ second])
        following = np.roll(flat, -1, axis=0)
        turned = float(np.sum(flat[:, 0] * following[:, 1] - flat[:, 1] * following[:, 0]))
        if turned >= 0 or not all(outline.open[edge] for edge in zip(loop, np.roll(loop, -1), strict=True)):
            continue  # counter-clockwise: the outer loop; not open: another part of the shape carries on there
        centre, axis, half = fit_rectangle(flat)
        if half[1] <= NARROWEST * half[0] or half[1] <= allowed:
            continue
        found.append(
            Hole(
                origin + centre[0] * first + centre[1] * second,
                outline.normal,
                axis[0] * first + axis[1] * second,
                (float(half[0]), float(half[1])),
            )
        )
    return found


def _trace(outline: Outline, first: np.ndarray, second: np.ndarray) -> list[list[int]]:
    """Closed vertex loops along the outline's directed edges, the piece on their left.

    Where loops touch in a point, the nearest edge counter-clockwise from the one just walked bounds the same outside,
    so two holes that meet there stay two.
    """
    leaving: dict[int, list[int]] = {}
    for start, end in outline.open:
        leaving.setdefault(start, []).append(end)
    loops = []
    for begin in list(leaving):
        while leaving[begin]:
            loop, at = [begin], leaving[begin].pop()
            while at != begin and leaving.get(at):
                choices = leaving[at]
                if len(choices) > 1:
                    spokes = outline.points[[loop[-1], *choices]] - outline.points[at]
                    angle = np.arctan2(spokes @ second, spokes @ first)
                    turn = np.mod(angle[1:] - angle[0], 2 * np.pi)
                    choices.append(choices.pop(int(np.argmin(turn))))
                loop.append(at)
                at = choices.pop()
            if at == begin and len(loop) > 2:
                loops.append(loop)
    return loops


def fit_rectangle(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The rectangle of least area around ``points`` (N, 2): centre (2,), unit axis of its longer side, half-sizes.

    One of its sides lies along the convex hull. Half-sizes are given longer first; collinear points yield a zero.
    """
    hull = _convex_hull(points)
    sides = np.roll(hull, -1, axis=0) - hull
    lengths = np.linalg.norm(sides, axis=1)
    along = sides[lengths > 0] / lengths[lengths > 0, None]
    if len(along) == 0:
        return points[0], np.array([1.0, 0.0]), np.zeros(2)
    across = np.column_stack([-along[:, 1], along[:, 0]])
    u, v = hull @ along.T, hull @ across.T
    area = np.ptp(u, axis=0) * np.ptp(v, axis=0)
    # Among equals take the direction of the longest side, which rounding turns least.
    equal = area <= area.min() * (1 + 1e-9)
    best = int(np.argmax(np.where(equal, lengths[lengths > 0], -1.0)))
    low = np.array([u[:, best].min(), v[:, best].min()])
    high = np.array([u[:, best].max(), v[:, best].max()])
    middle, half = (low + high) / 2, (high - low) / 2
    centre = middle[0] * along[best] + middle[1] * across[best]
    if half[0] >= half[1]:
        return centre, along[best], half
    return centre, across[best], half[::-1]


def _convex_hull(points: np.ndarray) -> np.ndarray:
    """Corners (H, 2) of the convex hull, counter-clockwise (Andrew's monotone chain)."""
    ordered = [(float(x), float(y)) for x, y in np.unique(points, axis=0)]
    halves = []
    for sequence in (ordered, ordered[::-1]):
        chain: list[tuple[float, float]] = []
        for x, y in sequence:
            while len(chain) > 1:
                (ax, ay), (bx, by) = chain[-2:]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0:
                    break
                chain.pop()
            chain.append((x, y))
        halves.append(chain[:-1])
    return np.array(halves[0] + halves[1] or ordered)
