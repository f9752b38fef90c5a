"""Scenes by name or file: ``pylmc.load("keyhole", hole=0.01)``, ``pylmc.load("model.glb", auto_camera=True)``."""

from __future__ import annotations

import importlib
import inspect
from pathlib import Path
from types import ModuleType
from typing import Any

from ..errors import PylmcError
from . import Scene

BUILT_IN = ("keyhole", "glints", "caustic", "box")


def scene_module(name: str) -> ModuleType:
    """The module of a built-in scene."""
    return importlib.import_module(f".builtin.{name}", __package__)


def parameters(name: str) -> dict[str, Any]:
    """A built-in scene's own parameters and their defaults (the film's size is given elsewhere)."""
    signature = inspect.signature(scene_module(name).build)
    return {p.name: p.default for p in signature.parameters.values() if p.name not in ("width", "height")}


def load(
    name_or_path: str | Path,
    *,
    width: int | None = None,
    height: int | None = None,
    auto_camera: bool = False,
    auto_light: bool = False,
    **values: Any,
) -> Scene:
    """A built-in scene by name, with its parameters, or a glTF/GLB file, on a film of ``width`` × ``height`` pixels.

    A side that is not given is the scene's own (256). ``auto_camera`` and ``auto_light`` frame and light a file that
    has no camera or light. Raises PylmcError for an unknown name or parameter, a value out of range, and a missing or
    unreadable file.
    """
    name = str(name_or_path)
    if name in BUILT_IN:
        scene = _build(name, values)
        if width is None and height is None:
            return scene
        camera = scene.camera
        return scene.with_size(camera.width if width is None else width, camera.height if height is None else height)
    path = Path(name)
    if path.suffix.lower() in (".gltf", ".glb"):
        if values:
            raise PylmcError(f"{path}: a file takes no parameters, but '{next(iter(values))}' was given")
        from .importers.gltf import load_gltf

        film = {side: value for side, value in (("width", width), ("height", height)) if value is not None}
        return load_gltf(path, auto_camera=auto_camera, auto_light=auto_light, **film)
    if path.exists():
        raise PylmcError(f"{path}: unknown kind of scene file '{path.suffix}'; pylmc reads .gltf and .glb")
    raise PylmcError(f"there is no scene '{name}': neither a built-in one ({', '.join(BUILT_IN)}) nor a file")


def _build(name: str, values: dict[str, Any]) -> Scene:
    known = parameters(name)
    for key, value in values.items():
        if key not in known:
            raise PylmcError(f"scene '{name}' has no parameter '{key}'; it has {', '.join(known)}")
        try:
            values[key] = float(value)
        except (TypeError, ValueError):
            raise PylmcError(f"scene '{name}': {key}={value!r} is not a number") from None
        if not 0 < values[key] <= LIMITS.get(key, float("inf")):
            raise PylmcError(
                f"scene '{name}': {key}={values[key]:g} must be greater than 0"
                + (f" and at most {LIMITS[key]:g}" if key in LIMITS else "")
            )
    return scene_module(name).build(**values)


LIMITS = {"hole": 0.9, "alpha": 1.0, "light": 0.95, "size": 0.5, "ior": 10.0}
