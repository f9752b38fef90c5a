"""The scene as a person describes it: camera, shapes, lights, apertures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any

import numpy as np
import trimesh

from .checks import check_integer
from .errors import PylmcError
from .materials import RGB, Diffuse, Material, MetallicRoughness, RoughConductor, RoughDielectric, Texture, as_rgb

__all__ = [
    "Aperture", "Camera", "Diffuse", "MetallicRoughness", "PointLight", "RoughConductor", "RoughDielectric", "Scene",
    "Shape", "Texture",
]  # fmt: skip

MAX_SIDE = 16384  # pixels along one side of the film
MAX_COORDINATE = 1e15  # beyond it nothing is left of a scene after its centre is subtracted


def as_point(value: Any, what: str) -> np.ndarray:
    """Three finite numbers as a float64 array, or a PylmcError naming ``what``."""
    try:
        point = np.asarray(value, dtype=np.float64).reshape(-1)
    except (TypeError, ValueError):
        raise PylmcError(f"{what}: {value!r} is not a point; give three numbers") from None
    if point.shape != (3,) or not np.all(np.abs(point) <= MAX_COORDINATE):
        raise PylmcError(f"{what}: {value!r} is not a point; give three numbers, none beyond {MAX_COORDINATE:g}")
    return point


def as_list(value: Any, what: str, kind: type) -> tuple[Any, ...]:
    """A sequence whose every element is a ``kind``, as a tuple; raises PylmcError naming ``what``."""
    if isinstance(value, str) or not isinstance(value, Iterable):
        raise PylmcError(f"{what} is a {type(value).__name__}; give a list of {kind.__name__}")
    items = tuple(value)
    for index, item in enumerate(items):
        if not isinstance(item, kind):
            raise PylmcError(f"{what}[{index}] is a {type(item).__name__}, not {kind.__name__}")
    return items


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole camera at ``origin`` looking at ``target``; ``fov`` is vertical, in degrees; size in pixels."""

    origin: Any
    target: Any
    up: Any = (0.0, 1.0, 0.0)
    fov: float = 45.0
    width: int = 256
    height: int = 256

    def __post_init__(self) -> None:
        for name in ("origin", "target", "up"):
            object.__setattr__(self, name, as_point(getattr(self, name), f"Camera.{name}"))
        if isinstance(self.fov, bool) or not isinstance(self.fov, Real) or not 0 < self.fov < 180:
            raise PylmcError(f"Camera.fov={self.fov!r}: the vertical field of view must lie between 0 and 180 degrees")
        for name in ("width", "height"):
            object.__setattr__(self, name, check_integer(f"Camera.{name}", getattr(self, name), 1, MAX_SIDE))
        forward = self.target - self.origin
        if not np.linalg.norm(forward) > 0:
            raise PylmcError("Camera: origin and target coincide; move the target to where the camera should look")
        if not np.linalg.norm(np.cross(forward, self.up)) > 1e-9 * np.linalg.norm(forward) * np.linalg.norm(self.up):
            raise PylmcError("Camera: up is parallel to the viewing direction; choose another up vector")

    def axes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Unit vectors (right, up, forward): the image's +x, its upward direction, and the optical axis."""
        forward = (self.target - self.origin) / np.linalg.norm(self.target - self.origin)
        right = np.cross(forward, self.up)
        right /= np.linalg.norm(right)
        return right, np.cross(right, forward), forward

    def resized(self, width: int, height: int) -> Camera:
        """The same view on another film (the vertical field of view is kept)."""
        return Camera(self.origin, self.target, self.up, self.fov, width, height)


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
        if not isinstance(self.material, Material):
            raise PylmcError(f"shape '{label}': unknown material {self.material!r}; use Diffuse, RoughConductor, "
                             "RoughDielectric or MetallicRoughness")  # fmt: skip
        if self.emission is not None:
            emission = as_rgb(self.emission, f"shape '{label}': emission")
            if max(emission) > 0 and not mesh.area > 0:
                raise PylmcError(f"shape '{label}': a light of zero area emits nothing; enlarge it or use PointLight")
            object.__setattr__(self, "emission", emission if max(emission) > 0 else None)
        if self.textured and self.uv is None:
            raise PylmcError(f"shape '{label}': its material has a texture, but the mesh has no texture coordinates")

    @property
    def textured(self) -> bool:
        """Whether the material looks up a texture."""
        colour = getattr(self.material, "reflectance", getattr(self.material, "base_color", None))
        return isinstance(colour, Texture)

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


@dataclass(frozen=True, eq=False)
class PointLight:
    """A point that sends ``intensity`` (RGB, power per steradian) in every direction from ``position``."""

    position: Any
    intensity: Any = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", as_point(self.position, "PointLight.position"))
        intensity: RGB = as_rgb(self.intensity, "PointLight.intensity")
        if max(intensity) <= 0:
            raise PylmcError("PointLight.intensity is zero: remove the light or give it power")
        object.__setattr__(self, "intensity", intensity)


@dataclass(frozen=True, eq=False)
class Aperture:
    """A rectangular hole: ``centre``, unit ``normal``, unit in-plane ``axis``, ``half_size`` along axis and normal × axis."""

    centre: Any
    normal: Any
    axis: Any
    half_size: Any

    def __post_init__(self) -> None:
        for name in ("centre", "normal", "axis"):
            object.__setattr__(self, name, as_point(getattr(self, name), f"Aperture.{name}"))
        try:
            half = np.broadcast_to(np.asarray(self.half_size, dtype=np.float64), 2)
        except (TypeError, ValueError):
            raise PylmcError(f"Aperture.half_size={self.half_size!r}: give one positive number or two") from None
        if not np.all(np.isfinite(half)) or np.any(half <= 0):
            raise PylmcError(f"Aperture.half_size={self.half_size!r} must be positive")
        n = np.linalg.norm(self.normal)
        if not n > 0:
            raise PylmcError("Aperture.normal has length zero")
        normal = self.normal / n
        axis = self.axis - (self.axis @ normal) * normal
        if not np.linalg.norm(axis) > 1e-9:
            raise PylmcError("Aperture.axis is parallel to its normal; give a vector in the hole's plane")
        object.__setattr__(self, "normal", normal)
        object.__setattr__(self, "axis", axis / np.linalg.norm(axis))
        object.__setattr__(self, "half_size", (float(half[0]), float(half[1])))


@dataclass(frozen=True, eq=False)
class Scene:
    """Camera, shapes, point lights and apertures. ``apertures="auto"`` finds the holes in open planar pieces."""

    camera: Camera
    shapes: Sequence[Shape]
    lights: Sequence[PointLight] = ()
    apertures: Any = "auto"

    def __post_init__(self) -> None:
        if not isinstance(self.camera, Camera):
            raise PylmcError("Scene: no camera; give Camera(origin, target), or --auto-camera for a file without one")
        object.__setattr__(self, "shapes", as_list(self.shapes, "Scene.shapes", Shape))
        object.__setattr__(self, "lights", as_list(self.lights, "Scene.lights", PointLight))
        if not self.shapes:
            raise PylmcError("Scene: no shapes; there is nothing for light to meet")
        if not self.lights and not any(shape.emission for shape in self.shapes):
            raise PylmcError("Scene: no light; add a PointLight or give a shape emission (or --auto-light for a file)")
        if isinstance(self.apertures, str):
            if self.apertures != "auto":
                raise PylmcError(f"Scene.apertures={self.apertures!r}: use 'auto', or a list of Aperture, or ()")
            from .apertures import find_apertures

            object.__setattr__(self, "apertures", tuple(find_apertures(self.shapes)))
        else:
            object.__setattr__(self, "apertures", as_list(self.apertures, "Scene.apertures", Aperture))

    def with_size(self, width: int, height: int) -> Scene:
        """The same scene on a film of another size."""
        return Scene(self.camera.resized(width, height), self.shapes, self.lights, self.apertures)
