"""glTF and GLB files as scenes."""

import numpy as np
import pytest
from studies.gltf_files import AUTO, SQUARE, Builder, area_vector, first

from pylmc import PylmcError
from pylmc.scene import Texture
from pylmc.scene.loading import load


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


@pytest.mark.parametrize(
    "cone", [None, [1], {"outerConeAngle": "x"}, {"innerConeAngle": 0.9}, {"innerConeAngle": 0.4, "outerConeAngle": 0.2}]
)
def test_a_spot_lights_cone_that_cannot_be_is_named(cone, tmp_path):
    lights = {"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": cone}]}}
    nodes = [{"mesh": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}}]
    with pytest.raises(PylmcError, match=r"lamp\.glb: light 0: "):
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
