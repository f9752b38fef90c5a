"""The binary tree beneath a wide one: a surface-area-heuristic split of every node, a level at a time."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

FEWEST_BINS, MOST_BINS = 32, 1024  # candidate intervals per axis and node
MEDIAN_LEVEL = 40  # from here on nodes are halved, so that no geometry makes the tree, hence the stack, deep


@dataclass
class BinaryTree:
    """The binary tree: children (-1 in a leaf), boxes as (6, n) minima [low, -high], and each leaf's triangles."""

    left: np.ndarray
    right: np.ndarray
    box: np.ndarray
    first: np.ndarray  # into `order`, leaves only
    count: np.ndarray
    order: np.ndarray


def half_area(box: np.ndarray) -> np.ndarray:
    """Half the surface of boxes given as (6, ...) minima [low, -high]; of an empty box (all inf), inf or NaN."""
    x, y, z = -(box[0] + box[3]), -(box[1] + box[4]), -(box[2] + box[5])
    return x * y + y * z + z * x


def _weight(count: np.ndarray, width: int) -> np.ndarray:
    """What ``count`` triangles cost a ray that enters their box: full leaves pay, but so does every triangle less."""
    return -(-count // width) + 0.5 * count / width


def _bins(level: int, triangles: int, count: np.ndarray) -> int:
    """Many intervals while nodes are few, as they cost little there and decide the most; exact sweeps at the end."""
    if level >= MEDIAN_LEVEL:
        return 2
    return int(min(np.clip(triangles // (8 * len(count)), FEWEST_BINS, MOST_BINS), count.max()))


def _best_splits(
    box: np.ndarray, orders: list[np.ndarray], start: np.ndarray, count: np.ndarray, bins: int, width: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """For each segment of the orders: axis, triangles on the left, and both sides' boxes (6, segments).

    Each axis's order is cut into intervals of equal count, which needs no binning pass, becomes an exact sweep once a
    node has no more triangles than bins, and cannot fail on coincident centroids.
    """
    cuts = (np.arange(bins + 1) * count[:, None]) // bins
    starts = (start[:, None] + cuts[:, :-1]).ravel()
    empty = cuts[:, 1:] == cuts[:, :-1]
    on_left = cuts[:, 1:-1]
    weight_left, weight_right = _weight(on_left, width), _weight(count[:, None] - on_left, width)
    best = np.full(len(start), np.inf, dtype=box.dtype)
    axis_of, left_of = np.zeros(len(start), dtype=np.int64), np.ones(len(start), dtype=np.int64)
    boxes = np.zeros((2, 6, len(start)), dtype=box.dtype)
    for axis, order in enumerate(orders):
        parts = np.minimum.reduceat(np.take(box, order, axis=1), starts, axis=1).reshape(6, len(start), bins)
        parts[:, empty] = np.inf
        left = np.minimum.accumulate(parts, axis=2)[:, :, :-1]
        right = np.minimum.accumulate(parts[:, :, ::-1], axis=2)[:, :, -2::-1]
        with np.errstate(invalid="ignore"):
            cost = half_area(left) * weight_left + half_area(right) * weight_right
        cost[on_left == 0] = np.inf
        cut = np.argmin(cost, axis=1)
        rows = np.arange(len(start))
        better = cost[rows, cut] < best if axis else np.ones(len(start), dtype=bool)
        best[better] = cost[rows, cut][better]
        axis_of[better] = axis
        left_of[better] = on_left[rows, cut][better]
        boxes[0][:, better] = left[:, rows, cut][:, better]
        boxes[1][:, better] = right[:, rows, cut][:, better]
    return axis_of, left_of, boxes[0], boxes[1]


def grow(box: np.ndarray, width: int) -> BinaryTree:
    """The binary tree over the boxes (6, n), one level at a time."""
    centre = box[:3] - box[3:]
    orders = [np.argsort(centre[axis], kind="stable") for axis in range(3)]
    side = np.zeros(box.shape[1], dtype=bool)
    count = np.array([box.shape[1]])
    total = 1
    left, right, node_box = [], [], [box.min(axis=1, keepdims=True)]
    first, size, leaf_order, leaf_total = [], [], [], 0
    for level in itertools.count():
        done = count <= width
        in_leaf = np.repeat(done, count)
        leaf_order.append(orders[0][in_leaf])
        orders = [order[~in_leaf] for order in orders]
        leaf_count = np.where(done, count, 0)
        first.append(leaf_total + np.cumsum(leaf_count) - leaf_count)
        size.append(leaf_count)
        leaf_total += int(leaf_count.sum())
        inner = ~done
        children = np.full(len(count), -1)
        children[inner] = total + 2 * np.arange(int(inner.sum()))
        left.append(children)
        right.append(np.where(inner, children + 1, -1))
        count = count[inner]
        if len(count) == 0:
            break
        start = np.cumsum(count) - count
        axis, on_left, box_left, box_right = _best_splits(box, orders, start, count, _bins(level, len(orders[0]), count), width)
        offset = np.arange(len(orders[0])) - np.repeat(start, count)
        left_slot = offset < np.repeat(on_left, count)
        axis_slot = np.repeat(axis, count)
        for a, order in enumerate(orders):
            chosen = axis_slot == a
            side[order[chosen]] = left_slot[chosen]
        orders = [_partition(order, side, left_slot) for order in orders]
        total += 2 * len(count)
        count = np.stack((on_left, count - on_left), axis=1).ravel()
        node_box.append(np.stack((box_left, box_right), axis=2).reshape(6, -1))
    join = np.concatenate
    return BinaryTree(join(left), join(right), join(node_box, axis=1), join(first), join(size), join(leaf_order))


def _partition(order: np.ndarray, side: np.ndarray, left_slot: np.ndarray) -> np.ndarray:
    """``order`` with each segment's left triangles first, otherwise unchanged: both sides keep their sorting."""
    goes_left = side[order]
    result = np.empty_like(order)
    result[left_slot] = order[goes_left]
    result[~left_slot] = order[~goes_left]
    return result
