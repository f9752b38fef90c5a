"""The scene as a person describes it: camera, shapes, lights, apertures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..errors import PylmcError
from .camera import Camera
from .lights import PointLight
from .portal import Aperture
from .shape import Shape
from .values import as_list


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
            from ..geometry.portals import find_apertures

            object.__setattr__(self, "apertures", tuple(find_apertures(self.shapes)))
        else:
            object.__setattr__(self, "apertures", as_list(self.apertures, "Scene.apertures", Aperture))

    def with_size(self, width: int, height: int) -> Scene:
        """The same scene on a film of another size."""
        return Scene(self.camera.resized(width, height), self.shapes, self.lights, self.apertures)
