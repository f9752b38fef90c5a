"""Triangles that lie on each other, against a search that clips every pair in float64."""

import itertools

import numpy as np
import pytest
import trimesh

from pylmc.geometry.boxes import overlapping_boxes
from pylmc.geometry.coincident import coincident_pairs, met_instead

GAP = 2e-6
TURN = trimesh.transformations.rotation_matrix(0.7, [0.1, 0.5, 0.8])[:3, :3]
Array = np.ndarray


def normals_of(corners: Array) -> Array:
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(cross, axis=1, keepdims=True)
    return np.divide(cross, size, where=size > 0, out=np.zeros_like(cross))


def found(corners: Array, gap: float = GAP) -> set[tuple[int, int]]:
    pairs = coincident_pairs(corners, normals_of(corners), gap)
    assert np.all(pairs[:, 0] < pairs[:, 1])
    return set(map(tuple, pairs.tolist()))


def overlap_area(one: Array, other: Array) -> float:
    """Of two triangles (3, 2), by clipping one to the other's sides."""
    if np.linalg.det(other[1:] - other[0]) < 0:
        other = other[::-1]
    polygon = list(one)
    for k in range(3):
        a, side = other[k], other[(k + 1) % 3] - other[k]
        heights = [side[0] * (p - a)[1] - side[1] * (p - a)[0] for p in polygon]
        clipped = []
        for p, q, hp, hq in zip(polygon, np.roll(polygon, -1, axis=0), heights, np.roll(heights, -1), strict=True):
            if hp >= 0:
                clipped.append(p)
            if (hp > 0) != (hq > 0) and hp != hq:
                clipped.append(p + (q - p) * hp / (hp - hq))
        polygon = clipped
        if not polygon:
            return 0.0
    x, y = np.array(polygon).T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2


def flat_soup(count: int, size: float, seed: int) -> Array:
    """Triangles in ten planes z = 0, 0.1, …"""
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-1, 1, (count, 1, 3)) + size * rng.normal(size=(count, 3, 3))
    corners[..., 2] = rng.integers(0, 10, count)[:, None] / 10
    return corners


@pytest.mark.parametrize("matrix", [np.eye(3), TURN], ids=["level", "turned"])
@pytest.mark.parametrize(("count", "size"), [(40, 0.5), (400, 0.1), (400, 0.01)])
def test_pairs_in_planes(matrix: Array, count: int, size: float) -> None:
    flat = flat_soup(count, size, count)
    flat[: count // 5] = flat[count // 5 : 2 * (count // 5), ::-1]  # some twice, the other way round
    expected = {
        (i, j)
        for i, j in itertools.combinations(range(count), 2)
        if flat[i, 0, 2] == flat[j, 0, 2] and overlap_area(flat[i, :, :2], flat[j, :, :2]) > 1e-5 * size**2
    }
    assert len(expected) >= count // 5
    pairs = found(flat @ matrix.T)
    touching = {p for p in pairs - expected if overlap_area(flat[p[0], :, :2], flat[p[1], :, :2]) > 0}
    assert pairs - touching == expected


@pytest.mark.parametrize("matrix", [np.eye(3), TURN], ids=["level", "turned"])
def test_neighbours_do_not_coincide(matrix: Array) -> None:
    box, ball = trimesh.creation.box((1, 1, 1)), trimesh.creation.icosphere(subdivisions=4)
    for mesh in (box.subdivide().subdivide().subdivide(), ball):
        corners = (mesh.vertices @ matrix.T).astype(np.float32).astype(float)[mesh.faces]
        assert not found(corners)
        count = len(corners)
        again = np.roll(corners[::-1], 1, axis=1)
        assert found(np.concatenate([corners, again])) == {(i, 2 * count - 1 - i) for i in range(count)}


@pytest.mark.parametrize(("apart", "tied"), [(0.0, True), (0.9, True), (1.1, False)])
def test_the_gap(apart: float, tied: bool) -> None:
    corners = np.array([[[-1, -1, 0], [1, -1, 0], [0, 1, 0]], [[-0.2, 0, 0], [0.2, 0, 0], [0, 0.2, 0]]], float) @ TURN.T
    corners[1] += apart * GAP * TURN[:, 2]
    assert found(corners) == ({(0, 1)} if tied else set())
    for upright in ([0.3, 0, 0], [0, 0, 0.3]):  # what stands on a triangle does not lie on it
        standing = np.array([[0, 0, 0], upright, [0, 0.2, 0.3]]) @ TURN.T
        assert found(np.stack([corners[0], standing])) == set()


def test_triangles_without_area_are_left_out() -> None:
    corners = np.zeros((3, 3, 3))
    corners[0] = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    corners[1] = [[0, 0, 0], [1, 0, 0], [0.5, 0, 0]]
    assert found(corners) == set()
    assert found(corners[1:]) == set()


def test_boxes_against_every_pair() -> None:
    rng = np.random.default_rng(3)
    group = rng.integers(0, 5, 2000)
    low = rng.uniform(-1, 1, (2000, 2))
    high = low + rng.lognormal(-4, 2, (2000, 2))  # from specks to boxes that hold everything
    one, other = np.triu_indices(2000, 1)
    met = np.all(np.minimum(high[one], high[other]) > np.maximum(low[one], low[other]), axis=1)
    met &= group[one] == group[other]
    pairs = {(min(p), max(p)) for a, b in overlapping_boxes(group, low, high) for p in zip(a.tolist(), b.tolist(), strict=True)}
    assert {p for p in pairs if p[0] != p[1]} == set(zip(one[met].tolist(), other[met].tolist(), strict=True))


def lists_of(array: Array, count: int) -> list[tuple[list[int], list[int]]]:
    def of_side(side: int) -> list[int]:
        return array[array[side] : array[side + 1]].tolist()

    return [(of_side(2 * i), of_side(2 * i + 1)) for i in range(count)]


def test_who_is_met() -> None:
    """At one place: lamps that shine up (0) and down (1), opaque triangles that face up (2) and down (3), glass (4)."""
    up, down = [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]
    normals = np.array([up, down, up, down, up])
    emits, glass = np.array([True, True, False, False, False]), np.array([False, False, False, False, True])
    pairs = np.array(list(itertools.combinations(range(5), 2)))
    lists = lists_of(met_instead(pairs, normals, emits, glass, np.arange(5)), 5)
    above = {i: lists[i][0 if normals[i, 2] > 0 else 1] for i in range(5)}
    below = {i: lists[i][1 if normals[i, 2] > 0 else 0] for i in range(5)}
    for seen, ranking in ((above, [0, 2, 1, 3, 4]), (below, [1, 3, 0, 2, 4])):
        for i in range(5):
            assert seen[i] == ranking[: ranking.index(i)], (i, seen)
    lists = lists_of(met_instead(np.array([[2, 4]]), normals, emits, glass, np.arange(5)), 5)
    assert lists == [([], []), ([], []), ([], []), ([], []), ([2], [2])]
