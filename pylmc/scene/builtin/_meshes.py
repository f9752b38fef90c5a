"""Rectangles and boxes, the stuff of the built-in scenes, as (vertices, faces)."""

from __future__ import annotations

import numpy as np

Mesh = tuple[np.ndarray, np.ndarray]


def rectangle(corner: tuple[float, ...], edge1: tuple[float, ...], edge2: tuple[float, ...]) -> Mesh:
    """A rectangle from a corner and two edges; its normal is edge1 × edge2."""
    c, a, b = (np.array(v, dtype=float) for v in (corner, edge1, edge2))
    return np.array([c, c + a, c + a + b, c + b]), np.array([[0, 1, 2], [0, 2, 3]])


def wall_with_hole(corner: tuple[float, ...], edge1: tuple[float, ...], edge2: tuple[float, ...], hole: float) -> Mesh:
    """A rectangle with a rectangular hole at its centre; ``hole`` is the hole's side as a part of the wall's."""
    outer, _ = rectangle(corner, edge1, edge2)
    centre = outer.mean(axis=0)
    vertices = np.concatenate([outer, centre + hole * (outer - centre)])
    faces = [[i, j, 4 + j] for i, j in ((0, 1), (1, 2), (2, 3), (3, 0))]
    faces += [[i, 4 + j, 4 + i] for i, j in ((0, 1), (1, 2), (2, 3), (3, 0))]
    return vertices, np.array(faces)


def box(centre: tuple[float, ...], size: tuple[float, ...], turn: float = 0.0) -> Mesh:
    """A closed box of the given edge lengths, turned about the vertical (y) axis by ``turn`` degrees."""
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    angle = np.radians(turn)
    rotation = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    vertices = signs * np.array(size) / 2 @ rotation.T + np.array(centre)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return vertices, np.array([[q[i] for i in t] for q in quads for t in ((0, 1, 2), (0, 2, 3))])
