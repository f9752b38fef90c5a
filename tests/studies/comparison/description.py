"""A scene in neutral terms: what both renderers are told, each in its own words by ``to_pylmc`` and ``to_mitsuba``.

Conventions that both share: lengths in scene units, linear RGB, triangles wound so that the right-hand rule gives the
normal. Area lights shine on the normal's side; glass lies on the other side of the normal. ``depth`` is the number of
segments of the longest path from camera to light: 1 sees lights only, 2 adds direct light.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

RGB = tuple[float, float, float]


@dataclass(frozen=True)
class Matte:
    """Lambertian on both sides."""

    reflectance: RGB


@dataclass(frozen=True)
class Metal:
    """GGX with Smith's separable masking, on both sides; ``reflectance`` stands for the Fresnel factor."""

    alpha: float
    reflectance: RGB


@dataclass(frozen=True)
class Glass:
    """GGX dielectric interface, Smith's separable masking; ``ior`` of the inside (against the normal) over the outside."""

    alpha: float
    ior: float


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles: vertices (n, 3), faces (m, 3), a material, unit vertex normals (n, 3) or None for a faceted surface, and
    emitted radiance or None."""

    vertices: np.ndarray
    faces: np.ndarray
    material: Matte | Metal | Glass
    normals: np.ndarray | None = None
    emission: RGB | None = None


@dataclass(frozen=True)
class Point:
    """A point light: ``intensity`` is power per steradian."""

    position: RGB
    intensity: RGB


@dataclass(frozen=True)
class View:
    """A pinhole camera; ``fov`` is vertical, in degrees; ``size`` is (width, height) in pixels."""

    origin: RGB
    target: RGB
    fov: float
    size: tuple[int, int] = (16, 16)
    up: RGB = (0.0, 1.0, 0.0)


@dataclass(frozen=True, eq=False)
class Description:
    """The whole: a name, what it is there to catch, a view, surfaces, point lights and the longest path's segments."""

    name: str
    about: str
    view: View
    surfaces: tuple[Surface, ...]
    points: tuple[Point, ...] = ()
    depth: int = 4

    def with_size(self, width: int, height: int) -> Description:
        """The same on another film."""
        return replace(self, view=replace(self.view, size=(width, height)))

    def with_depth(self, depth: int) -> Description:
        """The same with another longest path."""
        return replace(self, depth=depth)

    def with_materials(self, change: dict[Matte | Metal | Glass, Matte | Metal | Glass]) -> Description:
        """The same with materials exchanged: wrong on purpose, for negative controls."""
        assert all(any(s.material == old for s in self.surfaces) for old in change), "no such material in the scene"
        surfaces = tuple(replace(s, material=change.get(s.material, s.material)) for s in self.surfaces)
        return replace(self, surfaces=surfaces)

    def faceted(self) -> Description:
        """The same without vertex normals."""
        return replace(self, surfaces=tuple(replace(s, normals=None) for s in self.surfaces))
