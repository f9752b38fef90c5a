"""Two rooms, a lamp in one, a small hole in the wall between, and a near-mirror plate in the camera's room.

It stresses the paper's two difficulties at once: all light that the camera sees has passed the hole, and what lights the
room most is the thin beam that the plate throws on. Paths through the hole are rare, and a path off the plate must keep
both to the plate's narrow lobe and to the hole.
"""

from __future__ import annotations

from typing import Annotated

from pylmc.scene import Camera, Diffuse, PointLight, RoughConductor, Scene, Shape

from ._meshes import box, rectangle, wall_with_hole
from ._parameter import Parameter


def build(
    hole: Annotated[float, Parameter("side of the hole, the wall's being 1", 0.9)] = 0.05,
    alpha: Annotated[float, Parameter("GGX roughness of the plate", 1.0)] = 0.02,
) -> Scene:
    white, red, blue = Diffuse(0.75), Diffuse((0.75, 0.25, 0.2)), Diffuse((0.25, 0.4, 0.75))
    shapes = [
        Shape(rectangle((-1, 0, 0), (0, 0, 1), (2.5, 0, 0)), white, name="floor"),
        Shape(rectangle((-1, 1, 0), (2.5, 0, 0), (0, 0, 1)), white, name="ceiling"),
        Shape(rectangle((-1, 0, 0), (2.5, 0, 0), (0, 1, 0)), red, name="left wall"),
        Shape(rectangle((-1, 0, 1), (0, 1, 0), (2.5, 0, 0)), blue, name="right wall"),
        Shape(rectangle((1.5, 0, 0), (0, 0, 1), (0, 1, 0)), white, name="far wall"),
        Shape(rectangle((-1, 0, 0), (0, 1, 0), (0, 0, 1)), white, name="lamp room's end wall"),
        Shape(wall_with_hole((0, 0, 0), (0, 1, 0), (0, 0, 1), hole), white, name="wall with the hole"),
        Shape(rectangle((0.85, 0.06, 0.2), (0, 0, 0.6), (0.5, 0, 0)), RoughConductor(alpha, 0.9), name="plate"),
        Shape(box((1.1, 0.03, 0.5), (0.4, 0.05, 0.5)), Diffuse(0.3), name="plinth"),
        Shape(box((0.4, 0.2, 0.78), (0.2, 0.4, 0.2), 25), Diffuse(0.6), name="pillar"),
    ]
    # beside the spot that the plate throws on the far wall, which lights what the camera sees
    camera = Camera((1.44, 0.6, 0.1), (0.3, 0.3, 0.68), fov=58)
    return Scene(camera, shapes, [PointLight((-0.8, 0.82, 0.42), 2.0)])
