"""Traversal against brute force in float64, against Embree, and on the inputs that break ray tracers."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from pylmc.device.raytracer import RayTracer
from pylmc.errors import PylmcError
from pylmc.geometry import bvh
from pylmc.geometry.bvh.grow import MEDIAN_LEVEL

TRIANGLE = ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])


def soup(count: int, size: float, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-1, 1, (count, 1, 3)) + size * rng.normal(size=(count, 3, 3))
    return corners.reshape(-1, 3).astype(np.float32), np.arange(3 * count, dtype=np.int32).reshape(-1, 3)


def random_rays(count: int, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(count, 3)) * rng.lognormal(size=(count, 1))
    return rng.uniform(-2, 2, (count, 3)).astype(np.float32), directions.astype(np.float32)


def brute_force(vertices, faces, origins, directions, t_max=np.inf):
    """(t, triangle, margin): the closest hit in float64, and how far the decision is from the nearest edge or end."""
    corners = np.asarray(vertices, np.float32)[np.asarray(faces)].astype(np.float64)
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    best = np.full(len(origins), np.inf)
    triangle = np.full(len(origins), -1)
    margin = np.full(len(origins), np.inf)
    limit = np.broadcast_to(t_max, len(origins)).astype(np.float64)
    for i, (o, d) in enumerate(zip(np.float64(origins), np.float64(directions), strict=True)):
        with np.errstate(divide="ignore", invalid="ignore"):
            p = np.cross(d, b)
            inverse = 1 / (a * p).sum(axis=1)
            s = o - corners[:, 0]
            q = np.cross(s, a)
            u, v, t = (s * p).sum(axis=1) * inverse, (q @ d) * inverse, (b * q).sum(axis=1) * inverse
            slack = np.min([u, v, 1 - u - v, t, np.where(np.isinf(limit[i]), np.inf, limit[i] - t)], axis=0)
        slack = np.nan_to_num(slack, nan=-np.inf)
        margin[i] = np.abs(slack).min()
        if np.any(slack > 0):
            triangle[i] = np.argmin(np.where(slack > 0, t, np.inf))
            best[i] = t[triangle[i]]
    return best, triangle, margin


@pytest.mark.parametrize("width", bvh.WIDTHS)
@pytest.mark.parametrize(("count", "size"), [(1, 0.5), (9, 0.5), (300, 0.1), (3000, 0.02)])
def test_agrees_with_brute_force(width, count, size):
    vertices, faces = soup(count, size)
    origins, directions = random_rays(700)
    t_max = np.where(np.arange(700) % 2, np.float32(1.5), np.float32(np.inf))
    expected_t, expected, margin = brute_force(vertices, faces, origins, directions, t_max)
    tracer = RayTracer(vertices, faces, width=width)
    t, triangle, u, v = tracer.closest_hit(origins, directions, t_max)
    clear = margin > 1e-4
    assert clear.mean() > 0.7
    np.testing.assert_array_equal(triangle[clear], expected[clear])
    hit = clear & (expected >= 0)
    np.testing.assert_allclose(t[hit], expected_t[hit], rtol=2e-4, atol=1e-5)
    corners = vertices[faces[triangle[hit]]]
    point = (1 - u - v)[hit, None] * corners[:, 0] + u[hit, None] * corners[:, 1] + v[hit, None] * corners[:, 2]
    np.testing.assert_allclose(point, origins[hit] + t[hit, None] * directions[hit], atol=2e-4)
    assert np.all(np.isinf(t[triangle < 0]))
    np.testing.assert_array_equal(tracer.any_hit(origins, directions, t_max), triangle >= 0)


def test_agrees_with_embree():
    scene_module = pytest.importorskip("embreex.rtcore_scene")
    meshes = pytest.importorskip("embreex.mesh_construction")
    ball = trimesh.creation.icosphere(subdivisions=5)
    vertices = (ball.vertices * (1 + 0.2 * np.sin(9 * ball.vertices[:, [1]]))).astype(np.float32)
    origins, directions = random_rays(50_000)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    embree = scene_module.EmbreeScene(robust=True)
    meshes.TriangleMesh(embree, vertices[ball.faces])
    theirs = embree.run(origins, directions, output=1)
    t, triangle, _, _ = RayTracer(vertices, ball.faces).closest_hit(origins, directions)
    differ = theirs["primID"] != triangle
    assert differ.mean() < 2e-4  # rays along edges
    same = ~differ & (triangle >= 0)
    np.testing.assert_allclose(t[same], theirs["tfar"][same], rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize("width", bvh.WIDTHS)
def test_every_triangle_has_one_place_in_boxes_that_hold_it(width):
    vertices, faces = soup(5000, 0.05)
    tree = bvh.build(vertices, faces, width)
    ids = tree.leaves[:, 9].view(np.int32)
    used = ids >= 0
    assert np.all((ids[:, :-1] < ids[:, 1:]) | ~used[:, 1:])
    np.testing.assert_array_equal(np.sort(ids[used]), np.arange(5000))
    child = tree.nodes[:, 6].view(np.int32)
    present = np.isfinite(tree.nodes[:, 0])
    node, lane = np.nonzero(present & (child < 0))
    for n, k in zip(node, lane, strict=True):
        leaf = ~child[n, k]
        corners = vertices[faces[ids[leaf][used[leaf]]]].reshape(-1, 3)
        assert np.all(tree.nodes[n, :3, k] < corners) and np.all(corners < tree.nodes[n, 3:6, k])
    node, lane = np.nonzero(present & (child >= 0))
    inner = child[node, lane]
    assert np.all(np.bincount(inner, minlength=len(child))[1:] == 1) and not np.any(inner == 0)
    for n, k, i in zip(node, lane, inner, strict=True):
        assert np.all(tree.nodes[n, :3, k] <= tree.nodes[i, :3, present[i]])
        assert np.all(tree.nodes[n, 3:6, k] >= tree.nodes[i, 3:6, present[i]])


def test_axis_aligned_rays_in_planes_of_boxes():
    box = trimesh.creation.box(extents=(2, 2, 2))
    tracer = RayTracer(box.vertices, box.faces)
    axes = np.concatenate((np.eye(3), -np.eye(3)))
    t, _, _, _ = tracer.closest_hit(np.zeros(3), axes)
    np.testing.assert_array_equal(t, 1)
    # A ray inside the plane of the face x = 1 still meets the faces y = 1 and z = 1, at their very border.
    assert np.all(tracer.any_hit([[1, 0, 0]], axes[[1, 2, 4, 5]]))
    # Corner to corner: on an edge of every box and triangle.
    assert np.all(tracer.any_hit([[3, 3, 3], [-3, -3, -3]], [[-1, -1, -1], [1, 1, 1]]))


def test_closed_mesh_has_no_cracks():
    ball = trimesh.creation.icosphere(subdivisions=4)
    rng = np.random.default_rng(3)
    edge = ball.vertices[ball.edges_unique[rng.integers(len(ball.edges_unique), size=100_000)]]
    weight = rng.random((100_000, 1))
    weight[::10] = 0  # through a vertex
    directions = (1 - weight) * edge[:, 0] + weight * edge[:, 1]
    assert np.all(RayTracer(ball.vertices, ball.faces).any_hit(np.zeros(3), directions))


def test_single_triangle_and_its_parameters():
    tracer = RayTracer(*TRIANGLE)
    t, triangle, u, v = tracer.closest_hit([[0.25, 0.5, 2], [0.9, 0.9, 2], [0.25, 0.5, -2]], [0, 0, -4])
    np.testing.assert_array_equal(triangle, [0, -1, -1])
    np.testing.assert_array_equal(t, np.float32([0.5, np.inf, np.inf]))
    np.testing.assert_array_equal([u[0], v[0]], np.float32([0.25, 0.5]))


def test_t_max_is_exclusive_and_bounds_both_queries():
    tracer = RayTracer(*TRIANGLE)
    limits = np.array([0.5, np.nextafter(np.float32(0.5), np.float32(1)), 0.0, -1.0, np.inf])
    t, _, _, _ = tracer.closest_hit([0.25, 0.25, 2], [0, 0, -4], limits)
    np.testing.assert_array_equal(np.isfinite(t), [False, True, False, False, True])
    np.testing.assert_array_equal(tracer.any_hit([0.25, 0.25, 2], [0, 0, -4], limits), np.isfinite(t))


def test_degenerate_triangles_are_never_hit():
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0], [1, 1e-9, 0]]
    flat = [[0, 0, 0], [0, 1, 1], [0, 1, 3], [0, 3, 4]]
    origins, directions = random_rays(2000)
    directions[:1000] = np.float32([0.5, 0, 0]) - origins[:1000]
    for faces, expected in ((flat, -1), ([*flat, [0, 1, 2]], 4)):
        t, triangle, u, v = RayTracer(vertices, faces).closest_hit(origins, directions)
        assert set(triangle) <= {-1, expected}
        assert not np.any(np.isnan([t, u, v]))
    _, triangle, _, _ = RayTracer(vertices, [*flat, [0, 1, 2]]).closest_hit([[0.2, 0.2, 1]], [[0, 0, -1]])
    assert triangle[0] == 4


@pytest.mark.parametrize("width", bvh.WIDTHS)
def test_lowest_of_coincident_triangles(width):
    vertices, faces = soup(40, 0.4)
    shuffled = np.random.default_rng(5).permutation(np.repeat(np.arange(40), 30))
    origins, directions = random_rays(3000)
    _, once, _, _ = RayTracer(vertices, faces, width=width).closest_hit(origins, directions)
    _, triangle, _, _ = RayTracer(vertices, faces[shuffled], width=width).closest_hit(origins, directions)
    lowest = np.array([np.flatnonzero(shuffled == face)[0] for face in range(40)])
    np.testing.assert_array_equal(triangle, np.where(once >= 0, lowest[once], -1))


def test_directions_that_lead_nowhere_miss():
    t, triangle, _, _ = RayTracer(*TRIANGLE).closest_hit([[0.2, 0.2, 0], [0.2, 0.2, 1]], np.zeros(3))
    assert np.all(np.isinf(t)) and np.all(triangle == -1)
    assert RayTracer(*TRIANGLE).any_hit(np.zeros((0, 3)), np.zeros((0, 3))).shape == (0,)


def test_spiral_of_growing_triangles_keeps_the_stack_small():
    scale = np.float32(1.05) ** np.arange(-600, 400)
    vertices = (scale[:, None, None] * np.float32([[1, 0, 0], [1, 0.1, 0], [1, 0, 0.1]])).reshape(-1, 3)
    tree = bvh.build(vertices, np.arange(3000).reshape(-1, 3))
    assert tree.depth <= MEDIAN_LEVEL + 10
    _, triangle, _, _ = RayTracer(vertices, np.arange(3000).reshape(-1, 3)).closest_hit(np.zeros(3), [[1, 0.03, 0.03]])
    assert triangle[0] >= 0


@pytest.mark.parametrize(
    ("vertices", "faces", "message"),
    [
        (np.zeros((0, 3)), np.zeros((0, 3), int), "no triangles"),
        (TRIANGLE[0], np.zeros((0, 3), int), "no triangles"),
        (np.zeros((3, 2)), [[0, 1, 2]], r"shape \(3, 2\)"),
        (TRIANGLE[0], [[0, 1, 2, 0]], r"faces have shape"),
        (TRIANGLE[0], [[0, 1, 3]], "face 0 names vertices"),
        (TRIANGLE[0], [[0, 1, -1]], "face 0 names vertices"),
        (TRIANGLE[0], [[0, 1, 1.5]], "whole numbers"),
        ([[0, 0, np.nan], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], "vertex 0 is NaN"),
        ([[0, 0, 1e13], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], "rescale"),
        ("mesh", [[0, 1, 2]], "arrays of numbers"),
    ],
)
def test_bad_meshes_are_refused(vertices, faces, message):
    with pytest.raises(PylmcError, match=message):
        RayTracer(vertices, faces)


@pytest.mark.parametrize(
    ("origins", "directions", "t_max", "message"),
    [
        ([[0, 0, np.nan]], [[0, 0, 1]], np.inf, r"origins\[0\] is NaN"),
        ([[0, 0, 0]], [[0, 0, 1], [0, np.nan, 1]], np.inf, r"directions\[1\] is NaN"),
        ([[0, 0, 0]], [[0, 0, np.inf]], np.inf, r"directions\[0\]"),
        ([[0, 0, 0]], [[0, 0, 1]], np.nan, "t_max holds NaN"),
        (np.zeros((4, 3)), np.ones((3, 3)), np.inf, "do not match"),
        (np.zeros((4, 2)), np.ones((4, 2)), np.inf, r"expected \(k, 3\)"),
        (np.zeros((4, 3)), np.ones((4, 3)), np.ones((4, 1)), "do not match"),
        ("ray", np.ones((4, 3)), np.inf, "must be numbers"),
    ],
)
def test_bad_rays_are_refused(origins, directions, t_max, message):
    tracer = RayTracer(*TRIANGLE)
    for method in (tracer.closest_hit, tracer.any_hit):
        with pytest.raises(PylmcError, match=message):
            method(origins, directions, t_max)


def test_unknown_width_is_refused():
    with pytest.raises(PylmcError, match="width 3"):
        bvh.build(*TRIANGLE, width=3)
