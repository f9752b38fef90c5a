"""The command line: what it refuses, how, and what it hands to the API."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import pylmc
from pylmc import PylmcError
from pylmc.cli import commands

# Every complaint must be found before anything is rendered, so none of these may reach the API's render().
BAD = {
    "no command": ([], "COMMAND"),
    "unknown command": (["draw", "box"], "draw"),
    "unknown option": (["render", "box", "--fast"], "--fast"),
    "missing scene": (["render"], "SCENE"),
    "missing file": (["render", "nowhere/truck.glb"], "nowhere/truck.glb"),
    "unknown scene": (["render", "keyhol"], "keyhol"),
    "unknown parameter": (["render", "box:hole=1"], "hole"),
    "parameter of the API": (["render", "keyhole:auto_camera=1"], "auto_camera"),
    "parameter without value": (["render", "keyhole:hole"], "name=value"),
    "parameter given twice": (["render", "keyhole:hole=0.1,hole=0.2"], "twice"),
    "parameter not finite": (["render", "keyhole:hole=nan"], "finite"),
    "parameter out of range": (["render", "keyhole:hole=-1"], "hole"),
    "size without x": (["render", "box", "--size", "640"], "640"),
    "size of zero": (["render", "box", "--size", "0x480"], "0x480"),
    "size too large": (["render", "box", "--size", "99999x99999"], "99999"),
    "negative time": (["render", "box", "--seconds", "-1"], "positive"),
    "endless time": (["render", "box", "--seconds", "inf"], "positive"),
    "no effort": (["render", "box", "--mutations-per-pixel", "0"], "positive"),
    "time and effort": (["render", "box", "--seconds", "1", "--mutations-per-pixel", "1"], "not allowed with"),
    "depth of zero": (["render", "box", "--max-depth", "0"], "segments"),
    "seed too large": (["render", "box", "--seed", str(2**32)], "4294967295"),
    "no scene's name": (["render", ""], "no scene"),
    "film's size as a parameter": (["render", "box:width=64"], "width"),
    "negative seed": (["render", "box", "--seed", "-1"], "seed"),
    "unknown device": (["render", "box", "--device", "abacus"], "abacus"),
    "device out of range": (["render", "box", "--device", "99"], "99"),
    "unknown precision": (["render", "box", "--precision", "half"], "half"),
    "unknown integrator": (["render", "box", "--integrator", "pt"], "pt"),
    "chain option without chain": (["render", "box", "--integrator", "path", "--drift"], "--drift"),
    "chart without chain": (["render", "box", "--integrator", "bdpt", "--chart", "equal-area"], "--chart"),
    "aim without sampler": (["render", "box", "--integrator", "path", "--aim", "light"], "--aim"),
    "no constraint": (["info", "box", "--constraints", "lobes,holes"], "holes"),
    "half an interval": (["info", "box", "--step-length", "0.1"], "two numbers"),
    "not a probability": (["info", "box", "--large-steps", "2"], "probability"),
    "unknown arithmetic": (["info", "box", "--math", "wild"], "native"),
    "output of another kind": (["render", "box", "-o", "box.png"], ".exr"),
    "nothing to compare": (["compare", "a.exr", "b.exr"], "a.exr"),
    "info of nothing": (["info", "nowhere.gltf"], "nowhere.gltf"),
}


def refuses(arguments: list[str], part: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert commands.main(arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("pylmc: error: ") and err.count("\n") == 1 and err.endswith("\n")
    assert part in err


@pytest.fixture
def no_render(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def render(*_: Any, **__: Any) -> None:
        raise AssertionError("bad input reached the renderer")

    monkeypatch.setattr(pylmc, "render", render)
    monkeypatch.chdir(tmp_path)


@pytest.mark.usefixtures("no_render")
@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_one_line_and_exit_code_2(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    refuses(*BAD[name], capsys)


@pytest.mark.usefixtures("no_render")
def test_bad_output_is_found_before_rendering(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").write_text("")
    refuses(["render", "box", "-o", "file/box.exr"], "not a folder", capsys)
    (tmp_path / "folder.exr").mkdir()
    refuses(["render", "box", "-o", "folder.exr"], "is a folder", capsys)
    (tmp_path / "taken.json").mkdir()
    refuses(["render", "box", "-o", "taken.exr"], "taken.json", capsys)
    assert not (tmp_path / "new").exists()
    refuses(["render", "box", "-o", "new/box.exr", "--device", "abacus"], "abacus", capsys)
    assert not (tmp_path / "new").exists(), "a refused command must leave nothing behind"


@pytest.mark.usefixtures("no_render")
@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_unwritable_output(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    locked = tmp_path / "locked"
    locked.mkdir(mode=0o555)
    refuses(["render", "box", "-o", "locked/box.exr"], "locked", capsys)


@pytest.mark.usefixtures("no_render")
@pytest.mark.parametrize("content", [b"", b"glTF", b"not a scene", b'{"asset": {"version": "2.0"}}'])
@pytest.mark.parametrize("ending", [".gltf", ".glb", ".obj"])
def test_broken_files(content: bytes, ending: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / f"broken{ending}"
    path.write_bytes(content)
    refuses(["render", str(path), "--auto-camera", "--auto-light"], "broken", capsys)


def test_parse_scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert commands.parse_scene("keyhole") == ("keyhole", {})
    assert commands.parse_scene("keyhole:hole=0.01, depth=3,open=true,kind=a") == (
        "keyhole",
        {"hole": 0.01, "depth": 3, "open": True, "kind": "a"},
    )
    monkeypatch.chdir(tmp_path)
    (tmp_path / "box").mkdir()
    assert commands.parse_scene("box") == ("box", {}), "a folder of that name does not hide a built-in scene"
    file = tmp_path / "odd:name=1.glb"
    file.write_text("")
    assert commands.parse_scene(str(file)) == (str(file), {})
    with pytest.raises(PylmcError, match="folder"):
        commands.parse_scene(str(tmp_path))


class Picture:
    """Stands for a Render."""

    def __init__(self, **diagnostics: Any) -> None:
        self.diagnostics = diagnostics

    def save(self, path: Path) -> list[Path]:
        files = [Path(path).with_suffix(suffix) for suffix in (".exr", ".png", ".json")]
        for file in files:
            file.write_text("")
        return files


def run_render(monkeypatch: pytest.MonkeyPatch, arguments: list[str], **diagnostics: Any) -> tuple[int, Any, dict]:
    """The exit code, the scene and the keywords that the API's render() is given."""
    given: list[Any] = []

    def render(scene: Any, **keywords: Any) -> Picture:
        given.extend((scene, keywords))
        return Picture(**diagnostics)

    monkeypatch.setattr(pylmc, "render", render)
    code = commands.main(["render", *arguments])
    return code, given[0], given[1]


def test_render_hands_over_what_was_given(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    code, scene, keywords = run_render(
        monkeypatch,
        ["box", "--size", "40x30", "-o", "deep/er/a.exr", "--seed", "7", "--mutations-per-pixel", "3", "--rule", "rms"],
    )
    assert code == 0
    assert (scene.camera.width, scene.camera.height) == (40, 30)
    assert keywords == {
        "mutations_per_pixel": 3.0,
        "seed": 7,
        "progress": True,
        "rule": "rms",
    }
    out, err = capsys.readouterr()
    assert err == ""
    assert out.startswith("wrote ") and all(f"deep/er/a{end}" in out for end in (".exr", ".png", ".json"))
    assert (tmp_path / "deep/er/a.exr").exists()


def test_render_quietly_with_defaults(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    code, _, keywords = run_render(monkeypatch, ["box", "--quiet", "--drift"])
    assert code == 0 and keywords == {"drift": True, "progress": False}, "the API knows the other defaults"
    assert capsys.readouterr() == ("", "")
    assert (tmp_path / "box.exr").exists()


def test_interrupted_render_is_written(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    code, _, _ = run_render(monkeypatch, ["box"], interrupted=True)
    assert code == 130
    assert (tmp_path / "box.exr").exists()
    assert "so far" in capsys.readouterr().err


def test_interrupted_before_the_first_sample(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A black picture must not take the place of what may be a good one."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "box.exr").write_text("good")
    code, _, _ = run_render(monkeypatch, ["box"], interrupted=True, mutations=0)
    assert code == 130 and "nothing was written" in capsys.readouterr().err
    assert (tmp_path / "box.exr").read_text() == "good"


def test_interrupt_elsewhere(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def load(*_: Any, **__: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(pylmc, "load", load)
    assert commands.main(["info", "box"]) == 130
    assert capsys.readouterr().err.count("\n") == 1


def test_failure_to_write_is_explained(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def save(self: Picture, path: Path) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Picture, "save", save)
    code, _, _ = run_render(monkeypatch, ["box", "-o", "/tmp/box.exr"])
    assert code == 2
    assert "No space left on device" in capsys.readouterr().err


def test_scenes_lists_every_built_in_scene(capsys: pytest.CaptureFixture[str]) -> None:
    assert commands.main(["scenes"]) == 0
    out = capsys.readouterr().out
    for name in ("box", "caustic", "glints", "keyhole"):
        assert any(line.split(":")[0] == name for line in out.splitlines())
    assert "hole=" in out and "alpha=" in out
    assert "alpha: GGX roughness of the plate (greater than 0, at most 1)" in out and ".glb, .gltf" in out


def test_devices_lists_the_default(capsys: pytest.CaptureFixture[str]) -> None:
    assert commands.main(["devices"]) == 0
    out = capsys.readouterr().out
    assert out.count("\n* ") + out.startswith("* ") == 1


def test_the_program_itself(tmp_path: Path) -> None:
    def run(*arguments: str, **more: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "pylmc", *arguments]
        environ = {**os.environ, "PYTHONPATH": str(Path(pylmc.__file__).parents[1]), **more}
        return subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=environ, timeout=120, check=False)

    helped = run("--help")
    assert helped.returncode == 0 and "examples:" in helped.stdout
    for command in ("render", "info", "compare", "devices", "scenes"):
        assert command in helped.stdout
    assert "seconds" in run("render", "--help").stdout
    assert run("--version").stdout.startswith("pylmc ")
    odd = run("render", "näh.glb", PYTHONIOENCODING="ascii")
    assert odd.returncode == 2 and r"n\xe4h.glb" in odd.stderr, "a terminal of few characters is no reason to fail"
    failed = run("render", "nowhere.glb")
    assert failed.returncode == 2 and failed.stderr.count("\n") == 1 and "Traceback" not in failed.stderr
