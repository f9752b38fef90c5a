"""Which of the scene's surfaces is seen where several lie on each other, whatever their order in the scene."""

from __future__ import annotations

import hashlib
from typing import Any

import numpy as np

from ..colour import LUMINANCE
from ..geometry.coincident import coincident_pairs, met_instead
from ..geometry.mesh import Mesh
from ..scene import Scene, Shape

# By how much rays are moved off a surface (cl_kernels/number/vectors.cl): what is nearer to it is passed together with it.
RAY_OFFSET = {"float": 2e-6, "double": 4e-15}


def find_ties(
    scene: Scene, mesh: Mesh, corners: np.ndarray, normals: np.ndarray, transmits: np.ndarray, trace: str
) -> np.ndarray:
    """The kernels' array of ties, empty where no triangles lie as near to each other as rays in ``trace``, a type, cannot tell.

    ``corners`` (F, 3, 3) are scaled; unit ``normals`` (F, 3), zero where there is no area; ``transmits`` (F,): does light pass?
    """
    pairs = coincident_pairs(corners, normals, RAY_OFFSET[trace])
    if not len(pairs):
        return np.zeros(0, np.int32)
    emits = np.array([shape.emission is not None for shape in scene.shapes])[mesh.shape_of_face]
    return met_instead(pairs, normals, emits, transmits, _order(scene, mesh, np.unique(pairs)))


def _order(scene: Scene, mesh: Mesh, tied: np.ndarray) -> np.ndarray:
    """A number for each of the ``tied`` triangles, zero for all others: by shape, whatever the order of the shapes.

    All of a shape goes before all of another: two blocks of glass that touch have one of the two interfaces, not a patchwork.
    """
    shape_of = mesh.shape_of_face[tied]
    keys = {int(i): _key(scene.shapes[i]) for i in np.unique(shape_of)}
    place = {key: rank for rank, key in enumerate(sorted(set(keys.values())))}
    rank = np.array([place[keys[int(i)]] for i in shape_of])
    order = np.zeros(len(mesh.faces), np.int64)
    order[tied[np.argsort(rank, kind="stable")]] = np.arange(len(tied))
    return order


def _key(shape: Shape) -> tuple[Any, ...]:
    """What sorts shapes: the brighter first, then by looks, then what faces outwards, then anything that tells them apart."""
    emission = shape.emission or (0.0, 0.0, 0.0)
    material, corners = shape.material, shape.vertices[shape.faces]
    from_middle = corners - shape.vertices.mean(axis=0)
    volume = float(np.linalg.det(from_middle).sum())
    arrays = [texture.pixels for texture in material.textures()]
    arrays += [array for array in (corners, shape.vertex_normals(), shape.uv) if array is not None]
    content = hashlib.sha256(b"".join(np.ascontiguousarray(array).tobytes() for array in arrays)).digest()
    looks = type(material).__name__, repr(material.lobes())
    return -float(np.dot(emission, LUMINANCE)), emission, looks, -volume, content
