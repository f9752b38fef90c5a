"""The scene as a person describes it: camera, shapes, lights, portals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..errors import PylmcError
from .camera import Camera
from .lights import Light
from .portal import Portal
from .shape import Shape
from .values import as_list


@dataclass(frozen=True, eq=False)
class Scene:
    """Camera, shapes, lights and portals. ``portals="auto"`` has the holes in open planar pieces found on use."""

    camera: Camera
    shapes: Sequence[Shape]
    lights: Sequence[Light] = ()
    portals: Any = "auto"

    def __post_init__(self) -> None:
        if not isinstance(self.camera, Camera):
            raise PylmcError("Scene: no camera; give Camera(origin, target), or --auto-camera for a file without one")
        object.__setattr__(self, "shapes", as_list(self.shapes, "Scene.shapes", Shape))
        object.__setattr__(self, "lights", as_list(self.lights, "Scene.lights", Light))
        if not self.shapes:
            raise PylmcError("Scene: no shapes; there is nothing for light to meet")
        if not self.lights and not any(shape.emission for shape in self.shapes):
            raise PylmcError(f"Scene: no light; add a {Light.names()}, or give a shape emission (or --auto-light for a file)")
        if isinstance(self.portals, str):
            if self.portals != "auto":
                raise PylmcError(f"Scene.portals={self.portals!r}: use 'auto', or a list of Portal, or ()")
        else:
            object.__setattr__(self, "portals", as_list(self.portals, "Scene.portals", Portal))

    def with_size(self, width: int, height: int) -> Scene:
        """The same scene on a film of another size."""
        return Scene(self.camera.resized(width, height), self.shapes, self.lights, self.portals)
