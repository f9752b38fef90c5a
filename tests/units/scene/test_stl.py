"""STL files are read, and what is wrong with them is said."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

import pylmc
from pylmc import PylmcError


@pytest.mark.parametrize("kind", ["stl", "stl_ascii"])
def test_both_forms_hold_the_same_triangles(kind: str, tmp_path: Path) -> None:
    box = trimesh.creation.box((1, 2, 3))
    path = tmp_path / "Box.STL"
    path.write_bytes(box.export(file_type=kind).encode() if kind == "stl_ascii" else box.export(file_type=kind))
    scene = pylmc.load(path, auto_camera=True, auto_light=True)
    shape = scene.shapes[0]
    assert shape.name == "Box" and not shape.smooth and len(shape.faces) == 12
    np.testing.assert_allclose(np.ptp(shape.vertices, axis=0), (1, 2, 3), atol=1e-6)


def test_a_file_needs_a_camera_and_a_light(tmp_path: Path) -> None:
    path = tmp_path / "box.stl"
    trimesh.creation.box((1, 1, 1)).export(path)
    with pytest.raises(PylmcError, match=r"box\.stl.*--auto-camera"):
        pylmc.load(path, auto_light=True)
    with pytest.raises(PylmcError, match=r"box\.stl.*--auto-light"):
        pylmc.load(path, auto_camera=True)


@pytest.mark.parametrize(
    "content", [b"", b"solid nothing\nendsolid nothing\n", b"\0" * 84, b"\0" * 80 + b"\x09\0\0\0" + b"\0" * 20]
)
def test_files_that_hold_no_mesh_are_named(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "spoilt.stl"
    path.write_bytes(content)
    with pytest.raises(PylmcError, match=r"spoilt\.stl: (malformed STL|no triangles)"):
        pylmc.load(path, auto_camera=True, auto_light=True)


def test_names_in_any_encoding_and_bytes_after_the_end_do_no_harm(tmp_path: Path) -> None:
    box = trimesh.creation.box((1, 2, 3))
    text = box.export(file_type="stl_ascii").encode()
    for content in (text.replace(b"solid", b"solid \xfc", 1), box.export(file_type="stl") + b"xx"):
        path = tmp_path / "box.stl"
        path.write_bytes(content)
        assert len(pylmc.load(path, auto_camera=True, auto_light=True).shapes[0].faces) == 12


def test_a_text_file_that_is_cut_off_is_named(tmp_path: Path) -> None:
    path = tmp_path / "cut.stl"
    path.write_bytes(trimesh.creation.box((1, 2, 3)).export(file_type="stl_ascii").encode()[:600])
    with pytest.raises(PylmcError, match=r"cut\.stl: malformed STL"):
        pylmc.load(path, auto_camera=True, auto_light=True)
