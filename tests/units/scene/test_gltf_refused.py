"""glTF and GLB files that cannot be read, and what is said of them."""

import json

import numpy as np
import pytest
from studies.gltf_files import AUTO, Builder, first

from pylmc.errors import PylmcError
from pylmc.scene.loading import load


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize(
    ("attribute", "width", "named"), [("NORMAL", 3, "the normal"), ("TEXCOORD_0", 2, "the texture coordinates")]
)
def test_attributes_that_are_no_numbers_are_named(tmp_path, attribute, width, named, bad):
    values = np.ones((4, width))
    values[1, 0] = bad
    material = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}
    builder = Builder(materials=[material]).square(material=0, **{"TEXCOORD_0": np.zeros((4, 2)), attribute: values})
    with pytest.raises(PylmcError, match=rf"a\.glb: shape '.*/0': {named} of vertex 1"):
        first(builder.image(np.zeros((1, 1, 3))), tmp_path)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("transform", [{"rotation": float("nan")}, {"scale": [1e308, 1]}, {"offset": [float("inf"), 0]}])
def test_texture_transforms_that_lead_nowhere_are_named(tmp_path, transform):
    lookup = {"index": 0, "extensions": {"KHR_texture_transform": transform}}
    builder = Builder(materials=[{"pbrMetallicRoughness": {"baseColorTexture": lookup}}])
    builder.square(material=0, TEXCOORD_0=[[0, 0], [1, 0], [1, 1], [0, 1]]).image(np.zeros((1, 1, 3)))
    with pytest.raises(PylmcError, match=r"a\.glb: shape '.*/0': the texture coordinates of vertex"):
        first(builder, tmp_path)


def test_what_is_missing_is_named_with_its_remedy(tmp_path):
    path = Builder().square().glb(tmp_path / "bare.glb")
    with pytest.raises(PylmcError, match=r"bare\.glb.*--auto-camera"):
        load(path, auto_light=True)
    with pytest.raises(PylmcError, match=r"bare\.glb.*--auto-light"):
        load(path, auto_camera=True)
    lights = {"KHR_lights_punctual": {"lights": [{"type": "area"}]}}
    nodes = [{"mesh": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}}]
    with pytest.raises(PylmcError, match=r"lamp\.glb.*'area', not point, spot or directional"):
        load(Builder(nodes=nodes, extensions=lights).square().glb(tmp_path / "lamp.glb"), auto_camera=True)


ACCESSOR, VIEW, PRIMITIVE = ("accessors", 0), ("bufferViews", 0), ("meshes", 0, "primitives", 0)
SPOILT = [
    (("asset", "version"), "1.0"),
    (("asset",), 3),
    (("nodes",), {}),
    (("nodes", 0, "mesh"), 7),
    (("nodes", 0, "mesh"), "x"),
    (("nodes", 0, "children"), [0]),
    (("nodes", 0, "matrix"), [1, 2]),
    (("nodes", 0, "scale"), ["a", 1, 1]),
    (("nodes", 0, "translation"), [float("nan"), 0, 0]),
    (("scene",), 4),
    (("scenes", 0, "nodes"), []),
    ((*ACCESSOR, "count"), 10**6),
    ((*ACCESSOR, "count"), -1),
    ((*ACCESSOR, "type"), "VEC2"),
    ((*ACCESSOR, "type"), "VEC9"),
    ((*ACCESSOR, "componentType"), 1),
    ((*ACCESSOR, "bufferView"), 99),
    (ACCESSOR, None),
    ((*VIEW, "byteLength"), 10**6),
    ((*VIEW, "byteOffset"), -4),
    ((*VIEW, "byteStride"), 1),
    ((*VIEW, "buffer"), 1),
    ((*PRIMITIVE, "attributes"), {}),
    ((*PRIMITIVE, "attributes", "NORMAL"), 1),
    ((*PRIMITIVE, "indices"), 0),
    ((*PRIMITIVE, "material"), 3),
    (("meshes",), []),
    (("extensionsRequired",), ["KHR_draco_mesh_compression"]),
]


@pytest.mark.parametrize(("path", "value"), SPOILT)
def test_malformed_documents(tmp_path, path, value):
    builder = Builder().square()
    place = builder.document
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    with pytest.raises(PylmcError, match=r"a\.glb: ") as caught:
        load(builder.glb(tmp_path / "a.glb"), **AUTO)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("content", [b"", b"glTF", b"hello", b"\xff\xfe\x00", b"[1, 2]", b"{}", b'{"asset": {"ver'])
def test_files_that_are_not_gltf(tmp_path, content):
    (tmp_path / "a.gltf").write_bytes(content)
    with pytest.raises(PylmcError, match=r"a\.gltf: "):
        load(tmp_path / "a.gltf", **AUTO)


def test_every_truncation_is_noticed(tmp_path):
    builder = Builder(materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}])
    whole = builder.square(material=0).image(np.zeros((4, 4, 3))).glb(tmp_path / "a.glb").read_bytes()
    for size in range(0, len(whole), 37):
        (tmp_path / "cut.glb").write_bytes(whole[:size])
        with pytest.raises(PylmcError, match=r"cut\.glb: "):
            load(tmp_path / "cut.glb", **AUTO)


def test_missing_and_broken_neighbours(tmp_path):
    with pytest.raises(PylmcError, match=r"none\.glb: cannot be read"):
        load(tmp_path / "none.glb")
    with pytest.raises(PylmcError, match="is a folder"):
        load(tmp_path)
    builder = Builder().square()
    document = {**builder.document, "buffers": [{"byteLength": 1000, "uri": "data%20one.bin"}]}
    (tmp_path / "a.gltf").write_text(json.dumps(document))
    with pytest.raises(PylmcError, match=r"a\.gltf: its buffer 'data%20one\.bin' cannot be read"):
        load(tmp_path / "a.gltf", **AUTO)
    (tmp_path / "data one.bin").write_bytes(builder.binary[:20])
    with pytest.raises(PylmcError, match="20 of 1000 bytes"):
        load(tmp_path / "a.gltf", **AUTO)
    document["buffers"][0]["byteLength"] = len(builder.binary)
    (tmp_path / "a.gltf").write_text(json.dumps(document))
    (tmp_path / "data one.bin").write_bytes(builder.binary)
    assert len(load(tmp_path / "a.gltf", **AUTO).shapes) == 3

    builder = Builder(materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]).square(material=0)
    builder.image(np.zeros((4, 4, 3))).document["images"] = [{"bufferView": builder.view(b"no picture"), "name": "sky"}]
    with pytest.raises(PylmcError, match="texture 'sky' cannot be decoded"):
        load(builder.glb(tmp_path / "b.glb"), **AUTO)
