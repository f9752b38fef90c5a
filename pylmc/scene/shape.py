"""Shapes: triangle meshes with a material each."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import trimesh

from ..checks import check_flag
from ..errors import PylmcError
from .materials import Material
from .values import MAX_COORDINATE, as_rgb, as_rows, fixed, real_numbers


@dataclass(frozen=True, eq=False)
class Shape:
    """A triangle mesh with one material.

    ``mesh`` is a ``trimesh.Trimesh`` or a pair (vertices, faces). ``emission`` is emitted radiance (RGB) on the side of
    the geometric normal.

    ``normals`` (vertices, 3), of any length but zero, are interpolated over the faces. Without them ``smooth=True``
    interpolates means of the adjacent faces' normals, and a shape is faceted by default; ``smooth=False`` makes it so
    whatever is given. Normals that a Trimesh keeps for itself have no say: pass ``normals=mesh.vertex_normals`` to use them.
    ``uv`` (vertices, 2) are texture coordinates, by default the mesh's own (``mesh.visual.uv``).

    All arrays are copied: what happens to the caller's mesh later changes nothing. The copies are ``vertices``
    (vertices, 3), ``faces`` (faces, 3), ``normals``, ``uv`` and ``mesh``, a Trimesh of them. Raises PylmcError, naming the
    shape, for arrays that do not fit together and for numbers that are NaN, infinite or absurd.
    """

    mesh: Any
    material: Material
    emission: Any = None
    name: str = ""
    smooth: bool | None = None
    normals: Any = None
    uv: Any = None
    vertices: np.ndarray = field(init=False, repr=False)
    faces: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        what = f"shape '{self.name or 'unnamed shape'}'"
        given = _as_trimesh(self.mesh, what)
        vertices, faces = _checked(given, what)
        self._set("vertices", vertices)
        self._set("faces", faces)
        normals = None if self.normals is None else _unit_normals(self.normals, len(vertices), what)
        self._set("normals", normals)
        self._set("smooth", normals is not None if self.smooth is None else check_flag(f"{what}: smooth", self.smooth))
        Material.check(self.material, f"{what}: material")
        if self.emission is not None:
            emission = as_rgb(self.emission, f"{what}: emission")
            if max(emission) > 0 and not _has_area(vertices, faces):
                raise PylmcError(f"{what}: a light of zero area emits nothing; enlarge it or use PointLight")
            self._set("emission", emission if max(emission) > 0 else None)
        own = getattr(given.visual, "uv", None) if self.textured else None  # nobody looks at those of other shapes
        uv = own if self.uv is None else self.uv
        if uv is not None:
            self._set("uv", _texture_coordinates(uv, len(vertices), what))
        elif self.textured:
            raise PylmcError(f"{what}: its material has a texture, but the mesh has no texture coordinates")
        kept = getattr(given.visual, "uv", None) if self.uv is None else self.uv
        visual = None if kept is None else trimesh.visual.TextureVisuals(uv=np.array(kept))
        self._set("mesh", trimesh.Trimesh(vertices, faces, visual=visual, process=False))

    def _set(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)

    @property
    def textured(self) -> bool:
        """Whether the material looks up textures."""
        return bool(self.material.textures())

    def vertex_normals(self) -> np.ndarray | None:
        """Shading normals (vertices, 3), of length one or, where faces cancel, zero; None where the shape is faceted."""
        if not self.smooth:
            return None
        return mean_normals(self.vertices, self.faces) if self.normals is None else self.normals

    def bounds(self) -> np.ndarray:
        """The low and high corner (2, 3) of the box around the faces."""
        corners = self.vertices[self.faces.ravel()]
        return np.array([corners.min(axis=0), corners.max(axis=0)])


def mean_normals(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Each vertex's mean of its faces' normals by their angles there (vertices, 3), of length one or, lacking one, zero."""
    return np.asarray(trimesh.Trimesh(vertices, faces, process=False).vertex_normals, dtype=np.float64)


def _as_trimesh(mesh: Any, what: str) -> trimesh.Trimesh:
    if isinstance(mesh, trimesh.Trimesh):
        return mesh
    try:
        vertices, faces = mesh
        vertices, numbers = real_numbers(vertices), real_numbers(faces)
        if vertices.ndim != 2 or vertices.shape[1] != 3:
            raise ValueError(f"vertices have shape {vertices.shape}, not (n, 3)")
        if numbers.size and (numbers.ndim != 2 or numbers.shape[1] not in (3, 4)):
            raise ValueError(f"faces have shape {numbers.shape}, not (n, 3)")
        if not np.all(numbers == np.rint(numbers)) or np.abs(numbers).max(initial=0) >= 2**53:
            raise ValueError("faces must be whole numbers")
        return trimesh.Trimesh(vertices, numbers.astype(np.int64), process=False)
    except (TypeError, ValueError) as error:
        raise PylmcError(f"{what}: mesh is neither a trimesh nor (vertices, faces): {error}") from None


def _checked(mesh: trimesh.Trimesh, what: str) -> tuple[np.ndarray, np.ndarray]:
    """The mesh's vertices (n, 3) and faces (m, 3), copied."""
    vertices, faces = fixed(np.array(mesh.vertices, np.float64)), fixed(np.array(mesh.faces, np.int64))
    if len(faces) == 0 or len(vertices) == 0:
        raise PylmcError(f"{what}: the mesh is empty (no triangles)")
    sound = np.all(np.abs(vertices) <= MAX_COORDINATE, axis=1)
    if not np.all(sound):
        bad = int(np.flatnonzero(~sound)[0])
        raise PylmcError(f"{what}: vertex {bad} is NaN, infinite or beyond {MAX_COORDINATE:g}; repair the mesh")
    wrong = faces[(faces < 0) | (faces >= len(vertices))]
    if len(wrong):
        raise PylmcError(f"{what}: a face names vertex {int(wrong[0])}, but there are {len(vertices)}")
    return vertices, faces


def _unit_normals(normals: Any, vertices: int, what: str) -> np.ndarray:
    rows = as_rows(normals, vertices, 3, f"{what}: normals")
    with np.errstate(over="ignore", invalid="ignore"):
        length = np.linalg.norm(rows, axis=1)
    sound = np.isfinite(length) & (length > 0)
    if not np.all(sound):
        bad = int(np.flatnonzero(~sound)[0])
        raise PylmcError(f"{what}: the normal of vertex {bad} is NaN, infinite or without length; repair it, or give none")
    return fixed(rows / length[:, None])


def _texture_coordinates(uv: Any, vertices: int, what: str) -> np.ndarray:
    rows = as_rows(uv, vertices, 2, f"{what}: texture coordinates")
    sound = np.all(np.abs(rows) <= MAX_COORDINATE, axis=1)
    if not np.all(sound):
        bad = int(np.flatnonzero(~sound)[0])
        raise PylmcError(
            f"{what}: the texture coordinates of vertex {bad} are NaN, infinite or beyond {MAX_COORDINATE:g}; repair the mesh"
        )
    return fixed(rows)


def _has_area(vertices: np.ndarray, faces: np.ndarray) -> bool:
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return bool(np.any(np.cross(b - a, c - a) != 0))
