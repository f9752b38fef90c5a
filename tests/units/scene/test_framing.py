"""A camera and lights for files that have none."""

from pathlib import Path

import numpy as np
import pytest
from studies.gltf_files import AUTO, Builder, area_vector

from pylmc.scene.framing import _unseen
from pylmc.scene.loading import load

SHARED = Path(__file__).resolve().parents[3].parent / "shared" / "scenes" / "gltf"


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
