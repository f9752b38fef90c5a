"""Files and scenes that would keep an importer busy for ever, or deeper than Python goes, answer at once."""

import json
import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pylmc
from pylmc import Camera, Diffuse, PylmcError, Shape
from pylmc.scene import framing

ALL = {"auto_camera": True, "auto_light": True}


@pytest.fixture(autouse=True)
def at_once() -> Iterator[None]:
    start = time.perf_counter()
    yield
    assert time.perf_counter() - start < 10


def written(path: Path, **document: Any) -> Path:
    triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4").tobytes().hex()
    (path.parent / "data.bin").write_bytes(bytes.fromhex(triangle))
    whole = {
        "asset": {"version": "2.0"},
        "buffers": [{"uri": "data.bin", "byteLength": 36}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
        **document,
    }
    path.write_text(json.dumps(whole), encoding="utf-8")
    return path


NODES = {
    "doubling": [{"mesh": 0}, *({"children": [i, i]} for i in range(40))],
    "two parents": [{"mesh": 0}, {"children": [0]}, {"children": [0]}, {"children": [1, 2]}],
    "ring": [{"mesh": 0, "children": [1]}, {"children": [0]}],
    "itself": [{"mesh": 0, "children": [0]}],
}


@pytest.mark.parametrize("name", NODES)
def test_nodes_that_are_no_tree(name: str, tmp_path: Path) -> None:
    nodes = NODES[name]
    path = written(tmp_path / "a.gltf", nodes=nodes, scenes=[{"nodes": [len(nodes) - 1]}])
    with pytest.raises(PylmcError, match=r"a\.gltf: node \d+ is listed twice"):
        pylmc.load(path, **ALL)


def test_roots_listed_twice(tmp_path: Path) -> None:
    with pytest.raises(PylmcError, match="node 0 is listed twice"):
        pylmc.load(written(tmp_path / "a.gltf", scenes=[{"nodes": [0, 0]}]), **ALL)


def test_a_long_chain_of_nodes_is_read(tmp_path: Path) -> None:
    depth = 20000
    nodes = [*({"children": [i + 1], "translation": [1, 0, 0]} for i in range(depth)), {"mesh": 0}]
    scene = pylmc.load(written(tmp_path / "a.gltf", nodes=nodes), **ALL)
    np.testing.assert_allclose(scene.shapes[0].mesh.vertices[0], [depth, 0, 0])


def test_parents_come_before_children_in_the_order_of_the_file(tmp_path: Path) -> None:
    nodes = [
        {"mesh": 0, "name": "a", "children": [2, 1]},
        {"mesh": 0, "name": "d"},
        {"mesh": 0, "name": "b", "children": [3]},
        {"mesh": 0, "name": "c"},
    ]
    scene = pylmc.load(written(tmp_path / "a.gltf", nodes=nodes), **ALL)
    assert [shape.name for shape in scene.shapes[:4]] == ["a/0", "b/0", "c/0", "d/0"]


def test_json_nested_without_end(tmp_path: Path) -> None:
    path = tmp_path / "a.gltf"
    path.write_text('{"asset": ' + "[" * 200000 + "]" * 200000 + "}")
    with pytest.raises(PylmcError, match="nested too deeply"):
        pylmc.load(path)


def test_pipes_and_devices_are_no_files(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.gltf")
    with pytest.raises(PylmcError, match="not a file"):
        pylmc.load(tmp_path / "pipe.gltf")
    path = written(tmp_path / "a.gltf", buffers=[{"uri": "/dev/zero", "byteLength": 36}])
    with pytest.raises(PylmcError, match=r"its buffer '/dev/zero' cannot be read \(it is a pipe or a device"):
        pylmc.load(path, **ALL)


def test_a_camera_without_room_for_a_light_behind_it() -> None:
    """On a surface, where the way to what is behind is lost in rounding, a light has no place that is not seen."""
    rng = np.random.default_rng(0)
    corners = rng.uniform(-1, 1, (3, 3)) + np.array([0, 0, 1])
    box = Shape(([[-3, -3, -3], [3, 3, 4], [3, -3, 4]], [[0, 1, 2]]), Diffuse())
    camera = Camera(rng.dirichlet([1, 1, 1]) @ corners, (0.1, 0.2, -2))
    with pytest.raises(PylmcError, match="no room behind it"):
        framing.light_quads([Shape((corners, [[0, 1, 2]]), Diffuse()), box], camera)
