"""Settings are described once: signatures, docstrings, the command line and docs/settings.md follow from them."""

import inspect
import runpy
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

import pylmc
from pylmc import PylmcError, Sampler
from pylmc.cli import arguments, commands
from pylmc.settings import CONSTRAINTS, Run, Settings

ROOT = Path(__file__).parents[2]
# a value other than the default, and how the command line spells it
OTHER: dict[str, tuple[Any, list[str]]] = {
    "max_depth": (3, ["3"]),
    "math": ("fast", ["fast"]),
    "aim": ("light", ["light"]),
    "chart": ("orthographic", ["orthographic"]),
    "coordinates": ("deviation", ["deviation"]),
    "rule": ("rms", ["rms"]),
    "drift": (True, []),
    "projection": ("orthographic", ["orthographic"]),
    "large_steps": (0.5, ["0.5"]),
    "light_steps": (0.3, ["0.3"]),
    "step_length": ((0.1, 0.2), ["0.1,0.2"]),
    "even": (False, []),
    "blocks": (False, []),
    "constraints": ((), ["none"]),
    "differentials": ("reduced", ["reduced"]),
    "chains": (100, ["100"]),
    "candidates": (1000, ["1000"]),
}


@pytest.mark.parametrize("name", Settings.names())
@pytest.mark.parametrize("command", ["render", "info"])
def test_every_setting_is_on_the_command_line(command: str, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    value, spelled = OTHER[name]
    no = "no-" if value is False else ""
    parser = arguments.build_parser(dict.fromkeys(("render", "info", "compare", "devices", "scenes"), int))
    options = parser.parse_args([command, "box", f"--{no}{arguments.flag(name)}", *spelled])
    assert arguments.given(options, Settings) == {name: value}
    assert arguments.given(parser.parse_args([command, "box"]), Settings) == {}, "the API knows the defaults"


def test_info_takes_every_setting(capsys: pytest.CaptureFixture[str]) -> None:
    assert commands.main(["info", "box", "--rule", "mean", "--math", "relaxed", "--no-even", "--max-depth", "3"]) == 0
    out = capsys.readouterr().out
    assert "rule 'mean'" in out and "1 to 3 segments" in out


def test_signatures_and_docstrings_show_the_settings() -> None:
    for function, kinds in ((pylmc.render, (Run, Settings)), (Sampler, (Settings,)), (pylmc.info, (Settings,))):
        parameters = inspect.signature(function).parameters
        text = inspect.getdoc(function) or ""
        for item in (item for kind in kinds for item in fields(kind)):
            assert parameters[item.name].default == item.default
            assert f"\n{item.name}: " in text, f"{function.__name__} does not explain {item.name}"


def test_values_become_plain_python() -> None:
    np = pytest.importorskip("numpy")
    settings = Settings(
        max_depth=np.int64(3), large_steps=np.float32(0.5), step_length=[0.1, 1], constraints=["normals", "lobes"]
    )
    assert type(settings.max_depth) is int and type(settings.large_steps) is float
    assert settings.step_length == (0.1, 1.0) and settings.constraints == ("lobes", "normals")


@pytest.mark.parametrize(
    ("wrong", "part"),
    [
        ({"max_dept": 3}, "did you mean 'max_depth'"),
        ({"large-steps": 0.5}, "did you mean 'large_steps'"),
        ({"zzz": 1}, "choose from max_depth"),
        ({"constraints": "lobes"}, "give a list of lobes"),
        ({"constraints": ["holes"]}, "holes"),
        ({"drift": "no"}, "True or False"),
        ({"step_length": (0.3, 0.01)}, r"step_length\[1\]"),
        ({"step_length": 0.3}, "two numbers"),
        ({"chains": 0}, "whole number from 1"),
        ({"max_depth": 33}, "whole number of segments from 1 to 32"),
        ({"large_steps": float("nan")}, "probability from 0 to 1"),
        ({"math": "wild"}, "exact, relaxed, fast, native"),
    ],
)
def test_what_is_refused(wrong: dict[str, Any], part: str) -> None:
    with pytest.raises(PylmcError, match=part):
        Settings.given(wrong)


def test_render_knows_its_own_names_too() -> None:
    with pytest.raises(PylmcError, match="did you mean 'seconds'"):
        pylmc.render(pylmc.load("box"), second=3)


def test_chains_start_as_the_settings_say() -> None:
    sampler = Sampler(pylmc.load("box"), max_depth=2, chains=100, candidates=1000)
    groups = sampler.init(seed=1)
    assert sum(group.chains for group in groups) == 100 and {group.weighed for group in groups} == {1000}
    groups = sampler.init(seed=1, chains=200, candidates=500)
    assert sum(group.chains for group in groups) == 200 and {group.weighed for group in groups} == {500}


def test_the_page_is_up_to_date() -> None:
    tool = runpy.run_path(str(ROOT / "tools" / "settings_page.py"))
    assert tool["PAGE"].read_text(encoding="utf-8") == tool["page"](), "run `python tools/settings_page.py`"


def test_every_word_is_explained() -> None:
    for item in (*fields(Settings), *fields(Run)):
        assert item.metadata["help"], item.name
    assert Settings().constraints == CONSTRAINTS
