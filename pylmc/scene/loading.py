"""Scenes by name or file: ``pylmc.load("keyhole", hole=0.01)``, ``pylmc.load("model.glb", auto_camera=True)``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..errors import PylmcError
from . import builtin
from .camera import Camera
from .importers import importers
from .scene import Scene


def load(
    name_or_path: str | Path,
    *,
    width: int | None = None,
    height: int | None = None,
    auto_camera: bool = False,
    auto_light: bool = False,
    **values: Any,
) -> Scene:
    """A built-in scene by name, with its parameters, or a scene file, on a film of ``width`` × ``height`` pixels.

    A side that is not given is the scene's own (256). ``auto_camera`` and ``auto_light`` frame and light a file that
    has no camera or light. Raises PylmcError for an unknown name or parameter, a value out of range, and a missing or
    unreadable file.
    """
    name = str(name_or_path)
    if name in builtin.NAMES:
        scene = builtin.build(name, values)
        camera = scene.camera
        return scene.with_size(camera.width if width is None else width, camera.height if height is None else height)
    path, known = Path(name), importers()
    if path.is_dir():
        raise PylmcError(f"{path}: is a folder; name a scene file in it")
    importer = known.get(path.suffix.lower())
    if importer is not None:
        if values:
            raise PylmcError(f"{path}: a file takes no parameters, but '{next(iter(values))}' was given")
        film = (Camera.width if width is None else width, Camera.height if height is None else height)
        return importer.load(path, auto_camera, auto_light, *film)
    if path.exists():
        raise PylmcError(f"{path}: unknown kind of scene file '{path.suffix}'; pylmc reads {', '.join(sorted(known))}")
    raise PylmcError(f"there is no scene '{name}': neither a built-in one ({', '.join(builtin.NAMES)}) nor a file")
