"""Files that are replaced appear whole, together, or not at all."""

import os
from pathlib import Path

import numpy as np
import pytest

from pylmc import PylmcError, Render
from pylmc.picture import image
from pylmc.picture.replacement import Replacement

NAMES = ("a.exr", "a.png", "a.json")
DIAGNOSTICS = {"seed": 1, "configuration": {}, "device": "none", "versions": {}}


def picture(value: float = 0.5) -> Render:
    return Render(np.full((4, 4, 3), value, np.float32), DIAGNOSTICS)


def test_all_or_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    picture(0.5).save(tmp_path / "a.exr")
    before = {name: (tmp_path / name).read_bytes() for name in NAMES}

    def fail(*_: object) -> None:
        raise PylmcError("a.png: cannot be written (disk full)")

    with monkeypatch.context() as patched:
        patched.setattr(image, "write_png", fail)
        with pytest.raises(PylmcError, match="disk full"):
            picture(0.7).save(tmp_path / "a.exr")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
    picture(0.7).save(tmp_path / "a.exr")
    assert (tmp_path / "a.exr").read_bytes() != before["a.exr"] and len(list(tmp_path.iterdir())) == 3


def test_links_and_permissions_stay(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    real, link = tmp_path / "real" / "b.png", tmp_path / "a.png"
    real.write_bytes(b"")
    real.chmod(0o604)
    link.symlink_to(real)
    image.write_png(link, np.zeros((2, 2, 3), np.uint8))
    assert link.is_symlink() and real.stat().st_size > 0 and real.stat().st_mode & 0o777 == 0o604


def test_what_is_no_plain_file_is_written_directly(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with Replacement() as files:
        assert files.path_for(tmp_path / "pipe") == tmp_path / "pipe"
    assert [path.name for path in tmp_path.iterdir()] == ["pipe"]


def test_a_place_that_is_lost_meanwhile(tmp_path: Path) -> None:
    with pytest.raises(PylmcError, match=r"a\.txt: cannot be replaced"), Replacement() as files:
        files.path_for(tmp_path / "a.txt").write_text("text", encoding="utf-8")
        (tmp_path / "a.txt").mkdir()
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]
