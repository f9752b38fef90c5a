"""A ball of rough glass over a diffuse floor, lit by a small bright panel.

It stresses refraction: the caustic under the ball is light that passed two narrow transmission lobes on a curved surface
with smooth normals, and ends on a small emitter.
"""

from __future__ import annotations

from typing import Annotated

import trimesh

from pylmc.scene import Camera, Diffuse, RoughDielectric, Scene, Shape

from ._meshes import rectangle
from ._parameter import Parameter


def build(
    alpha: Annotated[float, Parameter("GGX roughness of the glass", 1.0)] = 0.05,
    ior: Annotated[float, Parameter("the glass's index of refraction", 10.0)] = 1.5,
    light: Annotated[float, Parameter("side of the panel, the ball's radius being 0.5", 0.95)] = 0.3,
) -> Scene:
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.5)
    ball.apply_translation([0, 0.7, 0])
    shapes = [
        Shape(rectangle((-2, 0, -2), (0, 0, 4), (4, 0, 0)), Diffuse((0.7, 0.65, 0.6)), name="floor"),
        Shape(rectangle((-2, 0, -2), (4, 0, 0), (0, 3, 0)), Diffuse((0.4, 0.5, 0.6)), name="back wall"),
        Shape(ball, RoughDielectric(alpha, ior), name="glass ball", smooth=True),
        Shape(
            rectangle((-0.9 - light / 2, 2.6, 0.5 - light / 2), (light, 0, 0), (0, 0, light)),
            Diffuse(0.0),
            emission=60.0,
            name="panel",
        ),
    ]
    return Scene(Camera((0.9, 1.5, 3.2), (0.1, 0.45, 0), fov=38), shapes)
