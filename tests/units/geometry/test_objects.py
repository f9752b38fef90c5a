"""Objects: the pieces of a scene and their oriented boxes."""

import time

import numpy as np
import pytest
import trimesh

from pylmc.geometry import objects as geometry
from pylmc.geometry.mesh import Part, join

ROTATION = trimesh.transformations.euler_matrix(0.4, -1.1, 2.3)[:3, :3]


def shape(mesh):
    vertices, faces = mesh if isinstance(mesh, tuple) else (mesh.vertices, mesh.faces)
    return Part(np.asarray(vertices, float), np.asarray(faces))


def find_objects(parts):
    return geometry.find_objects(join(parts))


def box(size, rotation=ROTATION, centre=(0, 0, 0)):
    mesh = trimesh.creation.box(size)
    return trimesh.Trimesh(mesh.vertices @ rotation.T + centre, mesh.faces, process=False)


def covers(item, points, slack=1e-9):
    along = (points - item.centre) @ item.axes.T
    return np.all(np.abs(along) <= item.half_extents * (1 + slack) + slack * item.bounding_radius)


def test_rotated_box_is_exact():
    objects, of_face = find_objects([shape(box((3, 2, 1), centre=(5, -7, 2)))])
    (item,) = objects
    np.testing.assert_allclose(item.half_extents, [1.5, 1.0, 0.5], rtol=1e-12)
    np.testing.assert_allclose(item.centre, [5, -7, 2], atol=1e-12)
    np.testing.assert_allclose(item.axes @ item.axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(item.axes) == pytest.approx(1)
    assert item.bounding_radius == pytest.approx(np.sqrt(3.5))
    assert item.faces == 12 and item.shape == 0 and np.all(of_face == 0)


@pytest.mark.parametrize("size", [(1, 1, 1), (1, 1, 0.2), (1e-7, 1e-7, 1e-7)])
def test_degenerate_principal_axes_do_not_widen_the_box(size):
    (item,), _ = find_objects([shape(box(size))])
    np.testing.assert_allclose(item.half_extents, np.array(size) / 2, rtol=1e-6)


def test_rotated_square_panel_is_flat_and_tight():
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) @ ROTATION.T + (1, 2, 3)
    (item,), _ = find_objects([shape((corners, [[0, 1, 2], [0, 2, 3]]))])
    np.testing.assert_allclose(item.half_extents, [1, 1, 0], atol=1e-12)
    np.testing.assert_allclose(item.centre, [1, 2, 3], atol=1e-12)


def test_pieces_are_joined_by_position_but_never_across_shapes():
    split = box((1, 1, 1))
    split.unmerge_vertices()  # every face has vertices of its own
    joined = trimesh.util.concatenate([split, box((1, 1, 1), centre=(4, 0, 0))])
    touching = shape(box((1, 1, 1)))
    objects, of_face = find_objects([shape(joined), touching])
    assert [item.shape for item in objects] == [0, 0, 1]
    assert [item.faces for item in objects] == [12, 12, 12]
    np.testing.assert_array_equal(of_face, np.repeat([0, 1, 2], 12))


def test_interleaved_faces_get_their_objects():
    a, b = box((1, 1, 1)), box((2, 2, 2), centre=(9, 0, 0))
    faces = np.stack([a.faces, b.faces + len(a.vertices)], axis=1).reshape(-1, 3)
    objects, of_face = find_objects([shape((np.vstack([a.vertices, b.vertices]), faces))])
    np.testing.assert_array_equal(of_face, np.tile([0, 1], 12))
    np.testing.assert_allclose(objects[1].centre, [9, 0, 0], atol=1e-12)


def test_tiny_object_far_from_the_origin_keeps_its_size():
    (item,), _ = find_objects([shape(box((4e-6, 2e-6, 1e-6), centre=(100, 100, 100)))])
    np.testing.assert_allclose(item.half_extents, [2e-6, 1e-6, 5e-7], rtol=1e-6)


def test_sphere_and_zero_area_pieces():
    sphere = trimesh.creation.icosphere(3, 2.0)
    (item,), _ = find_objects([shape(sphere)])
    assert item.bounding_radius == pytest.approx(2.0, rel=0.02)
    assert covers(item, sphere.vertices)
    line = shape(([[0, 0, 0], [1, 1, 0], [2, 2, 0]], [[0, 1, 2]]))
    (item,), _ = find_objects([line])
    assert np.all(np.isfinite(item.axes)) and covers(item, line.vertices)
    assert find_objects([])[0] == []


def test_many_objects_are_found_quickly():
    rng = np.random.default_rng(1)
    small = trimesh.creation.icosphere(1)
    offsets = rng.uniform(-100, 100, (3000, 3))
    vertices = (small.vertices[None] * 0.1 + offsets[:, None]).reshape(-1, 3)
    faces = (small.faces[None] + len(small.vertices) * np.arange(3000)[:, None, None]).reshape(-1, 3)
    start = time.perf_counter()
    objects, of_face = find_objects([shape((vertices, faces))])
    print(f"{len(faces)} faces, {len(objects)} objects: {time.perf_counter() - start:.2f} s")
    assert len(objects) == 3000 and len(of_face) == len(faces)
    assert all(covers(item, vertices[i * 42 : (i + 1) * 42]) for i, item in enumerate(objects))
