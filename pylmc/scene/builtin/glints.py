"""A tiny mirror hangs in a corner of three diffuse walls and throws a spot of the lamp's light on them.

It stresses the small-object constraint: nothing is in the light's way, but a path by way of the mirror must keep its node on
a piece of surface that covers next to nothing of any direction's view.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from pylmc.scene import Camera, Diffuse, PointLight, RoughConductor, Scene, Shape

from ._meshes import box, rectangle
from ._parameter import Parameter


def build(
    size: Annotated[float, Parameter("side of the mirror, the walls' being 2", 0.5)] = 0.06,
    alpha: Annotated[float, Parameter("GGX roughness of the mirror", 1.0)] = 0.01,
) -> Scene:
    lamp, mirror, spot = np.array([0.3, 1.5, 0.9]), np.array([0.45, 0.7, 0.2]), np.array([-1.0, 1.0, 0.1])
    to_lamp, to_spot = (v / np.linalg.norm(v) for v in (lamp - mirror, spot - mirror))
    normal = (to_lamp + to_spot) / np.linalg.norm(to_lamp + to_spot)
    across = np.cross(normal, [0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    along = np.cross(normal, across)
    corner = mirror - size / 2 * (across + along)
    shapes = [
        Shape(rectangle((-1, 0, -1), (0, 0, 2), (2, 0, 0)), Diffuse(0.35), name="floor"),
        Shape(rectangle((-1, 0, -1), (2, 0, 0), (0, 2, 0)), Diffuse((0.25, 0.3, 0.4)), name="back wall"),
        Shape(rectangle((-1, 0, -1), (0, 2, 0), (0, 0, 2)), Diffuse((0.65, 0.55, 0.45)), name="left wall"),
        Shape(rectangle(tuple(corner), tuple(size * across), tuple(size * along)), RoughConductor(alpha, 0.95), name="mirror"),
        # a card beside the lamp that keeps its own light off the left wall, where the spot falls
        Shape(box((0.1, 1.5, 0.9), (0.01, 0.36, 0.36)), Diffuse(0.02), name="shade"),
    ]
    camera = Camera((1.9, 1.2, 2.3), (-0.35, 0.7, -0.3), fov=42)
    return Scene(camera, shapes, [PointLight(tuple(lamp), 1.0)])
