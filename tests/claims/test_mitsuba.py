"""Scenes described once, rendered by pylmc and by Mitsuba 3, compared by t-tests over independent runs.

See ``comparison/scenes.py`` for the scenes, ``comparison/to_mitsuba.py`` for how conventions map, ``comparison/verdict.py``
for the statistics. What fails leaves its pictures in out/comparison/<scene>/<integrator>. Seeds are fixed.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

pytest.importorskip("mitsuba", reason="the independent renderer; install with pip install -e .[mitsuba]")

from studies.comparison.description import Description, Glass, Matte
from studies.comparison.evidence import confirm
from studies.comparison.scenes import PANE, RED, SCENES, WATER
from studies.comparison.to_mitsuba import mitsuba_runs
from studies.comparison.to_pylmc import bdpt_runs, lmc_runs, path_runs, pylmc_scene
from studies.comparison.verdict import judge
from studies.probes import edited_source

RUNS = 16  # on either side: enough degrees of freedom for levels of 1e-8 to be reachable
INTEGRATORS = ("lmc", "path")
FAMILY = len(SCENES) * len(INTEGRATORS)


def runs_of(description: Description, integrator: str, work: int = 1, masking: str = "separable") -> np.ndarray:
    """Pictures by pylmc; ``work`` multiplies the samples of each run."""
    scene, depth = pylmc_scene(description, masking), description.depth
    if integrator == "lmc":
        return lmc_runs(scene, depth, RUNS, 128 * work)
    if integrator == "path":
        return path_runs(scene, depth, RUNS, 160 * work)
    return bdpt_runs(scene, depth, RUNS, 2 * work)


@cache
def reference(name: str) -> np.ndarray:
    return mitsuba_runs(SCENES[name], 2 * RUNS, 160)


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("name", SCENES)
def test_same_picture(name: str, integrator: str) -> None:
    """Per pixel, per tile and as a whole."""
    work = 2 if integrator == "lmc" else 1
    verdict = judge(runs_of(SCENES[name], integrator, work), reference(name), FAMILY)
    confirm(verdict, f"{name}/{integrator}")
    assert verdict.ratio_error < 0.03  # enough samples to mean something: an eta squared is a factor of 1.8


# --- negative controls: the test must be able to fail -----------------------------------------------------------------

MISTAKES: dict[str, tuple[str, Callable[[Description], Description]]] = {
    "reflectance off by a fiftieth": (
        "smooth-ball",
        lambda scene: scene.with_materials({Matte(RED): Matte((0.7 * 1.02, 0.15 * 1.02, 0.1 * 1.02))}),
    ),
    "vertex normals left out": ("smooth-ball", Description.faceted),
    "one segment too many": ("room", lambda scene: scene.with_depth(scene.depth + 1)),
    "index inverted in a slab": ("pane-front", lambda scene: scene.with_materials({PANE: Glass(PANE.alpha, 1 / PANE.ior)})),
    "index inverted in one interface": (
        "lamp-in-water",
        lambda scene: scene.with_materials({WATER: Glass(WATER.alpha, 1 / WATER.ior)}),
    ),
    "roughness off by a tenth": ("pane-behind", lambda scene: scene.with_materials({PANE: Glass(1.1 * PANE.alpha, PANE.ior)})),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_mistakes_are_seen(mistake: str) -> None:
    """What is rendered is not quite what Mitsuba was told."""
    name, change = MISTAKES[mistake]
    assert not judge(runs_of(change(SCENES[name]), "path"), reference(name), FAMILY).passed


def test_mistaken_masking_is_seen() -> None:
    """Smith's two terms differ by some percent at these roughnesses: the mapping of materials has to name one."""
    scene = SCENES["metal-plates"]
    assert not judge(runs_of(scene, "path", 4, masking="height-correlated"), reference(scene.name), FAMILY).passed


# refracted radiance: the Jacobian of the half vector, (i.h + η o.h)² in the denominator, without the η² that compresses angles
WITHOUT_ETA_SQUARED = {"(ci * square(im + eta * om))": "(ci * square(im / eta + om))"}


@pytest.mark.parametrize("name", ["lamp-in-water", "lamp-over-water"])
def test_eta_squared_left_out_is_seen(name: str) -> None:
    """One interface between camera and light: radiance is off by the square of the index, here 1.77 or its inverse."""
    with edited_source(WITHOUT_ETA_SQUARED):
        runs = runs_of(SCENES[name], "path")
    verdict = judge(runs, reference(name), FAMILY)
    assert not verdict.passed and abs(np.log(verdict.ratio)) > 0.3


# --- full grid --------------------------------------------------------------------------------------------------------

DEPTHS = (2, 3, 4, 5, 6)
GRID = [("room", 1), *((name, depth) for name in SCENES for depth in DEPTHS)]  # no other scene shows its light
LONG_FAMILY = 3 * len(GRID)


@pytest.mark.long
@pytest.mark.parametrize(("name", "depth"), GRID)
def test_same_picture_at_every_depth(name: str, depth: int) -> None:
    """All three integrators, films of 24 x 24, the longest path from one segment to six."""
    scene = SCENES[name].with_size(24, 24).with_depth(depth)
    theirs = mitsuba_runs(scene, 2 * RUNS, 160)
    for integrator in ("lmc", "path", "bdpt"):
        verdict = judge(runs_of(scene, integrator, work=2), theirs, LONG_FAMILY)
        confirm(verdict, f"{name}/{integrator}-{depth}")
