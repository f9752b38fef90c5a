"""A plain diffuse box with coloured walls, two blocks and a broad light in the ceiling.

It stresses nothing: there is no lobe, hole or small object to constrain, so its kernels must be the leanest, and a method
that helps elsewhere must not cost here.
"""

from __future__ import annotations

from typing import Annotated

from pylmc.scene import Camera, Diffuse, Scene, Shape

from ._meshes import box, rectangle
from ._parameter import Parameter


def build(light: Annotated[float, Parameter("side of the square light, the ceiling's being 1", 0.95)] = 0.5) -> Scene:
    white, red, green = Diffuse(0.73), Diffuse((0.63, 0.06, 0.05)), Diffuse((0.14, 0.45, 0.09))
    low = (1 - light) / 2
    shapes = [
        Shape(rectangle((0, 0, 0), (0, 0, 1), (1, 0, 0)), white, name="floor"),
        Shape(rectangle((0, 1, 0), (1, 0, 0), (0, 0, 1)), white, name="ceiling"),
        Shape(rectangle((0, 0, 0), (1, 0, 0), (0, 1, 0)), white, name="back wall"),
        Shape(rectangle((0, 0, 0), (0, 1, 0), (0, 0, 1)), red, name="left wall"),
        Shape(rectangle((1, 0, 0), (0, 0, 1), (0, 1, 0)), green, name="right wall"),
        Shape(box((0.34, 0.3, 0.34), (0.3, 0.6, 0.3), 18), white, name="tall block"),
        Shape(box((0.66, 0.15, 0.64), (0.3, 0.3, 0.3), -17), white, name="short block"),
        Shape(rectangle((low, 0.998, low), (light, 0, 0), (0, 0, light)), Diffuse(0.0), emission=3.0, name="light"),
    ]
    return Scene(Camera((0.5, 0.5, 2.4), (0.5, 0.5, 0), fov=39), shapes)
