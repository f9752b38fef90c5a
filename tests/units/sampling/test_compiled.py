"""What is found in a scene when it is compiled."""

import numpy as np
import pytest

import pylmc
from pylmc import Portal
from pylmc.sampling.compiled import compile_scene


def test_holes_are_found_on_compilation_and_told() -> None:
    scene = pylmc.load("keyhole", hole=0.1)
    assert scene.portals == scene.with_size(8, 8).portals == "auto"
    (portal,) = compile_scene(scene).portals
    assert isinstance(portal, Portal)
    np.testing.assert_allclose(portal.half_size, 0.05)
    assert "portals       1 found (inner boundary loops of open planar pieces): at (0, 0.5, 0.5)\n" in pylmc.info(scene)


@pytest.mark.parametrize("given", [(), (Portal((0, 0.5, 0.5), (1, 0, 0), (0, 1, 0), 0.02),)])
def test_given_portals_are_taken_as_they_are(given: tuple[Portal, ...]) -> None:
    keyhole = pylmc.load("keyhole")
    scene = pylmc.Scene(keyhole.camera, keyhole.shapes, keyhole.lights, given)
    assert compile_scene(scene).portals == given
    assert f"portals       {len(given)} given" in pylmc.info(scene)


def test_limits_name_the_shape_below_the_camera() -> None:
    keyhole = pylmc.load("keyhole")
    camera = pylmc.Camera((0.3, 1e-7, 0.5), (1, 0.5, 0.5))
    scene = pylmc.Scene(camera, keyhole.shapes, keyhole.lights)
    assert "the camera is very close to 'floor'" in pylmc.info(scene)


def test_a_light_on_a_surface_is_told_in_every_precision() -> None:
    floor = pylmc.Shape(
        ([[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]], [[0, 1, 2], [0, 2, 3]]), pylmc.Diffuse(), name="floor"
    )
    scene = pylmc.Scene(pylmc.Camera((0, 1, 2), (0, 0, 0)), [floor], [pylmc.PointLight((0.2, 0, 0.1))])
    for precision in ("single", "mixed", "double"):
        assert "light 0 lies on 'floor': which side it shines to is decided by rounding" in pylmc.info(scene, precision)
