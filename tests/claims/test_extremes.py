"""The extremes of bench.extremes: no number that is none, anywhere, in any precision; and limits are told beforehand.

Cells are small here: they look for NaN and infinities in the picture, the chains' arrays and the candidates' weights, at both
ends of each axis. Bias is the bench's business (docs/extremes.md), but for the control that its tests see a broken small step.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest
from studies.extreme_cells import Z_LIMIT, acceptance, bias, run, verdict
from studies.extreme_scenes import AXES, Axis
from studies.faults import FAULTS
from studies.probes import edited_source

import pylmc
from pylmc import PylmcWarning, Sampler
from pylmc.colour import LUMINANCE
from pylmc.sampling.compiled import compile_scene
from pylmc.sampling.limits import limits
from pylmc.scene import builtin

PRECISIONS = ("single", "mixed", "double")
LARGEST_FILM = 2048  # in a quick test; 8192 takes gigabytes
# the axes whose scenes share kernels, so that little is compiled, and the depth that they share
QUICK = {
    "hole": 4,
    "scale": 4,
    "distance": 4,
    "intensity": 4,
    "film": 4,
    "grazing camera": 3,
    "grazing light": 3,
    "zoom": 3,
    "triangles": 3,
    "emitter": 3,
}
DEPTH = 8  # of "path length" here; the bench goes to 32
AXIS = {axis.name: axis for axis in AXES}


def ends(axis: Axis) -> list[Any]:
    values = [axis.values[0], axis.values[-1]]
    return [min(value, LARGEST_FILM) for value in values] if axis.name == "film" else values


def check_finite(axis: Axis, value: Any, precision: str, max_depth: int, **settings: Any) -> None:
    """A cell has no NaN or infinity, and refuses only by a message of its own that names the remedy."""
    cell = run(axis.build(value), precision, max_depth, range(1, 2), 1 << 13, 128, **settings)
    if cell.refused:
        assert cell.refused.startswith("no light path was found"), cell.refused
        assert cell.warned or precision == "double", f"a dark picture of {axis.name} {value} came without a warning"
    assert (cell.bad_pixels, cell.bad_states, cell.bad_weights) == (0, 0, 0)
    assert cell.film_loss < 1e-3


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("name", QUICK)
def test_no_cell_holds_a_number_that_is_none(name: str, precision: str) -> None:
    for value in ends(AXIS[name]):
        check_finite(AXIS[name], value, precision, QUICK[name])


@pytest.mark.long
@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("axis", AXES, ids=lambda axis: axis.name)
def test_no_cell_of_the_whole_table_does(axis: Axis, precision: str) -> None:
    for value in axis.values:
        if axis.name != "path length" or value == axis.values[0]:
            smaller = min(value, LARGEST_FILM) if axis.name == "film" else value
            check_finite(axis, smaller, precision, min(axis.max_depth, DEPTH))


@pytest.mark.long
@pytest.mark.parametrize("settings", [{"drift": True}, {"coordinates": "deviation"}, {"rule": "rms", "drift": True}], ids=str)
@pytest.mark.parametrize("name", ["roughness", "glass", "hole", "object", "emitter", "grazing camera", "triangles"])
def test_nor_with_other_settings(name: str, settings: dict[str, Any]) -> None:
    for precision in ("single", "double"):
        check_finite(AXIS[name], AXIS[name].values[-1], precision, AXIS[name].max_depth, **settings)


def test_a_broken_small_step_is_seen() -> None:
    """Negative control of the bench's judgement: a reverse step by T(X), under which the picture's mean stays right."""
    scene = AXIS["roughness"].build(0.01)
    reference = run(scene, "double", 3, range(101, 103), 1 << 15, 1024)
    sound = run(scene, "double", 3, range(1, 3), 1 << 15, 1024)
    with edited_source(FAULTS["factor of X"]):
        broken = run(scene, "double", 3, range(1, 3), 1 << 15, 1024)
    good, bad = bias(sound, reference), bias(broken, reference)
    assert verdict(sound, good, acceptance(sound)) == "" and good["worst"] < Z_LIMIT
    assert verdict(broken, bad, acceptance(broken)) == "biased" and bad["balance"] > Z_LIMIT
    assert bad["b"] < Z_LIMIT  # what a test of the mean alone would have seen


@pytest.mark.parametrize("precision", [*PRECISIONS, "float-float"])
@pytest.mark.parametrize("name", builtin.NAMES)
def test_built_in_scenes_are_within_every_limit(name: str, precision: str) -> None:
    scene = pylmc.load(name)
    assert limits(scene, compile_scene(scene, precision), precision) == []


# an axis, a value beyond the limits of single and of mixed (None where mixed has none), what the sentence names
BEYOND = [
    ("hole", 1e-5, 1e-6, "portal 0"),
    ("object", 1e-5, 1e-5, "'small box'"),
    ("emitter", 1e-5, None, "'lamp'"),
    ("grazing camera", 1e-6, 1e-6, "the camera is very close to 'floor'"),
    ("grazing light", 1e-6, 1e-6, "light 0"),
    ("zoom", 1e-5, None, "view"),
    ("grazing camera", 1e-3, None, "view"),
    ("glass", 1e-8, None, "'glass ball'"),
    ("roughness", 1e-8, None, "'mirror'"),
]


@pytest.mark.parametrize(("name", "single", "mixed", "named"), BEYOND)
def test_what_a_mode_cannot_do_is_said_with_the_one_that_can(name: str, single: float, mixed: float | None, named: str) -> None:
    def said(value: float, precision: str) -> list[str]:
        scene = AXIS[name].build(value)
        return [s for s in limits(scene, compile_scene(scene, precision), precision) if named in s]

    (sentence,) = said(single, "single")
    remedy = "double" if said(single, "mixed") else "mixed"
    assert f"use precision '{remedy}'" in sentence
    if mixed is None:
        assert said(single, "mixed") == []
    else:
        (sentence,) = said(mixed, "mixed")
        assert "use precision 'double'" in sentence
    assert said(AXIS[name].values[-1], "double") == []


def test_info_and_the_sampler_say_so() -> None:
    scene = AXIS["hole"].build(1e-6)
    assert "use precision 'double'" in pylmc.info(scene) and "nothing in this scene" in pylmc.info(scene, precision="double")
    with pytest.warns(PylmcWarning, match="portal 0"):
        Sampler(scene, max_depth=2)
    with warnings.catch_warnings():
        warnings.simplefilter("error", PylmcWarning)
        Sampler(scene, max_depth=2, precision="double")


def test_the_command_warns_in_one_line(capsys: pytest.CaptureFixture[str], tmp_path: Any) -> None:
    from pylmc.cli.commands import main

    arguments = [
        "render",
        "keyhole:hole=1e-5",
        "-o",
        str(tmp_path / "a.exr"),
        "--mutations-per-pixel",
        "1",
        "--size",
        "8x8",
        "--max-depth",
        "2",
        "--quiet",
    ]
    assert main(arguments) == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("pylmc: warning: portal 0 at (0, 0.5, 0.5) is very small") and "use precision '" in line


def test_a_black_picture_is_not_silent() -> None:
    with pytest.warns(PylmcWarning, match="black.*use integrator 'lmc'"):
        pylmc.render(
            AXIS["hole"].build(1e-4), mutations_per_pixel=1, integrator="path", max_depth=4, progress=False, precision="double"
        )


def test_large_pictures_come_group_by_group() -> None:
    """The picture is the films' sum, one at a time, and its mean is b (every step splats as much)."""
    sampler = Sampler(pylmc.load("box", width=40, height=30), max_depth=3, even=False)
    groups = sampler.init(1, 256, 1 << 12)
    sampler.step(8)
    factors = [group.b * sampler.film_pixels / (group.steps * group.chains) for group in groups]
    films = sum(sampler.film.read(slot) * factor for slot, factor in enumerate(factors))
    np.testing.assert_allclose(sampler.image(), films * sampler.compiled.radiance_scale, rtol=1e-12)
    sampler.counters()
    expected = sum(group.b for group in groups) * sampler.compiled.radiance_scale
    assert (sampler.image() @ LUMINANCE).mean() == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize(("intensity", "said"), [(1e-42, "too dim"), (1e36, None), (1.0, None)])
def test_radiance_beyond_a_pictures_range_is_said(intensity: float, said: str | None) -> None:
    """Pictures are float32: what falls below its range warns, and does not just come out black."""
    scene = pylmc.load("keyhole", hole=0.3, alpha=0.2, width=8, height=8)
    lights = [pylmc.PointLight(scene.lights[0].position, intensity)]
    scene = pylmc.Scene(scene.camera, scene.shapes, lights, scene.portals)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        pylmc.render(scene, mutations_per_pixel=2000, max_depth=3, progress=False)
    told = [str(w.message) for w in caught if issubclass(w.category, PylmcWarning)]
    assert (not told) if said is None else any(said in text for text in told)
