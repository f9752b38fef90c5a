"""The Markov kernel leaves its target invariant, for every chart, rule and ending; and the test can fail."""

from __future__ import annotations

import numpy as np
import pytest
from invariance import moved_and_fresh, smallest_by_group

from pylmc.loading import load
from pylmc.scene import Diffuse, PointLight, Scene, Shape

ALPHA = 1e-4  # of a configuration, Šidák-corrected over its tests; some 50 configurations make it 0.5 % for the file


def both_endings(name: str) -> Scene:
    """A built-in scene, made easy enough for an exact start, with a point light and an emitter."""
    parameters = {"keyhole": {"hole": 0.3, "roughness": 0.2}, "caustic": {"roughness": 0.25},
                  "glints": {"size": 0.3, "roughness": 0.2}}  # fmt: skip
    scene = load(name, **parameters[name]).with_size(64, 64)
    corner, edge1, edge2 = {
        "keyhole": ((-0.9, 0.95, 0.3), (0.2, 0, 0), (0, 0, 0.3)), "glints": ((0.2, 1.6, 0.8), (0.25, 0, 0), (0, 0, 0.25)),
        "caustic": ((1.0, 2.5, 1.0), (0.3, 0, 0), (0, 0, 0.3)),
    }[name]  # fmt: skip
    c, a, b = np.array(corner), np.array(edge1), np.array(edge2)
    panel = Shape((np.array([c, c + a, c + a + b, c + b]), [[0, 1, 2], [0, 2, 3]]), Diffuse(0.0), emission=20.0)
    lights = scene.lights or [PointLight((1.2, 2.2, 0.8), 6.0)]
    return Scene(scene.camera, [*scene.shapes, panel], lights, scene.apertures)


SCENES = {name: both_endings(name) for name in ("keyhole", "caustic", "glints")}


def check(scene: Scene, **settings: object) -> None:
    settings = {"max_depth": 3, "large_steps": 0.0, "step": (0.2, 1.0), **settings}
    sampler, fresh, moved = moved_and_fresh(scene, 40, **settings)
    smallest, where, tests = smallest_by_group(sampler, fresh, moved)
    assert tests >= 10
    assert smallest > 1 - (1 - ALPHA) ** (1 / tests), f"{where}: p = {smallest:.2g} of {tests} tests"


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("rule", ["sum", "mean", "rms"])
@pytest.mark.parametrize("chart", ["equal-area", "orthographic"])
def test_target_coordinates(scene: str, chart: str, rule: str) -> None:
    check(SCENES[scene], chart=chart, rule=rule)


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("rule", ["sum", "mean", "rms"])
@pytest.mark.parametrize("chart", ["equal-area", "orthographic"])
def test_deviation_coordinates(scene: str, chart: str, rule: str) -> None:
    check(SCENES[scene], chart=chart, rule=rule, coordinates="deviation")


@pytest.mark.parametrize("coordinates", ["target", "deviation"])
@pytest.mark.parametrize("scene", SCENES)
def test_drift(scene: str, coordinates: str) -> None:
    check(SCENES[scene], coordinates=coordinates, drift=True)


def test_other_projection() -> None:
    check(SCENES["keyhole"], coordinates="deviation", projection="orthographic")


def test_large_steps_alone_and_mixed() -> None:
    check(SCENES["keyhole"], large_steps=1.0)
    check(SCENES["caustic"], large_steps=0.3)


def test_plain_box() -> None:
    check(load("box").with_size(64, 64))


def test_printed_unit_jacobian_is_seen() -> None:
    """Negative control: the preprint's chart with its unit Jacobian does not keep the target (theory.md, 2, Correction)."""
    settings = {"max_depth": 2, "large_steps": 0.0, "step": (0.3, 1.0), "coordinates": "deviation"}
    smallest = {}
    for chart in ("orthographic", "orthographic-unit"):
        sampler, fresh, moved = moved_and_fresh(load("box").with_size(64, 64), 300, chart=chart, **settings)
        smallest[chart], _, tests = smallest_by_group(sampler, fresh, moved)
    assert smallest["orthographic-unit"] < 1e-9
    assert smallest["orthographic"] > 1 - (1 - ALPHA) ** (1 / tests)
