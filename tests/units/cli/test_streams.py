"""Closed and full outputs, and locales of few characters: one true line, and nothing is lost."""

import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

import pylmc
from pylmc.picture.image import read_exr

RENDER = "render box --size 16x16 --max-depth 2 --mutations-per-pixel 32 -o box.exr"
needs_full = pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")


def shell(command: str, folder: Path, **environ: str) -> subprocess.CompletedProcess[bytes]:
    """A shell's command line in ``folder``, in which `pylmc` is this one."""
    command = f'pylmc() {{ {shlex.quote(sys.executable)} -m pylmc "$@"; }}; {command}'
    environ = {**os.environ, "PYTHONPATH": str(Path(pylmc.__file__).parents[1]), **environ}
    return subprocess.run(["bash", "-c", command], capture_output=True, cwd=folder, env=environ, timeout=120, check=False)


def check_picture(folder: Path) -> None:
    assert read_exr(folder / "box.exr")[0].sum() > 0 and (folder / "box.png").stat().st_size > 0
    assert json.loads((folder / "box.json").read_text(encoding="utf-8"))["interrupted"] is False


@pytest.mark.parametrize("command", ["scenes", "info box", "--help", "--version"])
@pytest.mark.parametrize(("where", "why"), [(">&-", "closed"), pytest.param("> /dev/full", "No space left", marks=needs_full)])
def test_stdout_that_takes_nothing(command: str, where: str, why: str, tmp_path: Path) -> None:
    done = shell(f"pylmc {command} {where}", tmp_path)
    said = done.stderr.decode()
    assert done.returncode == 1 and said.startswith("pylmc: error: stdout") and why in said and said.count("\n") == 1


@pytest.mark.parametrize(
    ("where", "code"),
    [
        (">&-", 1),
        ("2>&-", 0),
        ("<&- >&- 2>&-", 1),
        pytest.param("2> /dev/full", 0, marks=needs_full),
    ],
)
def test_a_render_keeps_its_picture(where: str, code: int, tmp_path: Path) -> None:
    done = shell(f"pylmc {RENDER} {where}", tmp_path)
    assert done.returncode == code
    check_picture(tmp_path)
    assert (b"cannot be written" in done.stderr) == (code == 1 and "2>" not in where)
    assert (b"wrote box.exr" in done.stdout) == (code == 0)


def test_errors_are_silent_where_nobody_listens(tmp_path: Path) -> None:
    assert shell("pylmc info nowhere 2>&-", tmp_path).returncode == 2
    assert shell("pylmc info nowhere >&- 2>&-", tmp_path).returncode == 2


def test_a_reader_that_leaves(tmp_path: Path) -> None:
    done = shell("{ sleep 1; pylmc scenes; } | true; exit ${PIPESTATUS[0]}", tmp_path)
    assert done.returncode == 1 and done.stderr == b""


def test_a_locale_of_few_characters(tmp_path: Path) -> None:
    """A file's name and the names in it are UTF-8, whatever the locale's encoding."""
    folder = tmp_path / "Bücher"
    folder.mkdir()
    (folder / "müsli.bin").write_bytes(bytes(36) + bytes([0, 0, 1, 0, 2, 0]))
    scene = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": 42, "uri": "m%C3%BCsli.bin"}, {"byteLength": 42, "uri": "müsli.bin"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 1, "byteOffset": 36, "byteLength": 6}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "nodes": [{"mesh": 0}],
    }
    positions = b"".join(value.to_bytes(4, "little") for value in (0, 0, 0, 0x3F800000, 0, 0, 0, 0x3F800000, 0))
    (folder / "müsli.bin").write_bytes(positions + bytes([0, 0, 1, 0, 2, 0]))
    (folder / "näh.gltf").write_text(json.dumps(scene, ensure_ascii=False), encoding="utf-8")
    plain = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    command = RENDER.replace("box", "näh.gltf --auto-camera --auto-light", 1).replace("box.exr", "näh.exr")
    done = shell(f"pylmc {command}", folder, **plain)
    assert done.returncode == 0, done.stderr
    assert {"näh.exr", "näh.png", "näh.json"} <= {path.name for path in folder.iterdir()}
    done = shell("pylmc compare näh.exr näh.exr -o differenz_ä.png", folder, **plain)
    assert done.returncode == 0 and (folder / "differenz_ä.png").exists(), done.stderr
