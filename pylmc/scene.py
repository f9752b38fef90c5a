"""The scene as a person describes it: camera, shapes, lights, apertures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import trimesh

from .errors import PylmcError
from .materials import RGB, Diffuse, Material, MetallicRoughness, RoughConductor, RoughDielectric, Texture, as_rgb

__all__ = [
    "Aperture", "Camera", "Diffuse", "MetallicRoughness", "PointLight", "RoughConductor", "RoughDielectric", "Scene",
    "Shape", "Texture",
]  # fmt: skip

MAX_SIDE = 16384  # pixels along one side of the film


def as_point(value: Any, what: str) -> np.ndarray:
    """Three finite numbers as a float64 array, or a PylmcError naming ``what``."""
    try:
        point = np.asarray(value, dtype=np.float64).reshape(-1)
    except (TypeError, ValueError):
        raise PylmcError(f"{what}: {value!r} is not a point; give three numbers") from None
    if point.shape != (3,) or not np.all(np.isfinite(point)):
        raise PylmcError(f"{what}: {value!r} is not a point; give three finite numbers")
    return point


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
        if not 0 < self.fov < 180:
            raise PylmcError(f"Camera.fov={self.fov!r}: the vertical field of view must lie between 0 and 180 degrees")
        for name in ("width", "height"):
            side = getattr(self, name)
            if int(side) != side or not 1 <= side <= MAX_SIDE:
                raise PylmcError(f"Camera.{name}={side!r}: give a whole number of pixels between 1 and {MAX_SIDE}")
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
                vertices, faces = mesh
                mesh = trimesh.Trimesh(np.asarray(vertices, float), np.asarray(faces, int), process=False)
            except (TypeError, ValueError) as error:
                raise PylmcError(f"shape '{label}': mesh is neither a trimesh nor (vertices, faces): {error}") from None
            object.__setattr__(self, "mesh", mesh)
        if len(mesh.faces) == 0 or len(mesh.vertices) == 0:
            raise PylmcError(f"shape '{label}': the mesh is empty (no triangles)")
        if not np.all(np.isfinite(mesh.vertices)):
            bad = int(np.flatnonzero(~np.isfinite(mesh.vertices).all(axis=1))[0])
            raise PylmcError(f"shape '{label}': vertex {bad} is NaN or infinite; repair the mesh")
        if mesh.faces.min() < 0 or mesh.faces.max() >= len(mesh.vertices):
            raise PylmcError(f"shape '{label}': a face names vertex {int(mesh.faces.max())}, "
                             f"but there are only {len(mesh.vertices)}")  # fmt: skip
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
        half = np.broadcast_to(np.asarray(self.half_size, dtype=np.float64), 2)
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

    @property
    def bitangent(self) -> np.ndarray:
        """The second in-plane unit vector, normal × axis."""
        return np.cross(self.normal, self.axis)


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
        object.__setattr__(self, "shapes", tuple(self.shapes))
        object.__setattr__(self, "lights", tuple(self.lights))
        for index, shape in enumerate(self.shapes):
            if not isinstance(shape, Shape):
                raise PylmcError(f"Scene.shapes[{index}] is a {type(shape).__name__}, not a Shape")
        for index, light in enumerate(self.lights):
            if not isinstance(light, PointLight):
                raise PylmcError(f"Scene.lights[{index}] is a {type(light).__name__}, not a PointLight")
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
            object.__setattr__(self, "apertures", tuple(self.apertures))
            for index, aperture in enumerate(self.apertures):
                if not isinstance(aperture, Aperture):
                    raise PylmcError(f"Scene.apertures[{index}] is a {type(aperture).__name__}, not an Aperture")

    def with_size(self, width: int, height: int) -> Scene:
        """The same scene on a film of another size."""
        return Scene(self.camera.resized(width, height), self.shapes, self.lights, self.apertures)
