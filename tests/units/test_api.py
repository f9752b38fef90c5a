"""The API as its users meet it: names, render, save, Sampler, RayTracer."""

import inspect
import json
import subprocess
import sys
import textwrap
import typing
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pylmc
from pylmc import Camera, Diffuse, PointLight, PylmcError, RayTracer, RoughConductor, Sampler, Scene, Shape
from pylmc.picture.image import read_exr

SQUARE = ([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])


def plate(width: int = 12, height: int = 8, **changes: Any) -> Scene:
    """A diffuse square, a point light in front of it, and the camera."""
    camera = Camera((0.5, 0.5, 2), (0.5, 0.5, 0), fov=15, width=width, height=height)
    parts = {"camera": camera, "shapes": [Shape(SQUARE, Diffuse(0.5))], "lights": [PointLight((0.3, 0.6, 1), 2.0)]}
    return Scene(**{**parts, **changes})


def quick(scene: Scene, **keywords: Any) -> pylmc.Render:
    return pylmc.render(scene, **{"mutations_per_pixel": 64, "max_depth": 2, "progress": False, **keywords})


# --- names ------------------------------------------------------------------------------------------------------------


def test_every_name_is_there_and_is_no_module() -> None:
    for name in pylmc.__all__:
        assert not inspect.ismodule(getattr(pylmc, name)), f"pylmc.{name} is hidden by a module of that name"
    assert set(pylmc.__all__) <= set(dir(pylmc))
    assert pylmc.__version__.count(".") >= 1
    with pytest.raises(AttributeError, match="no attribute 'rendr'"):
        pylmc.rendr  # noqa: B018


def functions_of(name: str) -> Iterator[Callable[..., Any]]:
    """An exported function, or an exported class' public methods and properties."""
    thing = getattr(pylmc, name)
    if inspect.isfunction(thing):
        yield thing
        return
    for attribute, value in vars(thing).items():
        function = getattr(value, "fget", None) or getattr(value, "__func__", value)
        if not attribute.startswith("_") and inspect.isfunction(function):
            yield function


def classes_in(hint: Any) -> Iterator[type]:
    """The classes that a type hint names."""
    if isinstance(hint, type):
        yield hint
    for part in typing.get_args(hint):
        yield from classes_in(part)


@pytest.mark.parametrize("name", pylmc.__all__)
def test_every_name_is_explained(name: str) -> None:
    said = getattr(pylmc, name).__doc__
    assert said and not said.startswith(f"{name}("), "a dataclass without a docstring gets one of its fields"
    page = (Path(__file__).parents[2] / "docs" / "api.md").read_text(encoding="utf-8")
    assert f"`{name}`" in page, f"docs/api.md does not say what {name} is"


@pytest.mark.parametrize("name", pylmc.__all__)
def test_what_is_returned_is_exported(name: str) -> None:
    for function in functions_of(name):
        assert function.__doc__, f"{function.__qualname__} has no docstring"
        for kind in classes_in(typing.get_type_hints(function)["return"]):
            ours = kind.__module__.split(".")[0] == "pylmc"
            assert not ours or kind.__name__ in pylmc.__all__, f"{function.__qualname__} returns a {kind.__name__}"


def run_python(code: str, **more: Any) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", textwrap.dedent(code)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False, **more)


def test_importing_costs_next_to_nothing() -> None:
    done = run_python("""
        import sys, pylmc, pylmc.cli
        heavy = {"numpy", "pyopencl", "trimesh", "scipy", "OpenImageIO", "tqdm"} & set(sys.modules)
        assert not heavy, heavy
    """)
    assert done.returncode == 0, done.stderr


def test_functions_stay_functions_whatever_is_imported_first() -> None:
    done = run_python("""
        import importlib, pkgutil, types
        import pylmc
        from pylmc import *
        for module in pkgutil.walk_packages(pylmc.__path__, "pylmc."):
            if not module.name.endswith((".device.probe", ".__main__")):
                importlib.import_module(module.name)
        import pylmc
        from pylmc import render, info, load
        for name in pylmc.__all__:
            assert not isinstance(getattr(pylmc, name), types.ModuleType), name
        assert render is pylmc.render and info is pylmc.info and load is pylmc.load
    """)
    assert done.returncode == 0, done.stderr


# --- render -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("integrator", ["lmc", "bdpt", "path"])
def test_direct_light_is_what_it_must_be(integrator: str) -> None:
    picture = quick(plate(), integrator=integrator, mutations_per_pixel=400, seed=3)
    assert picture.image.shape == (8, 12, 3) and picture.image.dtype == np.float32
    # radiance reflectance / pi * intensity cos / r^2 at the plane's points behind the pixels' middles
    tangent = np.tan(np.radians(7.5))
    y, x = np.mgrid[:8, :12] + 0.5
    point = np.stack([0.5 + 2 * (2 * x / 12 - 1) * tangent * 12 / 8, 0.5 + 2 * (1 - 2 * y / 8) * tangent], axis=-1)
    r2 = ((point - [0.3, 0.6]) ** 2).sum(axis=-1) + 1
    expected = 0.5 / np.pi * 2.0 / r2**1.5
    np.testing.assert_allclose(picture.image.mean(axis=2).mean(), expected.mean(), rtol=0.02)
    assert abs(picture.image.mean(axis=2) / expected - 1).mean() < 0.15


@pytest.mark.parametrize(("integrator", "unit"), [("lmc", "mutations"), ("bdpt", "samples"), ("path", "samples")])
def test_diagnostics(integrator: str, unit: str) -> None:
    d = quick(plate(), integrator=integrator, seed=5).diagnostics
    assert d["integrator"] == d["configuration"]["integrator"] == integrator
    assert d["seed"] == 5 and d["size"] == [12, 8] and d["interrupted"] is False and d["device"]
    assert {"build", "compile", "bootstrap", "run"} <= set(d["seconds"])
    assert {"pylmc", "python", "numpy", "pyopencl"} <= set(d["versions"])
    assert d[unit] > 0 and d[f"{unit}_per_second"] > 0 and d["rays"] > 0 and d["rays_per_second"] > 0
    assert d["configuration"]["max_depth"] == 2 and d["configuration"]["precision"] == "single"
    if integrator != "path":
        assert all(group["b"] > 0 and group["b_error"] >= 0 for group in d["groups"].values())
    if integrator == "lmc":
        assert 0 < d["acceptance"] <= 1 and d["ess"] >= 0 and d["not_finite_rejected"] == 0
        (group,) = d["groups"].values()
        assert group["chains"] > 0 and "large" in group["acceptance"] and group["b"] == pytest.approx(d["b"])


def test_same_seed_same_picture() -> None:
    first, again, other = (quick(plate(), seed=seed).image for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, other)


def test_film_size_and_position_of_a_pixel() -> None:
    """Rows count from the top, columns from the left: a light at the upper left lights the upper left."""
    picture = quick(plate(20, 6, lights=[PointLight((0.2, 0.65, 0.1))]), mutations_per_pixel=256)
    assert picture.image.shape == (6, 20, 3)
    row, column = np.unravel_index(picture.image.sum(axis=2).argmax(), (6, 20))
    assert row < 3 and column < 10


def test_without_budget_or_with_two(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pylmc.rendering.DEFAULT_SECONDS", 0.1)
    assert pylmc.render(plate(), max_depth=2, progress=False).diagnostics["mutations"] > 0
    with pytest.raises(PylmcError, match="not both"):
        pylmc.render(plate(), seconds=1, mutations_per_pixel=1)


REFUSED = {
    "integrator": ({"integrator": "pt"}, "integrator"),
    "precision": ({"precision": "half"}, "half"),
    "seconds": ({"mutations_per_pixel": None, "seconds": float("nan")}, "seconds"),
    "mutations": ({"mutations_per_pixel": -1}, "mutations_per_pixel"),
    "seed": ({"seed": -1}, "seed"),
    "depth": ({"max_depth": 0}, "max_depth"),
    "chart": ({"chart": "polar"}, "chart"),
    "rule": ({"rule": "max"}, "rule"),
    "coordinates": ({"coordinates": "polar"}, "coordinates"),
    "setting": ({"stepp": 1}, "stepp"),
    "device": ({"device": "abacus"}, "abacus"),
    "point light": ({"max_depth": 1}, "max_depth"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_bad_arguments(name: str) -> None:
    keywords, part = REFUSED[name]
    with pytest.raises(PylmcError, match=part):
        quick(plate(), **keywords)


def test_a_scene_in_which_no_path_is_found_says_how_many_were_tried() -> None:
    away = Camera((0.5, 0.5, 2), (0.5, 0.5, 4), width=8, height=8)
    with pytest.raises(PylmcError, match=r"no light path was found in \d+ tries"):
        quick(plate(camera=away))


# --- save -------------------------------------------------------------------------------------------------------------


def test_save(tmp_path: Path) -> None:
    picture = quick(plate(), seed=9)
    target = tmp_path / "näw folder" / "a picture.exr"
    written = picture.save(target)
    assert written == [target, target.with_suffix(".png"), target.with_suffix(".json")]
    pixels, metadata = read_exr(target)
    np.testing.assert_array_equal(pixels, picture.image)
    assert metadata["seed"] == "9" and json.loads(metadata["configuration"])["max_depth"] == 2
    assert {"device", "normalisation", "versions"} <= set(metadata)

    def refuse(constant: str) -> None:
        raise AssertionError(f"{constant} is not JSON")

    assert json.loads(written[2].read_text(encoding="utf-8"), parse_constant=refuse) == json.loads(
        json.dumps(picture.diagnostics)
    )
    for name in ("picture.png", "picture"):
        with pytest.raises(PylmcError, match="exr"):
            picture.save(tmp_path / name)
    (tmp_path / "file").write_text("")
    with pytest.raises(PylmcError, match="folder"):
        picture.save(tmp_path / "file" / "a.exr")


# --- Sampler and RayTracer --------------------------------------------------------------------------------------------


def test_sampler() -> None:
    floor = Shape(([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]], SQUARE[1]), RoughConductor(0.2, 0.9), name="mirror")
    sampler = Sampler(plate(shapes=[Shape(SQUARE, Diffuse(0.5)), floor]), max_depth=3)
    groups = sampler.init(seed=1, chains=64, candidates=1 << 12)
    assert [group.name for group in groups] == ["2 connect", "3 connect"]
    assert all(group.b > 0 and group.b_error < group.b for group in groups)
    before = sampler.states()
    chains = len(before.length)
    assert chains == sampler.chains == sum(group.chains for group in groups)
    assert set(np.unique(before.length)) == {2, 3} and np.all(before.ending == 0)
    np.testing.assert_allclose(np.linalg.norm(before.v_1, axis=1), 1, atol=1e-6)
    assert np.all(np.isfinite(before.log_pi))
    # the last node of each path is the light, and directions lead from node to node
    last = before.nodes[np.arange(chains), before.length - 1]
    np.testing.assert_allclose(last, np.tile([0.3, 0.6, 1.0], (chains, 1)), atol=1e-5)
    step = before.nodes[:, 1] - before.nodes[:, 0]
    np.testing.assert_allclose(step / np.linalg.norm(step, axis=1)[:, None], before.directions[:, 1], atol=1e-4)
    sampler.step(20)
    after = sampler.states()
    np.testing.assert_array_equal(after.length, before.length)
    assert np.mean(np.any(after.v_1 != before.v_1, axis=1)) > 0.5
    counters = sampler.counters()
    assert counters.proposed.sum() == 20 * chains and np.all(counters.acceptance <= counters.proposed)
    assert counters.not_finite == 0 and counters.rays > 0
    assert sampler.image().shape == (8, 12, 3) and sampler.image().sum() > 0


def test_raytracer() -> None:
    tracer = RayTracer(*SQUARE)
    origins = [[0.25, 0.5, 2], [0.25, 0.5, 2], [3, 0.5, 2]]
    directions = [[0, 0, -1], [0, 0, 1], [0, 0, -1]]
    t, triangle, u, v = tracer.closest_hit(origins, directions, np.inf)
    assert t[0] == pytest.approx(2) and triangle[0] in (0, 1) and u[0] >= 0 and v[0] >= 0
    assert triangle[1] == triangle[2] == -1
    np.testing.assert_array_equal(tracer.any_hit(origins, directions, 3.0).astype(bool), [True, False, False])
    assert not tracer.any_hit(origins[:1], directions[:1], 1.0).astype(bool)[0]
    with pytest.raises(PylmcError, match="NaN"):
        tracer.closest_hit([[np.nan, 0, 0]], [[0, 0, 1]], 1.0)
