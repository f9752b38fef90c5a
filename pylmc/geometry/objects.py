"""Objects, the small-object constraint's subject: the connected pieces of the scene with their own boxes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .mesh import Mesh
from .topology import DOUBLE, label_components, weld


@dataclass(frozen=True, eq=False)
class SceneObject:
    """One connected piece of a shape.

    ``centre`` (3,), ``axes`` (3, 3; orthonormal rows, right-handed, longest first) and ``half_extents`` (3,) are its
    oriented box in scene units; a flat piece has a half-extent of (nearly) zero along its normal. ``shape`` indexes
    the scene's shapes, ``faces`` counts triangles, ``bounding_radius`` is of the sphere about ``centre``.
    """

    centre: np.ndarray
    axes: np.ndarray
    half_extents: np.ndarray
    shape: int
    faces: int
    bounding_radius: float


def find_objects(mesh: Mesh) -> tuple[list[SceneObject], np.ndarray]:
    """The scene's objects, and each face's object index (F,) in the order of the mesh.

    A piece is what faces connect by shared vertices, merged by position within one shape; shapes never join. Pieces
    are numbered in the order of their first faces. A piece's box is the tightest (least surface) of a few: by the
    area's principal axes, by the largest face, by the scene's axes.
    """
    vertices, faces = mesh.vertices, mesh.faces
    if len(faces) == 0:
        return [], np.zeros(0, dtype=np.int64)
    welded = weld(vertices, faces, DOUBLE, mesh.shape_of_vertex)[faces]
    joins = np.concatenate([welded[:, :2], welded[:, 1:]])
    labels = label_components(int(welded.max()) + 1, joins)[1][welded[:, 0]]
    _, first, of_face = np.unique(labels, return_index=True, return_inverse=True)
    count = len(first)
    by_appearance = np.argsort(first)
    first, of_face = first[by_appearance], np.argsort(by_appearance)[of_face]

    # Faces sorted by object make every per-object minimum, maximum and sum one reduceat; coordinates relative to the
    # object keep the digits of a tiny object far from the origin.
    order = np.argsort(of_face, kind="stable")
    of_sorted = of_face[order]
    starts = np.searchsorted(of_sorted, np.arange(count))
    origin = vertices[faces[order][starts, 0]]
    corners = vertices[faces[order]] - origin[of_sorted, None, :]
    box_axes, low, high = _tightest_boxes(corners, of_sorted, starts)

    half = (high - low) / 2
    centre = np.einsum("ni,nij->nj", (high + low) / 2, box_axes)
    reach = np.linalg.norm(corners - centre[of_sorted, None, :], axis=2).max(axis=1)
    radius = np.maximum.reduceat(reach, starts)
    rank = np.argsort(-half, axis=1, kind="stable")
    half = np.take_along_axis(half, rank, axis=1)
    box_axes = np.take_along_axis(box_axes, rank[:, :, None], axis=1)
    box_axes[:, 2] = np.cross(box_axes[:, 0], box_axes[:, 1])
    sizes = np.diff(np.append(starts, len(faces)))
    shape_of = mesh.shape_of_face[first]
    objects = [
        SceneObject(centre[i] + origin[i], box_axes[i], half[i], int(shape_of[i]), int(sizes[i]), float(radius[i]))
        for i in range(count)
    ]
    return objects, of_face.astype(np.int64)


def _tightest_boxes(corners: np.ndarray, of_face: np.ndarray, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Axes (N, 3, 3) and the extremes along them (N, 3), (N, 3) of each object's least-surface candidate box."""
    candidates = [_principal_axes(corners, of_face, starts), *_face_frames(corners, of_face, starts)]
    best_axes = np.broadcast_to(np.eye(3), (len(starts), 3, 3)).copy()
    best_low, best_high = _extremes(corners, of_face, starts, best_axes)
    best_surface = _half_surface(best_high - best_low)
    for axes in candidates:
        low, high = _extremes(corners, of_face, starts, axes)
        surface = _half_surface(high - low)
        better = surface < (1 - 1e-9) * best_surface  # ties keep the scene's own axes
        best_axes[better], best_low[better], best_high[better] = axes[better], low[better], high[better]
        best_surface[better] = surface[better]
    return best_axes, best_low, best_high


def _extremes(corners: np.ndarray, of_face: np.ndarray, starts: np.ndarray, axes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    along = np.einsum("fkj,fij->fki", corners, axes[of_face])
    return np.minimum.reduceat(along.min(axis=1), starts), np.maximum.reduceat(along.max(axis=1), starts)


def _half_surface(size: np.ndarray) -> np.ndarray:
    """Half a box's surface: unlike the volume it also ranks boxes of flat pieces."""
    return size[:, 0] * size[:, 1] + size[:, 1] * size[:, 2] + size[:, 2] * size[:, 0]


def _principal_axes(corners: np.ndarray, of_face: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Eigenvectors (N, 3, 3; rows) of each object's second moment of area about its centroid."""
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    total = np.add.reduceat(area, starts)
    weight = np.divide(area, total[of_face], out=np.zeros_like(area), where=total[of_face] > 0)
    centroid = np.add.reduceat(weight[:, None] * corners.mean(axis=1), starts)
    local = corners - centroid[of_face, None, :]
    middle = local.mean(axis=1)
    moment = np.einsum("fki,fkj->fij", local, local) + 9 * np.einsum("fi,fj->fij", middle, middle)
    moment = np.add.reduceat(weight[:, None, None] * moment, starts) / 12
    scale = np.trace(moment, axis1=1, axis2=2)
    moment /= np.where(scale > 0, scale, 1.0)[:, None, None]
    return np.swapaxes(np.linalg.eigh(moment)[1], 1, 2)


def _face_frames(corners: np.ndarray, of_face: np.ndarray, starts: np.ndarray) -> list[np.ndarray]:
    """Frames (N, 3, 3) on each object's largest face, one along each of its edges: exact for boxes and panels.

    Principal axes alone are arbitrary for squares and cubes, and then up to √3 too wide.
    """
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    largest = np.lexsort((area, of_face))[np.append(starts[1:], len(of_face)) - 1]
    triangle = corners[largest]
    normal = np.cross(triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0])
    frames = []
    for k in range(3):
        edge = triangle[:, (k + 1) % 3] - triangle[:, k]
        size = np.linalg.norm(edge, axis=1) * np.linalg.norm(normal, axis=1)
        sound = size > 0
        unit_edge = np.where(sound[:, None], edge, (1.0, 0.0, 0.0))
        unit_normal = np.where(sound[:, None], normal, (0.0, 0.0, 1.0))
        unit_edge = unit_edge / np.linalg.norm(unit_edge, axis=1, keepdims=True)
        unit_normal = unit_normal / np.linalg.norm(unit_normal, axis=1, keepdims=True)
        frames.append(np.stack([unit_edge, np.cross(unit_normal, unit_edge), unit_normal], axis=1))
    return frames
