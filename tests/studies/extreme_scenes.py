"""The axes of bench.extremes: a small scene for each, driven from the ordinary to the absurd by one number.

Each scene is built so that all of its light depends on the thing that is driven: were it lost to rounding, the picture would
be black. ``law`` says how the picture's mean goes with the value in the limit, so that the double reference is checked too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import pylmc
from pylmc import Camera, Diffuse, PointLight, Portal, RoughConductor, Scene, Shape
from pylmc.sampling.compiled import compile_scene
from pylmc.scene.builtin._meshes import box, rectangle

SIDE = 16  # pixels of the film, where that is not what is driven
SLIVERS = 1000


@dataclass(frozen=True)
class Axis:
    """What is driven, its values from ordinary to extreme (as shown), the scene at each, and paths of up to ``max_depth``.

    ``law``: expected factor of the picture's mean at a value, or None where there is no simple one.
    """

    name: str
    what: str
    values: tuple[Any, ...]
    build: Callable[[Any], Scene]
    max_depth: int
    law: Callable[[Any], float] | None = None


def _wall_and_mirror(alpha: float) -> Scene:
    shapes = [
        Shape(rectangle((-1, 0, 0), (2, 0, 0), (0, 2, 0)), Diffuse((0.7, 0.6, 0.5)), name="wall"),
        Shape(rectangle((-1, 0, 0), (0, 0, 1), (2, 0, 0)), RoughConductor(alpha, 0.9), name="mirror"),
    ]
    camera = Camera((0.6, 0.9, 2.5), (0, 0.5, 0), fov=36, width=SIDE, height=SIDE)
    return Scene(camera, shapes, [PointLight((-0.3, 1.2, 1.2), 1.0)])


def _glass(alpha: float) -> Scene:
    return pylmc.load("caustic", alpha=alpha, width=SIDE, height=SIDE)


def _hole(hole: float) -> Scene:
    return pylmc.load("keyhole", hole=hole, width=SIDE, height=SIDE)


def _object(side: float) -> Scene:
    """A wall that sees the lamp by way of a small box beyond the screen's edge only; its side is a part of the wall's, 2."""
    shapes = [
        Shape(rectangle((-1, -1, 0), (2, 0, 0), (0, 2, 0)), Diffuse(0.7), name="wall"),
        Shape(rectangle((1.3, -1.5, -0.5), (0, 3, 0), (0, 0, 2)), Diffuse(0.5), name="screen"),
        Shape(box((1.2, 0, 2), (2 * side,) * 3, 30), Diffuse(0.8), name="small box"),
    ]
    camera = Camera((0, 0, 2.5), (0, 0, 0), fov=40, width=SIDE, height=SIDE)
    return Scene(camera, shapes, [PointLight((2.5, 0, 1), 10.0)])


def _emitter(side: float) -> Scene:
    """A lamp of constant power whose side is a part of the wall's, 2."""
    s = 2 * side
    shapes = [
        Shape(rectangle((-1, 0, 0), (2, 0, 0), (0, 2, 0)), Diffuse(0.7), name="wall"),
        Shape(rectangle((-1, 0, 0), (0, 0, 2), (2, 0, 0)), Diffuse(0.6), name="floor"),
        Shape(rectangle((0.3 - s / 2, 1.2, 0.8 - s / 2), (s, 0, 0), (0, 0, s)), Diffuse(0.0), emission=1 / s**2, name="lamp"),
    ]
    camera = Camera((0.2, 0.5, 3), (0, 0.5, 0), fov=36, width=SIDE, height=SIDE)
    return Scene(camera, shapes)


def moved(scene: Scene, scale: float, offset: Any, gain: float) -> Scene:
    """The scene with every length times ``scale``, then moved by ``offset``; point lights times ``gain``."""
    offset = np.asarray(offset, float)

    def at(point: Any) -> Any:
        return np.asarray(point) * scale + offset

    c = scene.camera
    shapes = [Shape((at(s.mesh.vertices), s.mesh.faces), s.material, s.emission, s.name) for s in scene.shapes]
    holes = [Portal(at(a.centre), a.normal, a.axis, np.array(a.half_size) * scale) for a in compile_scene(scene).portals]
    lights = [PointLight(at(light.position), np.array(light.intensity) * gain) for light in scene.lights]
    camera = Camera(at(c.origin), at(c.target), c.up, c.fov, c.width, c.height)
    return Scene(camera, shapes, lights, holes)


def _grazing_camera(angle: float) -> Scene:
    """Every ray of the camera meets the floor at about ``angle`` (radians), at about unit distance."""
    camera = Camera((0, np.sin(angle), 0), (np.cos(angle), 0, 0), fov=np.degrees(angle / 2), width=SIDE, height=SIDE)
    return _floor_and_wall(camera, (1, 1, 0.3))


def _zoom(angle: float) -> Scene:
    camera = Camera((1, 1, 0.3), (0, 0, 0.1), fov=np.degrees(angle), width=SIDE, height=SIDE)
    return _floor_and_wall(camera, (0.5, 1, 0.3))


def _grazing_light(angle: float) -> Scene:
    """The light stands ``angle`` above the floor, at about unit distance of what is seen."""
    floor = Shape(rectangle((-1, 0, -1), (0, 0, 3), (4, 0, 0)), Diffuse(0.6), name="floor")
    camera = Camera((1.2, 1, 0), (1, 0, 0), fov=20, width=SIDE, height=SIDE)
    return Scene(camera, [floor], [PointLight((0, np.sin(angle), 0), 5.0)])


def _floor_and_wall(camera: Camera, light: Any, floor: Any = None) -> Scene:
    floor = rectangle((-1, 0, -1), (0, 0, 3), (4, 0, 0)) if floor is None else floor
    shapes = [
        Shape(floor, Diffuse((0.7, 0.6, 0.5)), name="floor"),
        Shape(rectangle((-1, 0, -1), (4, 0, 0), (0, 2, 0)), Diffuse(0.6), name="wall"),
    ]
    return Scene(camera, shapes, [PointLight(light, 5.0)])


def _strips(width: float) -> Any:
    """The floor, of which a band SLIVERS * width wide at z = 0 is cut into strips along x, four long: two slivers each."""
    edges = np.concatenate([[-1], (np.arange(SLIVERS + 1) - SLIVERS / 2) * width, [2]])
    vertices = np.array([[x, 0, z] for z in edges for x in (-1, 3)])
    quads = np.array([[2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1] for i in range(len(edges) - 1)])
    return vertices, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def _degenerate() -> Any:
    """The floor with 300 triangles of no area, on it and through what is seen: points, and three points of one line."""
    vertices, faces = rectangle((-1, 0, -1), (0, 0, 3), (4, 0, 0))
    rng = np.random.default_rng(0)
    a = rng.uniform((-0.5, 0, -0.5), (0.5, 0.2, 0.5), (300, 3))
    a[::2, 1] = 0
    b = a + (np.arange(300) % 3 > 0)[:, None] * rng.normal(size=(300, 3)) * 0.2
    more = np.stack([a, b, (a + b) / 2], axis=1).reshape(-1, 3)
    return np.concatenate([vertices, more]), np.concatenate([faces, 4 + np.arange(900).reshape(300, 3)])


def _triangles(kind: str) -> Scene:
    width = {"aspect 1e3": 4e-3, "aspect 1e6": 4e-6}.get(kind)
    floor = _strips(width) if width else _degenerate() if kind == "degenerate" else None
    camera = Camera((1, 1, 0.3), (0, 0, 0), fov=0.1, width=SIDE, height=SIDE)  # sees 2.5e-3 of the floor: slivers only
    scene = _floor_and_wall(camera, (0.5, 1, 0.3), floor)
    if kind == "coincident":
        return Scene(scene.camera, [*scene.shapes, *scene.shapes], scene.lights)
    return scene


def _film(side: int) -> Scene:
    return pylmc.load("keyhole", width=side, height=side)


def _constant(_: Any) -> float:
    return 1.0


AXES = (
    Axis(
        "roughness",
        "GGX alpha of a mirror that throws light on a wall",
        (1.0, 1e-1, 1e-2, 1e-4, 1e-6, 1e-8),
        _wall_and_mirror,
        3,
        _constant,
    ),
    Axis(
        "glass",
        "GGX alpha of a glass ball with smooth normals over a floor (caustic)",
        (0.3, 1e-2, 1e-4, 1e-6, 1e-7, 1e-8),
        _glass,
        5,
        _constant,
    ),
    Axis("hole", "the hole's side over the wall's (keyhole)", (0.9, 1e-2, 1e-4, 1e-5, 1e-6, 1e-8), _hole, 4, lambda v: v**2),
    Axis(
        "object",
        "side of the diffuse box by which all light comes, over the wall's",
        (2e-1, 1e-2, 1e-4, 1e-5, 1e-6),
        _object,
        4,
        lambda v: v**2,
    ),
    Axis(
        "emitter",
        "side of the lamp, over the wall's, its power being constant",
        (2e-1, 1e-2, 1e-4, 1e-5, 1e-6),
        _emitter,
        3,
        _constant,
    ),
    Axis(
        "scale",
        "size of the whole scene (keyhole)",
        (1.0, 1e-6, 1e-3, 1e3, 1e6),
        lambda v: moved(_hole(0.05), v, 0, v**2),
        4,
        _constant,
    ),
    Axis(
        "distance",
        "distance of the scene from the origin, in its sizes (keyhole)",
        (0.0, 1e1, 1e2, 1e4, 1e6),
        lambda v: moved(_hole(0.05), 1, np.full(3, v * 2.9 / np.sqrt(3)), 1),
        4,
        _constant,
    ),
    Axis(
        "grazing camera",
        "angle of the camera's rays to the floor, radians",
        (0.3, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6),
        _grazing_camera,
        3,
        _constant,
    ),
    Axis(
        "grazing light",
        "angle of the light above the floor, radians",
        (0.3, 1e-2, 1e-4, 1e-5, 1e-6),
        _grazing_light,
        3,
        lambda v: v,
    ),
    Axis("zoom", "the camera's field of view, radians", (0.5, 1e-2, 1e-4, 1e-5, 1e-6), _zoom, 3, _constant),
    Axis(
        "path length",
        "segments of the path in a closed box (paths up to 32)",
        (1, 2, 4, 8, 16, 32),
        lambda v: pylmc.load("box", width=SIDE, height=SIDE),
        32,
    ),
    Axis("film", "pixels along each side (keyhole, paths of 2 segments)", (1, 16, 256, 2048, 8192), _film, 2, _constant),
    Axis(
        "intensity",
        "of the light (keyhole)",
        (1.0, 1e-30, 1e-10, 1e10, 1e30),
        lambda v: moved(_hole(0.05), 1, 0, v),
        4,
        lambda v: v,
    ),
    Axis(
        "triangles",
        "those that the camera sees: slivers, and such as should not be there",
        ("plain", "aspect 1e3", "aspect 1e6", "degenerate", "coincident"),
        _triangles,
        3,
        _constant,
    ),
)
