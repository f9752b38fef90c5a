"""pylmc: Markov-chain light transport on any OpenCL device, with constraint-preconditioned Langevin proposals.

Names are imported when they are first used, so that ``import pylmc`` costs next to nothing. No module may be called as
one of these names is: importing it would put the module in the name's place.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .device.raytracer import RayTracer
    from .errors import PylmcError, PylmcWarning
    from .inspection import info
    from .rendering import Render, render
    from .sampling.sampler import Sampler
    from .sampling.states import States
    from .scene import (
        Camera,
        Diffuse,
        MetallicRoughness,
        PointLight,
        Portal,
        RoughConductor,
        RoughDielectric,
        Scene,
        Shape,
        Texture,
    )
    from .scene.loading import load

    __version__: str

__all__ = [
    "Camera",
    "Diffuse",
    "MetallicRoughness",
    "PointLight",
    "Portal",
    "PylmcError",
    "PylmcWarning",
    "RayTracer",
    "Render",
    "RoughConductor",
    "RoughDielectric",
    "Sampler",
    "Scene",
    "Shape",
    "States",
    "Texture",
    "info",
    "load",
    "render",
]

_HOME = {
    "errors": ("PylmcError", "PylmcWarning"),
    "inspection": ("info",),
    "scene.loading": ("load",),
    "device.raytracer": ("RayTracer",),
    "rendering": ("Render", "render"),
    "sampling.sampler": ("Sampler",),
    "sampling.states": ("States",),
    "scene": (
        "Portal",
        "Camera",
        "Diffuse",
        "MetallicRoughness",
        "PointLight",
        "RoughConductor",
        "RoughDielectric",
        "Scene",
        "Shape",
        "Texture",
    ),
}
_MODULE_OF = {name: module for module, names in _HOME.items() for name in names}


def __getattr__(name: str) -> Any:
    if name == "__version__":
        value: Any = _version()
    elif name in _MODULE_OF:
        from importlib import import_module

        value = getattr(import_module(f".{_MODULE_OF[name]}", __name__), name)
    else:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__, "__version__"})


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("pylmc")
    except PackageNotFoundError:  # run from a checkout that is not installed
        return "0.0.0"
