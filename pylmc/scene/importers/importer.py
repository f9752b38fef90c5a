"""What all importers are: they read a file into what it holds, and the rest is the same for every format."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

from ...errors import PylmcError
from ..camera import Camera
from ..framing import frame, light_quads
from ..kinds import Kind
from ..lights import Light
from ..scene import Scene
from ..shape import Shape


@dataclass
class Content:
    """What a file holds: the first of the ``cameras`` counts, its film's size does not."""

    shapes: list[Shape] = field(default_factory=list)
    lights: list[Light] = field(default_factory=list)
    cameras: list[Camera] = field(default_factory=list)


class Importer(Kind):
    """Base of all importers. A subclass is registered by itself, for files whose name ends in one of its ``suffixes``."""

    suffixes: ClassVar[tuple[str, ...]] = ()  # in lower case, with the dot

    def read(self, path: Path) -> Content:
        """What the file holds. Raises PylmcError, which need not name the file, for one that cannot be read."""
        raise NotImplementedError

    def load(self, path: Path, auto_camera: bool, auto_light: bool, width: int, height: int) -> Scene:
        """The scene in a file, on a film of ``width`` × ``height`` pixels.

        ``auto_camera`` frames everything if the file has no camera, ``auto_light`` lights it if the file has no light and
        nothing that emits. Raises PylmcError, naming the file and what to do, where it cannot be read or lacks one of them.
        """
        try:
            return _completed(self.read(path), auto_camera, auto_light, width, height)
        except PylmcError as error:
            raise PylmcError(f"{path}: {error}") from None
        except OSError as error:
            raise PylmcError(f"{path}: cannot be read ({error.strerror or error}); check the path") from None


def _completed(found: Content, auto_camera: bool, auto_light: bool, width: int, height: int) -> Scene:
    shapes = found.shapes
    if not shapes:
        raise PylmcError("no triangles in the scene; export the meshes with it")
    if found.cameras:
        camera = found.cameras[0].resized(width, height)
    elif auto_camera:
        camera = frame(shapes, width, height)
    else:
        raise PylmcError("has no perspective camera; add one, or use --auto-camera (auto_camera=True)")
    if not found.lights and not any(shape.emission for shape in shapes):
        if not auto_light:
            raise PylmcError("has no light; add a point light, or use --auto-light (auto_light=True)")
        shapes = [*shapes, *light_quads(shapes, camera)]
    return Scene(camera, shapes, found.lights)
