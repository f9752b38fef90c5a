"""What several test modules share: kernels of the tests' own, edited kernels, and scenes that use textures."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any
from unittest.mock import patch

import numpy as np
import pyopencl as cl
import trimesh

from pylmc.device import program
from pylmc.device.device_scene import DeviceScene
from pylmc.scene import (
    Camera,
    Diffuse,
    DirectionalLight,
    Material,
    MetallicRoughness,
    Plastic,
    PointLight,
    Scene,
    Shape,
    SpotLight,
    Texture,
)


def build_probe(device: DeviceScene, text: str, name: str, **extra: Any) -> cl.Kernel:
    """Kernel ``name`` of the source ``text``, whose ``#include`` lines find the package's kernels."""
    # a device scene keeps its programs by name: the text must take part in it
    probe, original = f"probe {hash(text)}", program.source

    def source(wanted: str, files: Any = None) -> str:
        return program.assembled("probe.cl", text, files) if wanted == probe else original(wanted, files)

    with patch.object(program, "source", source):
        return device.kernel(probe, name, **extra)


NUMBER_TYPES = ("number/real.cl", "number/float_float.cl")  # come before every kernel source, and are never edited


@contextmanager
def edited_source(edits: Mapping[str, str]) -> Iterator[None]:
    """Kernels are built with pieces of their source replaced; each piece must be there in one of them at least."""
    original, missing = program.source, set(edits)

    def source(name: str, files: Any = None) -> str:
        text = original(name, files)
        if name in NUMBER_TYPES:
            return text
        for old, new in edits.items():
            if old in text:
                missing.discard(old)
                text = text.replace(old, new)
        return text

    with patch.object(program, "source", source):
        yield
    assert not missing, f"no kernel built here holds {' or '.join(map(repr, missing))}"


def textured_scene() -> Scene:
    """A checkered floor of two lobes (diffuse and GGX) before a wall, with a panel and a point light: both endings."""
    return _corner(lambda checks: MetallicRoughness(checks, metallic=0.4, roughness=0.6), Diffuse((0.5, 0.6, 0.7)))


def varnished_scene() -> Scene:
    """The same in plastics: a checkered floor of a wide coat, a wall of a narrow one."""
    return _corner(lambda checks: Plastic(checks, 0.35, 1.5), Plastic((0.5, 0.6, 0.7), 0.15, 1.8, "separable"))


def spotlit_scene() -> Scene:
    """The textured scene with a spot light of a soft rim beside its point light."""
    scene = textured_scene()
    spot = SpotLight((-0.5, 1.2, 0.8), (0.4, -1.0, -0.6), 1.5, inner_angle=15, outer_angle=35)
    return Scene(scene.camera, scene.shapes, [*scene.lights, spot])


def sunlit_scene() -> Scene:
    """The textured scene in parallel light, under a roof with a hole that the light is aimed at."""
    scene = textured_scene()
    outer, inner = np.array([-0.9, 0.9]), np.array([-0.2, 0.1])
    roof = [
        Shape(([[x0, 1.3, z0], [x0, 1.3, z1], [x1, 1.3, z1], [x1, 1.3, z0]], [[0, 1, 2], [0, 2, 3]]), Diffuse(0.4))
        for x0, x1, z0, z1 in (
            (outer[0], inner[0], *outer),
            (inner[1], outer[1], *outer),
            (*inner, outer[0], inner[0]),
            (*inner, inner[1], outer[1]),
        )
    ]
    return Scene(scene.camera, [*scene.shapes[:2], *roof], [*scene.lights, DirectionalLight((0.3, -1.0, -0.2), 2.0)])


def _corner(floor_material: Callable[[Texture], Material], wall_material: Material) -> Scene:
    rng = np.random.default_rng(0)
    checks = np.kron(np.indices((4, 4)).sum(axis=0) % 2, np.ones((2, 2)))[..., None]
    pixels = 0.2 + 0.6 * checks * np.array([1.0, 0.7, 0.4]) + 0.1 * rng.random((8, 8, 3))
    vertices = np.array([[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]], float)
    uv = np.array([[-0.3, 0.2], [-0.3, 1.7], [1.4, 1.7], [1.4, 0.2]])  # beyond [0, 1]: the texture repeats
    visual = trimesh.visual.TextureVisuals(uv=uv)
    floor = trimesh.Trimesh(vertices, [[0, 1, 2], [0, 2, 3]], visual=visual, process=False)
    wall = (np.array([[-1, 0, -1], [1, 0, -1], [1, 1.5, -1], [-1, 1.5, -1]], float), np.array([[0, 1, 2], [0, 2, 3]]))
    panel = (np.array([[-0.4, 1.4, -0.2], [0.2, 1.4, -0.2], [0.2, 1.4, 0.4], [-0.4, 1.4, 0.4]]), wall[1])
    shapes = [
        Shape(floor, floor_material(Texture(pixels)), name="floor"),
        Shape(wall, wall_material, name="wall"),
        Shape(panel, Diffuse(0.2), emission=4.0, name="panel"),
    ]
    camera = Camera((0.3, 1.0, 2.2), (0, 0.4, -0.2), fov=45, width=24, height=18)
    return Scene(camera, shapes, [PointLight((0.6, 0.9, 0.5), 0.7)])
