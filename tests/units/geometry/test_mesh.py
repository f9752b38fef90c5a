"""One mesh of all shapes."""

import numpy as np

from pylmc.geometry.mesh import Part, join

TRIANGLE = Part(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))


def test_faces_and_vertices_know_their_shape() -> None:
    square = Part(np.array([[0.0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]), np.array([[0, 1, 2], [0, 2, 3]]))
    mesh = join([TRIANGLE, square, TRIANGLE])
    np.testing.assert_array_equal(mesh.faces, [[0, 1, 2], [3, 4, 5], [3, 5, 6], [7, 8, 9]])
    np.testing.assert_array_equal(mesh.shape_of_face, [0, 1, 1, 2])
    np.testing.assert_array_equal(mesh.shape_of_vertex, [0, 0, 0, 1, 1, 1, 1, 2, 2, 2])
    np.testing.assert_array_equal(mesh.vertices[mesh.faces[2]], square.vertices[[0, 2, 3]])
    assert mesh.normals.shape == (0, 3) and mesh.uvs.shape == (0, 2) and not mesh.smooth.any()


def test_what_only_some_shapes_have_is_zero_for_the_others() -> None:
    up = TRIANGLE._replace(normals=np.tile([0.0, 0, 1], (3, 1)), uvs=np.ones((3, 2)))
    mesh = join([TRIANGLE, up])
    np.testing.assert_array_equal(mesh.normals[:, 2], [0, 0, 0, 1, 1, 1])
    np.testing.assert_array_equal(mesh.uvs[:, 0], [0, 0, 0, 1, 1, 1])
    np.testing.assert_array_equal(mesh.smooth, [False, True])


def test_no_shapes_make_an_empty_mesh() -> None:
    mesh = join([])
    assert mesh.vertices.shape == (0, 3) and mesh.faces.shape == (0, 3) and len(mesh.smooth) == 0
