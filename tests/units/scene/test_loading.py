"""Scenes by name and file: parameters, the film's size, and what is refused."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

import pylmc
from pylmc import PylmcError
from pylmc.sampling.compiled import compile_scene
from pylmc.scene.loading import BUILT_IN, parameters


@pytest.mark.parametrize("name", BUILT_IN)
def test_built_in_scenes(name: str) -> None:
    scene = pylmc.load(name)
    assert (scene.camera.width, scene.camera.height) == (256, 256)
    for key, default in parameters(name).items():
        assert isinstance(pylmc.load(name, **{key: default / 2}), pylmc.Scene), key
        for bad in (0, -1, float("nan"), float("inf"), 1e9, "wide", [1], None):
            with pytest.raises(PylmcError, match=key):
                pylmc.load(name, **{key: bad})
    with pytest.raises(PylmcError, match="no parameter 'colour'"):
        pylmc.load(name, colour=1)


def test_parameters_reach_the_scene() -> None:
    (hole,) = compile_scene(pylmc.load("keyhole", hole=0.25)).portals
    np.testing.assert_allclose(hole.half_size, 0.125)
    alphas = [getattr(shape.material, "alpha", None) for shape in pylmc.load("keyhole", alpha=0.007).shapes]
    assert 0.007 in alphas


def test_film_size() -> None:
    scene = pylmc.load("box", width=40, height=30)
    assert (scene.camera.width, scene.camera.height) == (40, 30)
    assert pylmc.load("box", width=40).camera.height == 256
    for size in (0, -3, 2.5, 10**6):
        with pytest.raises(PylmcError, match="width"):
            pylmc.load("box", width=size)


@pytest.fixture
def bar(tmp_path: Path) -> Path:
    """A bar ten times as wide as high, as a file whose name is not plain."""
    path = tmp_path / "ein Träger.GLB"
    path.write_bytes(trimesh.Scene(trimesh.creation.box((10, 1, 1))).export(file_type="glb"))
    return path


def test_a_file_is_framed_for_the_film_that_is_asked_for(bar: Path) -> None:
    """A wide film lets the camera stand nearer to a wide thing, and everything is in the picture."""
    away = {}
    for width, height in ((400, 50), (50, 400)):
        scene = pylmc.load(bar, width=width, height=height, auto_camera=True, auto_light=True)
        camera = scene.camera
        assert (camera.width, camera.height) == (width, height)
        right, up, forward = camera.axes()
        local = np.asarray(scene.shapes[0].mesh.vertices) - camera.origin
        top = np.tan(np.radians(camera.fov) / 2) * (local @ forward)
        extent = max(abs(local @ up / top).max(), abs(local @ right / (top * width / height)).max())
        assert 0.8 < extent < 1
        away[width] = np.linalg.norm(camera.origin)
    assert away[400] < away[50] / 3


def test_files_refused(bar: Path, tmp_path: Path) -> None:
    with pytest.raises(PylmcError, match="--auto-camera"):
        pylmc.load(bar)
    with pytest.raises(PylmcError, match="--auto-light"):
        pylmc.load(bar, auto_camera=True)
    with pytest.raises(PylmcError, match="takes no parameters"):
        pylmc.load(bar, hole=1)
    with pytest.raises(PylmcError, match="width"):
        pylmc.load(bar, width=0, auto_camera=True, auto_light=True)
    with pytest.raises(PylmcError, match="neither a built-in one"):
        pylmc.load("nothing")
    with pytest.raises(PylmcError, match=r"gone\.glb"):
        pylmc.load(tmp_path / "gone.glb")
    other = tmp_path / "model.obj"
    other.write_text("v 0 0 0")
    with pytest.raises(PylmcError, match=r"unknown kind of scene file '\.obj'"):
        pylmc.load(other)
    folder = tmp_path / "folder.glb"
    folder.mkdir()
    with pytest.raises(PylmcError, match="folder"):
        pylmc.load(folder)
