"""Triangles that lie on each other: which, and which of them is met there.

A ray cannot tell which of two surfaces at one place it meets first: rounding decides, and decides otherwise for another
ray. So it is settled here, once, and the kernels obey (``owner`` in cl_kernels/surface/surface.cl).
"""

from __future__ import annotations

import numpy as np

from .boxes import overlapping_boxes

BEND = 1e-5  # radians between the planes of triangles that may coincide
CELL = 4e-4  # planes are sorted into cells of this size, in direction and in height
OVERLAP = 2e-7  # triangles that overlap by less, or by less than ...
OVERLAP_SHARE = 1e-3  # ... this share of their least height, are neighbours whose common edge was rounded
CELLS = 5200  # more than there are of them along the components of a normal
BORDERS = (0.5, 0.5, 0.5, 0.3819660)  # keep common planes off the cells' borders
CHUNK = 1 << 18  # pairs looked at at once, which bounds the memory
SIDE = np.array([0.5718193, 0.2976931, 0.7644621])  # the side of this direction gives a plane's normal its sign


def coincident_pairs(corners: np.ndarray, normals: np.ndarray, gap: float) -> np.ndarray:
    """Pairs (N, 2) of triangles that overlap at a distance of ``gap`` at most, the lower number first, in order.

    ``corners`` (F, 3, 3), of a scene of about radius one; unit ``normals`` (F, 3), zero for triangles that no ray meets. The
    distance is that of one triangle's farthest corner from the other's plane, whichever is less.
    """
    triangle, plane = _sharing_a_plane(corners, normals, gap)
    if not len(triangle):
        return np.zeros((0, 2), np.int64)
    first = np.flatnonzero(np.append(True, plane[1:] != plane[:-1]))
    across = np.repeat(np.abs(normals[triangle[first]]).argmax(axis=1), np.diff(np.append(first, len(plane))))
    at = corners[triangle]
    flat = np.stack([np.take_along_axis(at, ((across + k) % 3)[:, None, None], axis=2)[..., 0] for k in (1, 2)], axis=2)
    margin = _least_overlap(at)[:, None] / 4
    found = [np.zeros(0, np.int64)]
    for one, other in overlapping_boxes(plane, flat.min(axis=1) + margin, flat.max(axis=1) - margin):
        for begin in range(0, len(one), CHUNK):
            a, b = (triangle[some[begin : begin + CHUNK]] for some in (one, other))
            kept = _coincide(corners, normals, a, b, gap)
            found.append((np.minimum(a, b) * len(corners) + np.maximum(a, b))[kept])
    return np.stack(np.divmod(np.unique(np.concatenate(found)), len(corners)), axis=1)


def _sharing_a_plane(corners: np.ndarray, normals: np.ndarray, gap: float) -> tuple[np.ndarray, np.ndarray]:
    """(triangle, plane): triangles whose plane others have as well, with a number for it, in that number's order.

    Planes are sorted into cells; what is near a cell's border goes into both, so that a pair may share more than one.
    """
    triangle = np.flatnonzero(normals.any(axis=1))
    side = normals[triangle] @ SIDE
    either = np.flatnonzero(np.abs(side) <= 2 * BEND)
    sign = np.where(side < 0, -1.0, 1.0)
    triangle, sign = np.append(triangle, triangle[either]), np.append(sign, -sign[either])
    reach = 2 * float(np.abs(corners).max(initial=0.0))
    planes = [normals[triangle, k] for k in range(3)]
    planes.append(sum(normals[triangle, k] * corners[triangle, 0, k] for k in range(3)))

    # a cell's number, in float64, which holds it exactly; what each of its four indices adds where it could be the next one
    key, steps = np.zeros(len(triangle)), []
    for k, (plane, tolerance) in enumerate(zip(planes, (BEND, BEND, BEND, gap + BEND * reach), strict=True)):
        at = plane * (sign / CELL) + BORDERS[k]
        low = np.floor(at - tolerance / (2 * CELL))
        steps.append(at + tolerance / (2 * CELL) >= low + 1)
        key += low * CELLS**k
    keys, members = [key], [triangle]
    rows = np.flatnonzero(steps[0] | steps[1] | steps[2] | steps[3])
    for choice in range(1, 16):
        upper = [k for k in range(4) if choice >> k & 1]
        chosen = rows[np.logical_and.reduce([steps[k][rows] for k in upper])]
        keys.append(key[chosen] + sum(CELLS**k for k in upper))
        members.append(triangle[chosen])
    key, member = np.concatenate(keys), np.concatenate(members)
    order = np.argsort(key)
    key = key[order]
    shared = np.zeros(len(key), dtype=bool)
    shared[1:] = key[1:] == key[:-1]
    shared[:-1] |= shared[1:]
    return member[order[shared]], key[shared].astype(np.int64)


def _least_overlap(corners: np.ndarray) -> np.ndarray:
    """By how much something must overlap each triangle (F, 3, 3), across, to lie on it."""
    edges = np.roll(corners, -1, axis=1) - corners
    height = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1) / np.linalg.norm(edges, axis=2).max(axis=1)
    return np.minimum(OVERLAP, OVERLAP_SHARE * height)


def _coincide(corners: np.ndarray, normals: np.ndarray, a: np.ndarray, b: np.ndarray, gap: float) -> np.ndarray:
    """Whether triangles a and b (N,) lie on each other."""
    from_a, from_b = corners[b] - corners[a, :1], corners[a] - corners[b, :1]
    apart = [np.abs(np.einsum("nki,ni->nk", off, normals[on])).max(axis=1) for off, on in ((from_a, a), (from_b, b))]
    rest = np.flatnonzero(
        (a != b) & (np.minimum(*apart) <= gap) & (np.abs(np.einsum("ni,ni->n", normals[a], normals[b])) > 0.9)
    )
    least = np.minimum(_least_overlap(corners[a]), _least_overlap(corners[b]))
    for triangle, k in ((t, k) for k in range(3) for t in (a, b)):
        here, there = corners[a[rest]], corners[b[rest]]
        edge = corners[triangle[rest], (k + 1) % 3] - corners[triangle[rest], k]
        across = np.cross(edge, normals[a[rest]])
        across /= np.linalg.norm(across, axis=1)[:, None]
        # from a corner of a, so that nothing is lost of small triangles far from the middle
        p, q = (np.einsum("nki,ni->nk", one - here[:, :1], across) for one in (here, there))
        depth = np.minimum(p.max(axis=1), q.max(axis=1)) - np.maximum(p.min(axis=1), q.min(axis=1))
        rest = rest[depth > least[rest]]
    kept = np.zeros(len(a), dtype=bool)
    kept[rest] = True
    return kept


def met_instead(
    pairs: np.ndarray, normals: np.ndarray, emits: np.ndarray, transmits: np.ndarray, order: np.ndarray
) -> np.ndarray:
    """For each side of each triangle those that are met in its place, best first: 2 F + 1 starts, then what they point to.

    ``pairs`` (N, 2) coincide; ``normals`` (F, 3); ``emits`` and ``transmits`` (F,) say of each triangle whether it gives
    light from its front, and whether light passes through it; ``order`` (F,) whole numbers, all different for those that
    coincide. Side 0 is the front. First comes a light that transmits, then lights seen from the front, other opaque triangles
    from the front, opaque ones from behind, what transmits, and among equals the lower ``order``. What transmits has the same
    rank on both sides, so that a path through it and its reverse meet the same one.
    """
    ranks = np.empty((2, len(order)), np.int64)
    for side in (0, 1):
        opaque = np.where(emits, 1, 2) if side == 0 else 3
        ranks[side] = np.where(transmits, np.where(emits, 0, 4), opaque)
    ranks = ranks * (int(order.max(initial=0)) + 1) + order
    one, other = np.concatenate([pairs, pairs[:, ::-1]]).T
    turned = np.einsum("ni,ni->n", normals[one], normals[other]) < 0
    parts = []
    for side in (0, 1):
        key = ranks[np.where(turned, 1 - side, side), other]
        parts.append(np.stack([2 * one + side, key, other])[:, key < ranks[side, one]])
    place, key, partner = np.concatenate(parts, axis=1)
    best_first = np.lexsort((key, place))
    starts = np.searchsorted(place[best_first], np.arange(2 * len(order) + 1))
    return np.concatenate([len(starts) + starts, partner[best_first]]).astype(np.int32)
