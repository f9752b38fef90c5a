"""pylmc: Markov-chain light transport on any OpenCL device, with constraint-preconditioned Langevin proposals."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

from .errors import PylmcError
from .info import info
from .loading import load
from .raytracer import RayTracer
from .render import Render, render
from .sampler import Sampler, States
from .scene import (
    Aperture,
    Camera,
    Diffuse,
    MetallicRoughness,
    PointLight,
    RoughConductor,
    RoughDielectric,
    Scene,
    Shape,
    Texture,
)

try:
    __version__ = version("pylmc")
except PackageNotFoundError:  # run from a checkout that is not installed
    __version__ = "0.0.0"

__all__ = [
    "Aperture", "Camera", "Diffuse", "MetallicRoughness", "PointLight", "PylmcError", "RayTracer", "Render",
    "RoughConductor", "RoughDielectric", "Sampler", "Scene", "Shape", "States", "Texture", "info", "load", "render",
]  # fmt: skip
