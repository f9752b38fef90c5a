"""Scenes by name and file: parameters, the film's size, and what is refused."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import trimesh

import pylmc
from pylmc import PylmcError
from pylmc.sampling.compiled import compile_scene
from pylmc.scene import Diffuse, PointLight, Scene, Shape, builtin
from pylmc.scene.importers import Content, Importer, importers


@pytest.mark.parametrize("name", builtin.NAMES)
def test_built_in_scenes(name: str) -> None:
    scene = pylmc.load(name)
    assert (scene.camera.width, scene.camera.height) == (256, 256)
    assert builtin.summary(name).endswith(".")
    for key, (default, parameter) in builtin.parameters(name).items():
        assert parameter.help, "whoever asks for the scenes is told what this is"
        for value in (default / 2, parameter.greatest):
            assert isinstance(pylmc.load(name, **{key: value}), pylmc.Scene), key
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
    with pytest.raises(PylmcError, match=r"unknown kind of scene file '\.obj'; pylmc reads \.glb, \.gltf"):
        pylmc.load(other)
    folder = tmp_path / "folder.glb"
    folder.mkdir()
    with pytest.raises(PylmcError, match=r"folder\.glb: is a folder"):
        pylmc.load(folder)


SQUARE = ([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]])


@pytest.fixture
def text_importer() -> Iterator[None]:
    """A format of the test's own, registered as long as the test runs: each line of the file names a square."""
    before = Importer.kinds

    class Text(Importer):
        suffixes = (".squares",)

        def read(self, path: Path) -> Content:
            names = path.read_text(encoding="utf-8").split()
            if "no" in names:
                raise PylmcError("holds no squares; write yes")
            return Content([Shape(SQUARE, Diffuse(0.5), name=name) for name in names], [PointLight((0, 0, 2), 1)])

    yield
    Importer.kinds = before


@pytest.mark.usefixtures("text_importer")
def test_an_importer_is_known_by_being_defined(tmp_path: Path) -> None:
    path = tmp_path / "a.SQUARES"
    path.write_text("left right", encoding="utf-8")
    scene = pylmc.load(path, auto_camera=True, width=20)
    assert isinstance(scene, Scene) and [shape.name for shape in scene.shapes] == ["left", "right"]
    assert (scene.camera.width, scene.camera.height) == (20, 256)
    with pytest.raises(PylmcError, match=r"a\.SQUARES: has no perspective camera; .*--auto-camera"):
        pylmc.load(path)
    path.write_text("no", encoding="utf-8")
    with pytest.raises(PylmcError, match=r"a\.SQUARES: holds no squares"):
        pylmc.load(path)
    with pytest.raises(PylmcError, match=r"gone\.squares: cannot be read \(No such file"):
        pylmc.load(tmp_path / "gone.squares")
    (tmp_path / "b.obj").write_text("", encoding="utf-8")
    with pytest.raises(PylmcError, match=r"pylmc reads \.glb, \.gltf, \.squares"):
        pylmc.load(tmp_path / "b.obj")


def test_every_suffix_has_one_importer() -> None:
    suffixes = [suffix for kind in Importer.kinds for suffix in kind.suffixes]
    assert sorted(suffixes) == sorted(importers()) and all(suffix == suffix.lower() for suffix in suffixes)
