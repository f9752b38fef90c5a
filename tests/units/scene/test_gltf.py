"""glTF and GLB files as scenes."""

import base64
import io
import json
import struct
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from pylmc.errors import PylmcError
from pylmc.scene import Texture
from pylmc.scene.framing import _unseen
from pylmc.scene.loading import load

SHARED = Path(__file__).resolve().parents[3].parent / "shared" / "scenes" / "gltf"
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
AUTO = {"auto_camera": True, "auto_light": True}
TYPES = {"f": 5126, "H": 5123, "B": 5121, "h": 5122}


class Builder:
    """Puts a glTF document together, arrays in one buffer."""

    def __init__(self, **document):
        self.binary = b""
        self.document = {
            "asset": {"version": "2.0"},
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "accessors": [],
            "bufferViews": [],
            **document,
        }

    def view(self, content, **more):
        self.binary += b"\0" * (-len(self.binary) % 4)
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(content), **more}
        self.document["bufferViews"].append(view)
        self.binary += content
        return len(self.document["bufferViews"]) - 1

    def array(self, values, **more):
        values = np.asarray(values)
        accessor = {
            "bufferView": self.view(values.tobytes()),
            "componentType": TYPES[values.dtype.char],
            "count": len(values),
            "type": "SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}",
            **more,
        }
        self.document["accessors"].append(accessor)
        return len(self.document["accessors"]) - 1

    def square(self, indexed=True, material=None, **attributes):
        positions = SQUARE if indexed else SQUARE[[0, 1, 2, 0, 2, 3]]
        primitive = {"attributes": {"POSITION": self.array(positions)}}
        for name, values in attributes.items():
            primitive["attributes"][name] = self.array(np.asarray(values, np.float32))
        if indexed:
            primitive["indices"] = self.array(np.array([0, 1, 2, 0, 2, 3], np.uint16))
        if material is not None:
            primitive["material"] = material
        self.document.setdefault("meshes", []).append({"primitives": [primitive]})
        return self

    def image(self, pixels):
        """An embedded PNG as texture 0."""
        stream = io.BytesIO()
        Image.fromarray(np.asarray(pixels, np.uint8)).save(stream, "PNG")
        self.document["images"] = [{"bufferView": self.view(stream.getvalue()), "mimeType": "image/png"}]
        self.document["textures"] = [{"source": 0}]
        return self

    def gltf(self, path):
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.binary).decode()
        document = {**self.document, "buffers": [{"byteLength": len(self.binary), "uri": uri}]}
        path.write_text(json.dumps(document))
        return path

    def glb(self, path):
        binary = self.binary + b"\0" * (-len(self.binary) % 4)
        text = json.dumps({**self.document, "buffers": [{"byteLength": len(binary)}]}).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
        return path


def first(builder, tmp_path, **options):
    return load(builder.glb(tmp_path / "a.glb"), **(options or AUTO)).shapes[0]


def area_vector(shape):
    corners = np.asarray(shape.mesh.vertices)[shape.mesh.faces]
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).sum(axis=0) / 2


@pytest.mark.parametrize("indexed", [True, False])
@pytest.mark.parametrize("kind", ["gltf", "glb"])
def test_containers_and_indexing(tmp_path, kind, indexed):
    builder = Builder().square(indexed)
    scene = load(getattr(builder, kind)(tmp_path / f"a.{kind}"), **AUTO, width=64, height=32)
    assert (scene.camera.width, scene.camera.height) == (64, 32)
    shape, *lights = scene.shapes
    np.testing.assert_allclose(area_vector(shape), [0, 0, 1])
    assert shape.vertex_normals() is None  # none authored: faceted
    assert len(lights) == 2


def test_strips_fans_and_lines(tmp_path):
    builder = Builder()
    quad = builder.array(SQUARE[[0, 1, 3, 2]]), builder.array(SQUARE)
    builder.document["meshes"] = [
        {
            "primitives": [
                {"attributes": {"POSITION": quad[0]}, "mode": 5},
                {"attributes": {"POSITION": quad[1]}, "mode": 6},
                {"attributes": {"POSITION": quad[1]}, "mode": 1},
            ]
        }
    ]
    scene = load(builder.glb(tmp_path / "a.glb"), **AUTO)
    assert len(scene.shapes) == 4
    for shape in scene.shapes[:2]:
        np.testing.assert_allclose(area_vector(shape), [0, 0, 1])


def test_nested_transforms_and_normals(tmp_path):
    half = np.sqrt(0.5)
    nodes = [
        {"children": [1], "translation": [10, 0, 0], "rotation": [0, half, 0, half]},
        {"children": [2], "scale": [1, 2, 1]},
        {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]},
    ]
    shape = first(Builder(nodes=nodes).square(NORMAL=np.tile([0, 0.6, 0.8], (4, 1))), tmp_path)
    expected = np.array([[15, 0, 0], [15, 0, -1], [15, 2, -1], [15, 2, 0]])
    np.testing.assert_allclose(shape.mesh.vertices, expected, atol=1e-6)
    normal = np.array([0.8, 0.3, 0]) / np.hypot(0.8, 0.3)  # by the inverse transpose
    np.testing.assert_allclose(shape.vertex_normals(), np.tile(normal, (4, 1)), atol=1e-6)


def test_negative_scale_flips_the_winding(tmp_path):
    builder = Builder(nodes=[{"mesh": 0, "scale": [-1, 1, 1]}]).square(NORMAL=np.tile([0.6, 0, 0.8], (4, 1)))
    shape = first(builder, tmp_path)
    np.testing.assert_allclose(area_vector(shape), [0, 0, 1], atol=1e-6)
    np.testing.assert_allclose(shape.vertex_normals()[0], [-0.6, 0, 0.8], atol=1e-6)


def test_only_the_chosen_scene_is_read(tmp_path):
    scenes = [{"nodes": [0]}, {"nodes": [1, 2]}]
    builder = Builder(nodes=[{"mesh": 0}, {"mesh": 0}, {"mesh": 0}], scenes=scenes, scene=1)
    assert len(load(builder.square().glb(tmp_path / "a.glb"), **AUTO).shapes) == 4


def test_quantised_interleaved_and_sparse_accessors(tmp_path):
    builder = Builder(extensionsRequired=["KHR_mesh_quantization"])
    rows = np.zeros((4, 4), np.int16)
    rows[:, :3] = SQUARE * 32767
    at = builder.view(rows.tobytes(), byteStride=8)
    where = builder.view(np.array([2], np.uint8).tobytes())
    what = builder.view(np.array([32767, 32767, 16384], np.int16).tobytes())
    builder.document["accessors"].append(
        {
            "bufferView": at,
            "componentType": 5122,
            "type": "VEC3",
            "count": 4,
            "normalized": True,
            "sparse": {"count": 1, "indices": {"bufferView": where, "componentType": 5121}, "values": {"bufferView": what}},
        }
    )
    primitive = {"attributes": {"POSITION": 0}, "indices": builder.array(np.array([0, 1, 2, 0, 2, 3], np.uint8))}
    builder.document["meshes"] = [{"primitives": [primitive]}]
    vertices = first(builder, tmp_path).mesh.vertices
    np.testing.assert_allclose(vertices, [[0, 0, 0], [1, 0, 0], [1, 1, 0.5], [0, 1, 0]], atol=1e-4)


def test_material_factors_emission_and_averaged_textures(tmp_path):
    grey = np.full((2, 2, 3), (0, 128, 51))
    material = {
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.2, 0.4, 0.6, 0.5],
            "metallicFactor": 0.5,
            "metallicRoughnessTexture": {"index": 0},
        },
        "emissiveFactor": [1, 0.5, 0],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4}},
    }
    builder = Builder(materials=[material]).square(material=0).image(grey)
    shape = load(builder.glb(tmp_path / "a.glb"), auto_camera=True).shapes[0]  # its emission is the light
    assert shape.material.base_color == pytest.approx((0.2, 0.4, 0.6))
    assert shape.material.metallic == pytest.approx(0.5 * 51 / 255)
    assert shape.material.roughness == pytest.approx(128 / 255)
    assert shape.emission == pytest.approx((4, 2, 0))


def test_base_colour_texture(tmp_path):
    pixels = np.zeros((2, 2, 3))
    pixels[0, 0] = (255, 0, 188)
    material = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "baseColorFactor": [0.5, 1, 1, 1]}}
    uv = [[0, 0], [1, 0], [1, 1], [0, 1]]
    shape = first(Builder(materials=[material]).square(material=0, TEXCOORD_0=uv).image(pixels), tmp_path)
    texture = shape.material.base_color
    assert isinstance(texture, Texture)
    np.testing.assert_allclose(texture.pixels[0, 0], [0.5, 0, 0.50289], atol=1e-4)
    np.testing.assert_allclose(shape.uv, [[0, 1], [1, 1], [1, 0], [0, 0]])


def test_normals_without_a_length_are_the_faces_mean(tmp_path):
    shape = first(Builder().square(NORMAL=[[0, 0, 0], [0, 0.6, 0.8], [0, 0, 0], [0, 0.6, 0.8]]), tmp_path)
    np.testing.assert_allclose(shape.vertex_normals(), [[0, 0, 1], [0, 0.6, 0.8], [0, 0, 1], [0, 0.6, 0.8]], atol=1e-6)


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


def test_texture_transform(tmp_path):
    """A quarter turn counter-clockwise in the picture, whose v runs down: (1, 0) goes to (0, -1)."""
    transform = {"rotation": np.pi / 2, "scale": [2, 1], "offset": [0.25, 0]}
    lookup = {"index": 0, "extensions": {"KHR_texture_transform": transform}}
    builder = Builder(materials=[{"pbrMetallicRoughness": {"baseColorTexture": lookup}}])
    builder.square(material=0, TEXCOORD_0=[[0, 0], [1, 0], [1, 1], [0, 1]]).image(np.zeros((1, 1, 3)))
    np.testing.assert_allclose(first(builder, tmp_path).uv[1], [0.25, 1 + 2], atol=1e-6)


def test_camera_and_point_light(tmp_path):
    half = np.sqrt(0.5)
    nodes = [
        {"mesh": 0, "children": [1, 2]},
        {"camera": 1, "translation": [1, 2, 3], "rotation": [0, half, 0, half]},
        {"translation": [0, 5, 0], "extensions": {"KHR_lights_punctual": {"light": 0}}},
    ]
    cameras = [{"type": "orthographic"}, {"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]
    light = {"type": "point", "color": [1, 0.5, 0.25], "intensity": 8}
    extensions = {"KHR_lights_punctual": {"lights": [light]}}
    scene = load(Builder(nodes=nodes, cameras=cameras, extensions=extensions).square().glb(tmp_path / "a.glb"))
    np.testing.assert_allclose(scene.camera.origin, [1, 2, 3])
    np.testing.assert_allclose(scene.camera.axes()[2], [-1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(scene.camera.axes()[1], [0, 1, 0], atol=1e-12)
    assert scene.camera.fov == pytest.approx(np.degrees(1.0))
    (point,) = scene.lights
    np.testing.assert_allclose(point.position, [0, 5, 0])
    assert point.intensity == (8, 4, 2)


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


def test_spot_and_directional_lights_shine_along_the_nodes_axis(tmp_path):
    """-z of a node that is turned by 90 degrees about y; the default cone; angles in radians."""
    cone = {"innerConeAngle": np.radians(10), "outerConeAngle": np.radians(20)}
    kinds = [{"type": "spot", "intensity": 3.0, "spot": cone}, {"type": "spot"}, {"type": "directional", "color": [1, 0.5, 0]}]
    turned = {"rotation": [0, np.sqrt(0.5), 0, np.sqrt(0.5)], "translation": [1, 2, 3]}
    nodes = [
        {"mesh": 0, "children": [1, 2, 3]},
        *({**turned, "extensions": {"KHR_lights_punctual": {"light": i}}} for i in range(3)),
    ]
    path = Builder(nodes=nodes, extensions={"KHR_lights_punctual": {"lights": kinds}}).square().glb(tmp_path / "lamps.glb")
    narrow, plain, sun = load(path, auto_camera=True).lights
    for light in (narrow, plain, sun):
        np.testing.assert_allclose(light.direction, [-1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(narrow.position, [1, 2, 3])
    assert narrow.intensity == (3, 3, 3) and sun.irradiance == (1, 0.5, 0)
    assert (narrow.inner_angle, narrow.outer_angle) == pytest.approx((10, 20))
    assert (plain.inner_angle, plain.outer_angle) == pytest.approx((0, 45))


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


def check_framed_and_lit(scene):
    """Everything is in the picture, the lights are not, and grey in the middle would appear at about 0.5."""
    camera = scene.camera
    right, up, forward = camera.axes()
    things = [shape for shape in scene.shapes if shape.emission is None]
    local = np.concatenate([np.asarray(shape.mesh.vertices) for shape in things]) - camera.origin
    depth = local @ forward
    top = np.tan(np.radians(camera.fov) / 2)
    y, x = local @ up / (top * depth), local @ right / (top * depth * camera.width / camera.height)
    assert depth.min() > 0 and max(np.abs(x).max(), np.abs(y).max()) == pytest.approx(1 / 1.08, abs=0.05)
    corners = np.concatenate([np.asarray(shape.mesh.bounds) for shape in things])
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
    irradiance = 0.0
    for light in scene.shapes[len(things) :]:
        quad = np.asarray(light.mesh.vertices)
        assert _unseen(camera, quad)
        side = np.linspace(-1, 1, 101)[1:] - 0.01
        centre, a, b = quad.mean(axis=0), (quad[1] - quad[0]) / 2, (quad[3] - quad[0]) / 2
        points = centre + side[:, None, None] * a + side[None, :, None] * b - middle
        distance = np.linalg.norm(points, axis=2)
        facing = (centre - middle) / np.linalg.norm(centre - middle)
        cosine = points @ facing / distance
        assert area_vector(light) @ facing < 0  # it emits towards the scene
        irradiance += light.emission[0] * np.mean(cosine**2 / distance**2) * np.linalg.norm(area_vector(light))
    assert 0.5 / np.pi * irradiance == pytest.approx(0.5, rel=0.01)


@pytest.mark.parametrize("size", [(256, 256), (640, 200), (200, 640)])
def test_automatic_camera_and_light(tmp_path, size):
    nodes = [{"mesh": 0, "scale": [1e-3, 5e-3, 1], "rotation": [0.6, 0, 0, 0.8]}]
    path = Builder(nodes=nodes).square().glb(tmp_path / "a.glb")
    check_framed_and_lit(load(path, **AUTO, width=size[0], height=size[1]))


def test_automatic_light_stays_inside_a_room(tmp_path):
    """A camera among the geometry gets its lights in front of the wall behind it."""
    nodes = [
        {"children": [1, 2, 3]},
        {"mesh": 0, "translation": [0, 0, -1]},
        {"mesh": 0, "translation": [0, 0, 4]},
        {"camera": 0, "translation": [0.5, 0.5, 2]},
    ]
    cameras = [{"type": "perspective", "perspective": {"yfov": 1.0}}]
    scene = load(Builder(nodes=nodes, cameras=cameras).square().glb(tmp_path / "a.glb"), auto_light=True)
    for light in scene.shapes[-2:]:
        quad = np.asarray(light.mesh.vertices)
        assert _unseen(scene.camera, quad) and quad[:, 2].max() < 4


@pytest.mark.parametrize("name", ["CesiumMilkTruck.glb", "BoxTextured.glb", "balloon/scene.gltf"])
def test_scenes_by_others(name):
    if not (SHARED / name).is_file():
        pytest.skip(f"skipped: {SHARED / name} is not there")
    scene = load(SHARED / name, **AUTO, width=320, height=240)
    check_framed_and_lit(scene)
    textured = [shape for shape in scene.shapes if shape.textured]
    assert textured and all(shape.uv is not None for shape in textured)
    assert all(shape.vertex_normals() is not None for shape in scene.shapes if shape.emission is None)
    print(f"{name}: {len(scene.shapes)} shapes, {sum(len(s.mesh.faces) for s in scene.shapes)} faces")
