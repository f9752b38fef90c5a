"""A wide bounding-volume hierarchy for ``cl_kernels/trace/traverse.cl``, built in NumPy.

A binary tree is grown with the surface-area heuristic (:mod:`pylmc.geometry.bvh.grow`), then collapsed so that every node has
up to ``width`` children (:mod:`pylmc.geometry.bvh.collapse`). A leaf holds up to ``width`` triangles, tested together.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import PylmcError
from .collapse import as_reals, collapse
from .grow import BinaryTree, grow

WIDTHS = (2, 4, 8)
STACK_STEP = 8  # stack sizes are rounded up, so that most trees share one compiled program
LARGEST = 1e12  # coordinate: the triangle test multiplies three lengths
SLIVER = 1.7  # roundings: the sine of the angle below which a triangle's normal is noise


@dataclass(frozen=True, eq=False)
class Bvh:
    """What the device needs to trace rays.

    ``nodes`` is (n, 8, width) float32 or float64: rows 0 to 2 the children's low corners, 3 to 5 the high corners, row 6
    the children as integers of that size (an inner node's index, or ~index of a leaf), row 7 unused. ``leaves`` is
    (m, 10, width): x, y, z of the three corners, then the triangle's number. ``depth`` counts levels of nodes.
    """

    nodes: np.ndarray
    leaves: np.ndarray
    width: int
    depth: int

    def defines(self) -> dict[str, Any]:
        """The constants that traverse.cl is compiled with."""
        needed = (self.width - 1) * self.depth + 1  # each level leaves at most width - 1 siblings waiting
        double = self.nodes.dtype == np.float64
        return {
            "BVH_WIDTH": self.width,
            "BVH_STACK_SIZE": -(-needed // STACK_STEP) * STACK_STEP,
            "BVH_DOUBLE": double,
            "BVH_REAL": "double" if double else "float",
            "BVH_INTEGER": "long" if double else "int",
        }


def build(vertices: Any, faces: Any, width: int = 8, dtype: Any = np.float32) -> Bvh:
    """The tree over ``faces`` (m, 3) of ``vertices`` (n, 3), both checked, for rays in ``dtype`` (float32 or float64).

    Triangles without area are left out: no ray hits them. Raises PylmcError for wrong shapes, non-finite vertices,
    an empty mesh, faces that name missing vertices, or an unknown width.
    """
    if width not in WIDTHS:
        raise PylmcError(f"BVH width {width!r}: use 2, 4 or 8")
    vertices, faces = check_mesh(vertices, faces, dtype)
    corners = vertices[faces]
    kept = np.flatnonzero(_has_area(corners)).astype(np.int32)
    if len(kept) == 0:
        kept = np.zeros(1, dtype=np.int32)  # a tree needs a leaf; three equal corners are never hit
        corners = np.zeros_like(corners)
    boxes = _boxes(corners[kept])
    tree = grow(boxes, width)
    nodes, leaf_nodes, depth = collapse(tree, width)
    ids = _leaf_ids(tree, leaf_nodes, width)
    leaves = np.zeros((len(ids), 10, width), dtype=vertices.dtype)
    lanes = ids >= 0
    triangle = np.where(lanes, kept[ids], -1)
    leaves[:, :9] = np.where(lanes[:, None], corners.reshape(-1, 9)[triangle].transpose(0, 2, 1), 0)
    leaves[:, 9] = as_reals(triangle, vertices.dtype)
    return Bvh(nodes, leaves, width, depth)


def check_mesh(vertices: Any, faces: Any, dtype: Any = np.float32) -> tuple[np.ndarray, np.ndarray]:
    """(vertices of ``dtype``, faces int32), contiguous, or a PylmcError that says what is wrong with them."""
    try:
        vertices = np.ascontiguousarray(vertices, dtype=dtype)
        numbers = np.asarray(faces)
        faces = np.ascontiguousarray(numbers, dtype=np.int32)
    except (TypeError, ValueError) as error:
        raise PylmcError(f"mesh: vertices and faces must be arrays of numbers: {error}") from None
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise PylmcError(f"mesh: vertices have shape {vertices.shape}; expected (n, 3)")
    if len(faces) == 0:
        raise PylmcError("mesh: no triangles")
    if faces.ndim != 2 or faces.shape[1] != 3:
        raise PylmcError(f"mesh: faces have shape {faces.shape}; expected (m, 3)")
    if not np.array_equal(faces, numbers):
        raise PylmcError("mesh: faces must be whole numbers that fit into 32 bits")
    if faces.min() < 0 or faces.max() >= len(vertices):
        bad = int(np.flatnonzero(((faces < 0) | (faces >= len(vertices))).any(axis=1))[0])
        raise PylmcError(f"mesh: face {bad} names vertices {faces[bad].tolist()}, but there are {len(vertices)}")
    if not np.all(np.isfinite(vertices)):
        bad = int(np.flatnonzero(~np.isfinite(vertices).all(axis=1))[0])
        raise PylmcError(f"mesh: vertex {bad} is NaN, infinite or beyond single precision")
    if np.abs(vertices).max() > LARGEST:
        raise PylmcError(f"mesh: coordinates beyond {LARGEST:g} overflow in single precision; rescale the mesh")
    return vertices, faces


def _has_area(corners: np.ndarray) -> np.ndarray:
    """Whether each triangle's normal means something in the corners' own number type."""
    a, b = (corners[:, i].astype(np.float64) - corners[:, 0] for i in (1, 2))
    normal = np.sqrt((np.cross(a, b) ** 2).sum(axis=1))
    longest = np.sqrt(np.maximum((a**2).sum(axis=1), (b**2).sum(axis=1)))
    shortest = np.sqrt(np.minimum((a**2).sum(axis=1), (b**2).sum(axis=1)))
    return normal > SLIVER * np.finfo(corners.dtype).eps * longest * shortest


def _boxes(corners: np.ndarray) -> np.ndarray:
    """Triangles' boxes (6, n) as minima [low, -high], padded by a rounding of the mesh's largest coordinate.

    The pad covers the rounding of the triangle test, and gives flat boxes an inside for rays that lie in their plane.
    """
    kind = np.finfo(corners.dtype)
    pad = 2 * kind.eps * np.abs(corners).max() + kind.tiny
    low, high = corners.min(axis=1) - pad, corners.max(axis=1) + pad
    return np.ascontiguousarray(np.concatenate((low, -high), axis=1).T)


def _leaf_ids(tree: BinaryTree, leaf_nodes: np.ndarray, width: int) -> np.ndarray:
    """(leaves, width) triangles of each leaf in ascending order, then -1."""
    lane = np.arange(width)
    used = lane < tree.count[leaf_nodes][:, None]
    slot = np.where(used, tree.first[leaf_nodes][:, None] + lane, 0)
    last = np.iinfo(np.int64).max
    ids = np.sort(np.where(used, tree.order[slot], last), axis=1)
    return np.where(ids == last, -1, ids)
