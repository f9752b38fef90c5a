"""The scene as a person describes it: camera, shapes with materials, lights, holes."""

from .camera import Camera
from .lights import PointLight
from .materials import Diffuse, Material, MetallicRoughness, RoughConductor, RoughDielectric
from .portal import Portal
from .scene import Scene
from .shape import Shape
from .texture import Texture

__all__ = [
    "Camera",
    "Diffuse",
    "Material",
    "MetallicRoughness",
    "PointLight",
    "Portal",
    "RoughConductor",
    "RoughDielectric",
    "Scene",
    "Shape",
    "Texture",
]
