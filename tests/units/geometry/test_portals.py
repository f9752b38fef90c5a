"""Holes found without being told."""

import time

import numpy as np
import pytest
import trimesh

from pylmc.geometry import portals as geometry
from pylmc.geometry.mesh import Part, join
from pylmc.geometry.portals import fit_rectangle

ROTATION = trimesh.transformations.euler_matrix(0.7, -0.3, 1.9)[:3, :3]
SHIFT = np.array([3.0, -2.0, 5.0])


def shape(vertices, faces):
    return Part(np.asarray(vertices, float), np.asarray(faces))


def find_portals(parts):
    return geometry.find_portals(join(parts))


def solid(mesh):
    return shape(mesh.vertices, mesh.faces)


def quads(rectangles):
    """Separate rectangles (x0, y0, x1, y1) in the plane z = 0, two triangles and four vertices each."""
    vertices = [(x, y, 0.0) for x0, y0, x1, y1 in rectangles for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]
    faces = [(4 * i + a, 4 * i + b, 4 * i + c) for i in range(len(rectangles)) for a, b, c in ((0, 1, 2), (0, 2, 3))]
    return np.array(vertices), np.array(faces)


def grid_wall(xs, ys, holes):
    """Cells of a grid, without those whose (column, row) is in ``holes``."""
    cells = [(i, j) for i in range(len(xs) - 1) for j in range(len(ys) - 1) if (i, j) not in holes]
    return quads([(xs[i], ys[j], xs[i + 1], ys[j + 1]) for i, j in cells])


CX, CY = 0.37, 0.58


def edges_of(hole):
    return CX - hole / 2, CY - hole / 4, CX + hole / 2, CY + hole / 4


def eight(hole):
    x0, y0, x1, y1 = edges_of(hole)
    return grid_wall([0, x0, x1, 1], [0, y0, y1, 1], {(1, 1)})


def four(hole):
    x0, y0, x1, y1 = edges_of(hole)
    return quads([(0, 0, x0, 1), (x1, 0, 1, 1), (x0, 0, x1, y0), (x0, y1, x1, 1)])


def pinwheel(hole):
    x0, y0, x1, y1 = edges_of(hole)
    return quads([(0, 0, x1, y0), (x1, 0, 1, y1), (x0, y1, 1, 1), (0, y0, x0, 1)])


def annulus(hole):
    x0, y0, x1, y1 = edges_of(hole)
    vertices = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (x0, y0, 0), (x1, y0, 0), (x1, y1, 0), (x0, y1, 0)]
    faces = [f for k in range(4) for f in ((k, (k + 1) % 4, 4 + k), ((k + 1) % 4, 4 + (k + 1) % 4, 4 + k))]
    return np.array(vertices, float), np.array(faces)


def check(portal, hole, rotation=None, shift=0.0):
    """The wide side of the 2:1 hole is the axis; errors relative to the hole."""
    rotation = np.eye(3) if rotation is None else rotation
    normal, axis = rotation @ (0, 0, 1), rotation @ (1, 0, 0)
    assert abs(portal.normal @ normal) == pytest.approx(1, abs=1e-9)
    blur = 1e-15 * (1 + np.linalg.norm(shift)) / hole  # what rounding the vertices does to a hole this small
    assert abs(portal.axis @ axis) == pytest.approx(1, abs=1e-9 + 10 * blur)
    np.testing.assert_allclose(portal.half_size, [hole / 2, hole / 4], rtol=1e-9 + 20 * blur)
    centre = rotation @ (CX, CY, 0) + shift
    assert np.linalg.norm(portal.centre - centre) < hole * (1e-9 + 20 * blur)


@pytest.mark.parametrize("hole", [0.3, 1e-2, 1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("build", [eight, four, pinwheel, annulus])
def test_one_hole_however_the_wall_is_cut(build, hole):
    vertices, faces = build(hole)
    (portal,) = find_portals([shape(vertices, faces)])
    check(portal, hole)


@pytest.mark.parametrize("hole", [0.3, 1e-4, 1e-8])
@pytest.mark.parametrize("build", [eight, four, pinwheel, annulus])
def test_any_orientation(build, hole):
    vertices, faces = build(hole)
    (portal,) = find_portals([shape(vertices @ ROTATION.T + SHIFT, faces)])
    check(portal, hole, ROTATION, SHIFT)


@pytest.mark.parametrize("build", [eight, four, pinwheel, annulus])
def test_single_precision_vertices(build):
    """Vertices rounded to float32, as in files, no longer lie on each other's edges exactly."""
    hole = 1e-2
    vertices, faces = build(hole)
    rounded = (vertices @ ROTATION.T + SHIFT).astype(np.float32).astype(float)
    (portal,) = find_portals([shape(rounded, faces)])
    np.testing.assert_allclose(portal.half_size, [hole / 2, hole / 4], rtol=1e-3)


def test_wall_of_several_shapes_and_mixed_windings():
    vertices, faces = four(0.1)
    faces[2:4] = faces[2:4, ::-1]
    parts = [shape(vertices, faces[2 * i : 2 * i + 2]) for i in range(4)]
    check(*find_portals(parts), 0.1)
    check(*find_portals([shape(vertices, faces)]), 0.1)


def test_two_sided_wall():
    vertices, faces = annulus(0.1)
    check(*find_portals([shape(vertices, np.vstack([faces, faces[:, ::-1]]))]), 0.1)


def test_several_holes_also_touching_in_a_corner():
    wall = grid_wall(np.arange(8.0), np.arange(7.0), {(1, 1), (2, 2), (5, 1), (5, 2), (3, 4)})
    holes = find_portals([shape(*wall)])
    sizes = sorted(tuple(hole.half_size) for hole in holes)
    expected = [(0.5, 0.5)] * 3 + [(1.0, 0.5)]
    np.testing.assert_allclose(sizes, expected)
    centres = {tuple(np.round(hole.centre, 9)) for hole in holes}
    assert centres == {(1.5, 1.5, 0), (2.5, 2.5, 0), (5.5, 2, 0), (3.5, 4.5, 0)}


def test_round_and_turned_holes():
    angle = np.linspace(0, 2 * np.pi, 64, endpoint=False)
    outer = np.column_stack([3 * np.cos(angle), 3 * np.sin(angle), 0 * angle])
    n = len(angle)
    k, after = np.arange(n), np.roll(np.arange(n), -1)
    faces = np.vstack([np.column_stack([k, after, n + k]), np.column_stack([after, n + after, n + k])])
    (circle,) = find_portals([shape(np.vstack([outer, outer / 30]), faces)])
    np.testing.assert_allclose(circle.half_size, 0.1, rtol=0.01)
    spun = np.array([[2, 1], [-1, 2], [-2, -1], [1, -2]])
    centre, _, half = fit_rectangle(spun * 0.5 + 7)
    np.testing.assert_allclose(centre, [7, 7])
    np.testing.assert_allclose(half, np.sqrt(10) / 4)


def test_room_with_a_window_in_one_mesh():
    """The hole's wall shares its outer edges with the other walls; the rim is where the mesh ends."""
    vertices, faces = annulus(0.2)
    back = vertices[:4] - (0, 0, 1)
    sides = [f for k in range(4) for f in ((k, 8 + k, (k + 1) % 4), ((k + 1) % 4, 8 + k, 8 + (k + 1) % 4))]
    room = np.vstack([faces, sides, [(8, 9, 10), (8, 10, 11)]])
    check(*find_portals([shape(np.vstack([vertices, back]), room)]), 0.2)


def tunnel():
    """A wall with thickness: the hole's rim carries on as a tunnel, and the mesh is closed."""
    vertices, faces = annulus(0.2)
    n = len(vertices)
    rims = [(a, (a + 1) % 4) for a in range(4)]
    sides = [f for a, b in rims for f in ((a, n + a, b), (b, n + a, n + b))]
    inside = [f for a, b in rims for f in ((4 + a, 4 + b, n + 4 + a), (4 + b, n + 4 + b, n + 4 + a))]
    both = np.vstack([vertices, vertices - (0, 0, 0.1)])
    return both, np.vstack([faces, faces[:, ::-1] + n, sides, inside])


def test_what_has_no_hole():
    plain = shape(*quads([(0, 0, 1, 1)]))
    island = shape(*quads([(0, 0, 1, 1), (0.2, 0.2, 0.4, 0.4)]))  # lies on the other, touching nothing
    tiles = shape(*grid_wall(np.arange(5.0), np.arange(5.0), set()))
    u_shape = shape(*grid_wall(np.arange(4.0), np.arange(4.0), {(1, 1), (1, 2)}))
    box = solid(trimesh.creation.box())
    cylinder = solid(trimesh.creation.annulus(0.5, 1.0, 1.0))
    for item in (plain, island, tiles, u_shape, box, cylinder, shape(*tunnel())):
        assert find_portals([item]) == []
    assert find_portals([plain, box, cylinder]) == []
    assert find_portals([]) == []


def test_a_hole_plugged_by_another_shape_is_none():
    vertices, faces = eight(0.1)
    plug = shape(*quads([edges_of(0.1)]))
    assert find_portals([shape(vertices, faces), plug]) == []


def test_curved_open_meshes_and_degenerate_triangles():
    sphere = trimesh.creation.icosphere(3)
    holed = sphere.submesh([np.arange(7, len(sphere.faces))], append=True)
    assert find_portals([solid(holed)]) == []
    vertices, faces = four(0.1)
    mending = [[0, 1, 1], [4, 4, 4]]
    line = np.vstack([vertices, [[CX - 0.05, 0.2, 0]]])  # on the left rectangle's edge: a triangle of no area
    check(*find_portals([shape(line, np.vstack([faces, mending, [[1, 16, 2]]]))]), 0.1)


@pytest.mark.parametrize("kind", ["sphere", "soup", "tiles", "planks", "perforated"])
def test_large_meshes_are_searched_quickly(kind):
    rng = np.random.default_rng(3)
    expected = 0
    if kind == "sphere":
        sphere = trimesh.creation.icosphere(7)
        item = shape(sphere.vertices, sphere.faces[5:])
    elif kind == "soup":
        item = shape(rng.uniform(0, 1, (300000, 3)), np.arange(300000).reshape(-1, 3))
    elif kind == "tiles":  # apart from each other, in one plane
        starts = np.array([(i, j) for i in range(200) for j in range(200)], float)
        item = shape(*quads(np.column_stack([starts, starts + 0.9])))
    elif kind == "planks":  # in courses that do not line up
        courses = [(i + 0.37 * (j % 3), j) for i in range(50) for j in range(200)]
        item = shape(*quads([(x, 0.1 * j, x + 1, 0.1 * (j + 1)) for x, j in courses]))
    else:
        holes = {(2 * i + 1, 2 * j + 1) for i in range(60) for j in range(60)}
        item, expected = shape(*grid_wall(np.arange(122.0), np.arange(122.0), holes)), 3600
    start = time.perf_counter()
    found = find_portals([item])
    print(f"{kind}: {len(item.faces)} faces, {len(found)} holes: {time.perf_counter() - start:.2f} s")
    assert len(found) == expected
