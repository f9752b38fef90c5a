"""The scene's triangles as one mesh: made once from all shapes, and handed to whatever asks about geometry."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np


class Part(NamedTuple):
    """One shape's arrays: ``vertices`` (v, 3), ``faces`` (f, 3), and, where it has them, ``normals`` (v, 3), ``uvs`` (v, 2)."""

    vertices: np.ndarray
    faces: np.ndarray
    normals: np.ndarray | None = None
    uvs: np.ndarray | None = None


@dataclass(frozen=True, eq=False)
class Mesh:
    """All shapes' triangles, one shape after the other, in scene units.

    ``vertices`` (V, 3) float64, ``faces`` (F, 3) into them, and the shape of each (``shape_of_vertex``, ``shape_of_face``).
    ``normals`` (V, 3) and ``uvs`` (V, 2) are zero for shapes without, and have no rows where no shape has any;
    ``smooth`` (shapes,) tells which shapes have normals.
    """

    vertices: np.ndarray
    faces: np.ndarray
    shape_of_vertex: np.ndarray
    shape_of_face: np.ndarray
    normals: np.ndarray
    uvs: np.ndarray
    smooth: np.ndarray


def join(parts: Sequence[Part]) -> Mesh:
    """The mesh of all ``parts`` in order."""
    vertex_counts = np.array([len(part.vertices) for part in parts], dtype=np.int64)
    starts = np.cumsum(vertex_counts) - vertex_counts
    shapes = np.arange(len(parts))
    faces = [np.asarray(part.faces, dtype=np.int64) + start for part, start in zip(parts, starts, strict=True)]
    return Mesh(
        np.concatenate([np.zeros((0, 3)), *(np.asarray(part.vertices, dtype=np.float64) for part in parts)]),
        np.concatenate([np.zeros((0, 3), dtype=np.int64), *faces]),
        np.repeat(shapes, vertex_counts),
        np.repeat(shapes, [len(part.faces) for part in parts]),
        _attribute([part.normals for part in parts], vertex_counts, 3),
        _attribute([part.uvs for part in parts], vertex_counts, 2),
        np.array([part.normals is not None for part in parts], dtype=bool),
    )


def _attribute(values: Sequence[np.ndarray | None], counts: np.ndarray, width: int) -> np.ndarray:
    """What vertices carry, over all parts: zero where a part has none, no rows where none has any."""
    if all(value is None for value in values):
        return np.zeros((0, width))
    filled = [np.zeros((n, width)) if value is None else value for value, n in zip(values, counts, strict=True)]
    return np.ascontiguousarray(np.concatenate(filled), dtype=np.float64)
