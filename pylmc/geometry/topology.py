"""Which vertices of the scene's meshes are the same point: the ground for objects and portals."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

DOUBLE = float(np.finfo(np.float64).eps)
SINGLE = float(np.finfo(np.float32).eps)


def roundoff(vertices: np.ndarray, precision: float) -> float:
    """The distance that rounding at relative ``precision`` may put between copies of one point, with a margin."""
    return 32.0 * precision * float(np.abs(vertices).max(initial=0.0))


def label_components(count: int, pairs: np.ndarray) -> tuple[int, np.ndarray]:
    """The number of connected components of ``count`` nodes joined by ``pairs`` (P, 2), and each node's label."""
    graph = coo_matrix((np.ones(len(pairs), dtype=bool), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    number, labels = connected_components(graph, directed=False)
    return int(number), labels


def weld(vertices: np.ndarray, faces: np.ndarray, precision: float, group: np.ndarray | None = None) -> np.ndarray:
    """For each vertex (V,) the index of the point it stands for; vertices that rounding alone separates share one.

    Two vertices merge when they are nearer than `roundoff` and than a thousandth of the shortest edge at either: a
    hole of any size survives, however large the wall around it. With ``group`` (V,) only equals merge.
    """
    group = np.zeros(len(vertices), dtype=np.int64) if group is None else group
    x, y, z = vertices.T + 0.0  # -0 and 0 are one place
    order = np.lexsort((z, y, x, group))
    ranked = np.column_stack([x, y, z])[order]
    new = np.ones(len(vertices), dtype=bool)
    new[1:] = np.any(ranked[1:] != ranked[:-1], axis=1) | (group[order][1:] != group[order][:-1])
    index = np.empty(len(vertices), dtype=np.int64)
    index[order] = np.cumsum(new) - 1
    points, point_group = ranked[new], group[order][new]

    tolerance = np.full(len(points), roundoff(vertices, precision))
    for a, b in ((0, 1), (1, 2), (2, 0)):
        start, end = index[faces[:, a]], index[faces[:, b]]
        length = np.linalg.norm(points[start] - points[end], axis=1)
        length[length == 0] = np.inf
        np.minimum.at(tolerance, start, 1e-3 * length)
        np.minimum.at(tolerance, end, 1e-3 * length)
    pairs = cKDTree(points).query_pairs(tolerance.max(initial=0.0), output_type="ndarray")
    apart = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
    near = (apart <= tolerance[pairs].min(axis=1)) & (point_group[pairs[:, 0]] == point_group[pairs[:, 1]])
    if not near.any():
        return index
    return label_components(len(points), pairs[near])[1].astype(np.int64)[index]
