"""A cache of kernels that cannot be written costs a warning and time."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import pylmc

TRACE = """
import pylmc
print(pylmc.RayTracer([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).any_hit([0.2, 0.2, 1], [0, 0, -1]))
"""


def run(folder: Path, *command: str, **changes: str) -> subprocess.CompletedProcess[str]:
    known = {name: value for name, value in os.environ.items() if name not in ("XDG_CACHE_HOME", "POCL_CACHE_DIR")}
    environ = {**known, "PYTHONPATH": str(Path(pylmc.__file__).parents[1]), "TMPDIR": str(folder), **changes}
    return subprocess.run(
        [sys.executable, *command], capture_output=True, text=True, cwd=folder, env=environ, timeout=120, check=False
    )


@pytest.mark.parametrize("variable", ["HOME", "XDG_CACHE_HOME", "POCL_CACHE_DIR"])
def test_a_folder_that_cannot_be_written(variable: str, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    done = run(tmp_path, "-c", TRACE, **{variable: str(tmp_path / "file" / "below")})
    assert done.returncode == 0 and done.stdout == "[ True]\n", done.stderr
    assert "PylmcWarning" in done.stderr and "file/below" in done.stderr and "cannot be written" in done.stderr
    assert not list(tmp_path.glob("pylmc-*")), "the folder in its place is gone"


def test_the_command_says_so_in_a_line(tmp_path: Path) -> None:
    done = run(tmp_path, "-m", "pylmc", "devices", HOME="/dev/null")
    assert done.returncode == 0 and "* 0" in done.stdout
    assert done.stderr.startswith("pylmc: warning: ") and done.stderr.count("\n") == 1


def test_subfolders_count(tmp_path: Path) -> None:
    """A folder of another user in one's own, as sudo leaves it; here a file, since root may write everywhere."""
    (tmp_path / "pytools").touch()
    done = run(tmp_path, "-c", "import pylmc.device.survey as s; s.usable(); s.select()", XDG_CACHE_HOME=str(tmp_path))
    assert done.returncode == 0 and "cannot be written" in done.stderr


def test_folders_that_can_be_written_stay(tmp_path: Path) -> None:
    code = "import os, pylmc; print(os.environ['XDG_CACHE_HOME'], os.environ['POCL_CACHE_DIR'], pylmc.caches.complaint())"
    folders = {"XDG_CACHE_HOME": str(tmp_path / "a"), "POCL_CACHE_DIR": str(tmp_path / "b")}
    done = run(tmp_path, "-c", code, **folders)
    assert done.stdout.split() == list(folders.values()), done.stderr
