"""The outlines of the scene's flat open pieces: coplanar triangles that share edges, or parts of edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from .topology import label_components, roundoff, weld

BEND = 1e-5  # radians between triangles of one plane, on top of what rounding explains
COARSE = 1e-5  # planes nearer than this (in direction, and in offset relative to the scene) are compared in detail


@dataclass(frozen=True, eq=False)
class Outline:
    """A flat piece's boundary: ``points`` (N, 3), unit ``normal``, and directed edges with the piece on their left.

    ``open`` maps each edge (start, end) to whether the shape ends there (or another, not coplanar face carries on).
    """

    points: np.ndarray
    normal: np.ndarray
    open: dict[tuple[int, int], bool]


@dataclass(eq=False)
class _Edges:
    """Directed boundary edges (E, 2) with the patch (E,) they bound and whether the shape ends at them (E,)."""

    ends: np.ndarray
    patch: np.ndarray
    open: np.ndarray

    def take(self, which: np.ndarray) -> _Edges:
        return _Edges(self.ends[which], self.patch[which], self.open[which])


def outlines(vertices: np.ndarray, faces: np.ndarray, owner: np.ndarray, precision: float) -> list[Outline]:
    """The outlines of all flat pieces that are not plainly a disc, positions being exact to ``precision``.

    Only the boundaries of coplanar patches at which a shape ends are looked at, so that closed and curved meshes cost
    a few sorts and no more.
    """
    index = weld(vertices, faces, precision)
    points = np.empty((int(index.max()) + 1, 3))
    points[index] = vertices
    tolerance = roundoff(vertices, precision)
    faces, owner, normals, heights = _sound_faces(points, index[faces], owner, tolerance)
    if len(faces) == 0:
        return []
    patch, disc, edges, of_face = _patches(faces, owner, normals, heights, tolerance)
    rimmed = np.zeros(len(disc), dtype=bool)
    rimmed[edges.patch[edges.open]] = True
    plane, plane_normals = _planes(points, faces, normals, patch, rimmed)

    # A patch that is a disc and alone in its plane has no hole; the other patches' edges may meet in parts.
    crowded = np.bincount(plane[rimmed], minlength=len(plane_normals)) > 1
    wanted = (rimmed & (crowded[plane] | ~disc))[edges.patch]
    edges, of_face = edges.take(wanted), of_face[wanted]
    backward = np.einsum("ei,ei->e", normals[of_face], plane_normals[plane[edges.patch]]) < 0
    edges.ends[backward] = edges.ends[backward][:, ::-1]
    edges = _split_at_vertices(points, edges, plane, tolerance)
    edges, piece = _cancel_shared(edges, plane)
    alone = np.bincount(piece, minlength=len(piece))[piece] == 1
    edges = edges.take(~(alone & disc)[edges.patch])
    return _collect(points, edges, piece)


def _runs(*keys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """An order that brings equal keys together, and each sorted entry's run number."""
    order = np.lexsort(keys)
    new = np.zeros(len(order), dtype=np.int64)
    for key in keys:
        ranked = key[order]
        new[1:] |= ranked[1:] != ranked[:-1]
    return order, np.cumsum(new)


def _sound_faces(
    points: np.ndarray, faces: np.ndarray, owner: np.ndarray, tolerance: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Faces that have an area, each once, with owner, unit normal and least height.

    Triangles flattened to a line only mend T-junctions; a face's double is the back of a two-sided wall.
    """
    order, run = _runs(*np.sort(faces, axis=1).T, owner)
    keep = np.sort(order[np.searchsorted(run, np.arange(run[-1] + 1))]) if len(run) else order
    faces, owner = faces[keep], owner[keep]
    a, b, c = (points[faces[:, k]] for k in range(3))
    lengths = np.linalg.norm([b - a, c - b, a - c], axis=2)
    cross = np.cross(b - a, c - a)
    doubled = np.linalg.norm(cross, axis=1)
    heights = np.divide(doubled, lengths.max(axis=0), out=np.zeros_like(doubled), where=doubled > 0)
    sound = heights > np.minimum(tolerance, 1e-3 * lengths.min(axis=0))
    return faces[sound], owner[sound], cross[sound] / doubled[sound, None], heights[sound]


def _patches(
    faces: np.ndarray, owner: np.ndarray, normals: np.ndarray, heights: np.ndarray, tolerance: float
) -> tuple[np.ndarray, np.ndarray, _Edges, np.ndarray]:
    """Coplanar patches of faces joined by whole edges within one shape.

    Returns each face's patch (F,), whether each patch is a disc (P,) by Euler's number, the patches' boundary edges,
    and each such edge's face.
    """
    ends = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    face = np.repeat(np.arange(len(faces)), 3)
    order, edge = _runs(ends.max(axis=1), ends.min(axis=1), owner[face])
    joins = []
    for step in (1, 2, 3):  # more than four faces at one edge do not all meet each other here; walls have no need
        same = edge[step:] == edge[:-step]
        f, g = face[order[:-step][same]], face[order[step:][same]]
        bend = np.linalg.norm(np.cross(normals[f], normals[g]), axis=1)
        allowed = np.minimum(BEND + tolerance * (1 / heights[f] + 1 / heights[g]), 1e-2)
        joins.append(np.column_stack([f, g])[bend <= allowed])
    count, patch = label_components(len(faces), np.concatenate(joins))

    shared = np.bincount(edge)[edge] > 1
    of_patch = patch[face[order]]
    inner_order, inner = _runs(edge, of_patch)
    once = np.bincount(inner)[inner] == 1
    rim = order[inner_order[once]]
    edges = _Edges(ends[rim], patch[face[rim]], ~shared[inner_order[once]])

    first_of_edge = inner_order[np.append(True, inner[1:] != inner[:-1])]
    edge_count = np.bincount(of_patch[first_of_edge], minlength=count)
    corner_patch, corner = np.repeat(patch, 3), faces.reshape(-1)
    corner_order, run = _runs(corner, corner_patch)
    first_of_corner = corner_order[np.append(True, run[1:] != run[:-1])]
    corner_count = np.bincount(corner_patch[first_of_corner], minlength=count)
    disc = corner_count - edge_count + np.bincount(patch, minlength=count) == 1
    return patch, disc, edges, face[rim]


def _planes(
    points: np.ndarray, faces: np.ndarray, normals: np.ndarray, patch: np.ndarray, rimmed: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Each patch's plane (P,; those not ``rimmed`` all get the last) and the planes' unit normals.

    Planes are compared by n nᵀ and by the foot of the perpendicular from the scene's middle: neither has a sign.
    """
    which = np.flatnonzero(rimmed[patch])
    corners = points[faces[which]]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    largest = which[_last_of_each(patch[which], area)]  # the best conditioned face of each patch speaks for it
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    extent = max(float(np.abs(points - middle).max()), np.finfo(float).tiny)
    n = normals[largest]
    offset = np.einsum("pi,pi->p", (points[faces[largest, 0]] - middle) / extent, n)
    key = np.column_stack([n[:, [0, 1, 2, 0, 1, 2]] * n[:, [0, 1, 2, 1, 2, 0]], n * offset[:, None]])
    rounded, cell = np.unique(np.round(key / COARSE).astype(np.int64), axis=0, return_inverse=True)
    pairs = cKDTree(rounded).query_pairs(3.0, output_type="ndarray")
    count, label = label_components(len(rounded), pairs)
    plane = np.full(len(rimmed), count)
    plane[patch[largest]] = label[cell.reshape(-1)]
    plane_normals = np.zeros((count + 1, 3))
    plane_normals[plane[patch[largest]]] = n
    return plane, plane_normals


def _last_of_each(group: np.ndarray, value: np.ndarray) -> np.ndarray:
    """The index of the largest value in each group."""
    order = np.lexsort((value, group))
    return order[np.append(group[order][1:] != group[order][:-1], True)] if len(order) else order


def _split_at_vertices(points: np.ndarray, edges: _Edges, plane: np.ndarray, tolerance: float) -> _Edges:
    """Edges cut at the boundary vertices of their plane that lie on them, so that T-junctions match edge by edge."""
    if len(edges.patch) == 0:
        return edges
    of_edge = plane[edges.patch]
    known = np.unique(np.column_stack([np.tile(of_edge, 2), edges.ends.T.reshape(-1)]), axis=0)
    start, end = points[edges.ends[:, 0]], points[edges.ends[:, 1]]
    length = np.linalg.norm(end - start, axis=1)
    slack = np.minimum(tolerance, 1e-3 * length)
    tree = cKDTree(points[known[:, 1]])
    # A long edge is searched in several short balls: one around all of it would hold most of a tiled floor.
    balls = np.clip(np.ceil(length / np.median(length)), 1, 64).astype(np.int64)
    edge = np.repeat(np.arange(len(length)), balls)
    step = np.arange(len(edge)) - np.repeat(np.cumsum(balls) - balls, balls)
    centre = start[edge] + ((step + 0.5) / balls[edge])[:, None] * (end - start)[edge]
    near = tree.query_ball_point(centre, 0.5001 * (length / balls)[edge] + slack[edge])
    edge = np.repeat(edge, [len(found) for found in near])
    vertex = np.fromiter((i for found in near for i in found), dtype=np.int64, count=len(edge))
    mine = known[vertex, 0] == of_edge[edge]
    edge, vertex = edge[mine], known[vertex[mine], 1]
    direction = (end - start)[edge] / length[edge, None]
    away = points[vertex] - start[edge]
    along = np.einsum("ei,ei->e", away, direction)
    aside = np.linalg.norm(away - along[:, None] * direction, axis=1)
    inside = (aside <= slack[edge]) & (along > slack[edge]) & (along < length[edge] - slack[edge])
    inside &= (vertex != edges.ends[edge, 0]) & (vertex != edges.ends[edge, 1])

    every = np.arange(len(length))
    edge = np.concatenate([every, every, edge[inside]])
    vertex = np.concatenate([edges.ends[:, 0], edges.ends[:, 1], vertex[inside]])
    along = np.concatenate([np.full(len(length), -1.0), 2 * length, along[inside]])
    order = np.lexsort((vertex, along, edge))
    edge, vertex = edge[order], vertex[order]
    joined = (edge[1:] == edge[:-1]) & (vertex[1:] != vertex[:-1])  # two balls may both have found a vertex
    return _Edges(
        np.column_stack([vertex[:-1], vertex[1:]])[joined], edges.patch[edge[1:][joined]], edges.open[edge[1:][joined]]
    )


def _cancel_shared(edges: _Edges, plane: np.ndarray) -> tuple[_Edges, np.ndarray]:
    """Without the edges at which two patches of a plane meet; and each patch's piece (P,), joined across them."""
    order, run = _runs(edges.ends.max(axis=1), edges.ends.min(axis=1), plane[edges.patch])
    patch = edges.patch[order]
    same = run[1:] == run[:-1]
    piece = label_components(len(plane), np.column_stack([patch[1:], patch[:-1]])[same])[1]
    return edges.take(order[np.bincount(run)[run] == 1]), piece


def _collect(points: np.ndarray, edges: _Edges, piece: np.ndarray) -> list[Outline]:
    """One outline per piece, from its remaining edges; its normal is their area vector, which slivers do not tilt."""
    order = np.argsort(piece[edges.patch], kind="stable")
    cuts = np.flatnonzero(np.diff(piece[edges.patch[order]])) + 1
    found = []
    for part in np.split(order, cuts):
        if len(part) < 6:  # an outer and an inner loop have three edges each at least
            continue
        used, local = np.unique(edges.ends[part], return_inverse=True)
        pairs = local.reshape(-1, 2)
        corners = points[used]
        start, end = (corners[pairs[:, k]] - corners.mean(axis=0) for k in (0, 1))
        normal = np.cross(start, end).sum(axis=0)
        if not np.linalg.norm(normal) > 0:
            continue
        flags = zip(pairs.tolist(), edges.open[part].tolist(), strict=True)
        found.append(Outline(corners, normal / np.linalg.norm(normal), {(start, end): flag for (start, end), flag in flags}))
    return found
