"""Which of the scene's surfaces is seen where several lie on each other, whatever their order in the scene."""

from __future__ import annotations

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
    """A number for each of the ``tied`` triangles by what it looks like and where it is, zero for all others."""
    shape_of = mesh.shape_of_face[tied]
    looks = {int(i): _look(scene.shapes[i]) for i in np.unique(shape_of)}
    place = {look: i for i, look in enumerate(sorted(set(looks.values())))}
    faces = mesh.faces[tied]
    columns = [
        np.array([place[looks[int(i)]] for i in shape_of])[:, None],
        np.sort(mesh.vertices[faces], axis=1).reshape(-1, 9),
    ]
    columns += [
        np.sort(of_vertices[faces], axis=1).reshape(len(faces), -1)
        for of_vertices in (mesh.normals, mesh.uvs)
        if len(of_vertices)
    ]
    order = np.zeros(len(mesh.faces), np.int64)
    order[tied[np.lexsort(np.concatenate(columns, axis=1).T[::-1])]] = np.arange(len(tied))
    return order


def _look(shape: Shape) -> tuple[Any, ...]:
    """What sorts shapes: the brighter first, then anything that tells them apart."""
    emission = shape.emission or (0.0, 0.0, 0.0)
    material = shape.material
    pictures = tuple(texture.pixels.tobytes() for texture in material.textures())
    return -float(np.dot(emission, LUMINANCE)), emission, type(material).__name__, repr(material.lobes()), pictures
