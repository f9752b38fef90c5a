"""Shapes: triangle meshes with a material each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import trimesh

from ..errors import PylmcError
from .materials import Material
from .values import MAX_COORDINATE, as_rgb


@dataclass(frozen=True, eq=False)
class Shape:
    """A triangle mesh with one material.

    ``mesh`` is a ``trimesh.Trimesh`` or a pair (vertices, faces). ``emission`` is emitted radiance (RGB) on the side of
    the geometric normal. ``smooth`` interpolates vertex normals; ``None`` does so where the mesh came with its own.
    """

    mesh: Any
    material: Material
    emission: Any = None
    name: str = ""
    smooth: bool | None = None

    def __post_init__(self) -> None:
        label = self.name or "unnamed shape"
        mesh = self.mesh
        if not isinstance(mesh, trimesh.Trimesh):
            try:
                vertices, faces = (np.asarray(part) for part in mesh)
                if vertices.ndim != 2 or vertices.shape[1] != 3:
                    raise ValueError(f"vertices have shape {vertices.shape}, not (n, 3)")
                if len(faces) and not np.array_equal(faces, faces.astype(int)):
                    raise ValueError("faces must be whole numbers")
                mesh = trimesh.Trimesh(vertices.astype(float), faces.astype(int), process=False)
            except (TypeError, ValueError) as error:
                raise PylmcError(f"shape '{label}': mesh is neither a trimesh nor (vertices, faces): {error}") from None
            object.__setattr__(self, "mesh", mesh)
        if len(mesh.faces) == 0 or len(mesh.vertices) == 0:
            raise PylmcError(f"shape '{label}': the mesh is empty (no triangles)")
        sound = np.all(np.abs(mesh.vertices) <= MAX_COORDINATE, axis=1)
        if not np.all(sound):
            bad = int(np.flatnonzero(~sound)[0])
            raise PylmcError(f"shape '{label}': vertex {bad} is NaN, infinite or beyond {MAX_COORDINATE:g}; repair the mesh")
        wrong = mesh.faces[(mesh.faces < 0) | (mesh.faces >= len(mesh.vertices))]
        if len(wrong):
            raise PylmcError(f"shape '{label}': a face names vertex {int(wrong[0])}, but there are {len(mesh.vertices)}")
        Material.check(self.material, f"shape '{label}': material")
        if self.emission is not None:
            emission = as_rgb(self.emission, f"shape '{label}': emission")
            if max(emission) > 0 and not mesh.area > 0:
                raise PylmcError(f"shape '{label}': a light of zero area emits nothing; enlarge it or use PointLight")
            object.__setattr__(self, "emission", emission if max(emission) > 0 else None)
        if self.textured and self.uv is None:
            raise PylmcError(f"shape '{label}': its material has a texture, but the mesh has no texture coordinates")

    @property
    def textured(self) -> bool:
        """Whether the material looks up textures."""
        return bool(self.material.textures())

    @property
    def uv(self) -> np.ndarray | None:
        """Texture coordinates (vertices, 2), or None."""
        uv = getattr(self.mesh.visual, "uv", None)
        return None if uv is None else np.asarray(uv, dtype=np.float64)

    def vertex_normals(self) -> np.ndarray | None:
        """Unit shading normals (vertices, 3), or None where the shape is faceted."""
        carried = "vertex_normals" in self.mesh._cache.cache  # trimesh keeps given normals there and nowhere else
        smooth = carried if self.smooth is None else self.smooth
        return np.asarray(self.mesh.vertex_normals, dtype=np.float64) if smooth else None
