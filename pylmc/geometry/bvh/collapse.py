"""From a binary tree to a wide one, so that the expected cost of a ray is least.

A dynamic programme from the leaves upwards (after Ylitie, Karras and Laine, "Efficient incoherent ray traversal on
GPUs through compressed wide BVHs", 2017) finds, for every binary node, the cheapest way to cover it with at most k
children of some wide node. Against opening the largest child greedily it saves 40 % of the nodes and 10 % of the time.
"""

from __future__ import annotations

import numpy as np

from .grow import BinaryTree, half_area

LEAF_COST = 0.6  # of testing a leaf's triangles, in units of testing a node's boxes


def collapse(tree: BinaryTree, width: int) -> tuple[np.ndarray, np.ndarray, int]:
    """(nodes as in :class:`pylmc.geometry.bvh.Bvh`, the binary leaf behind each wide leaf, depth in wide nodes)."""
    splits = _plan(tree, width)
    frontier = np.zeros(1, dtype=np.int64)
    levels, leaf_nodes, next_node, next_leaf = [], [], 1, 0
    while len(frontier):
        slots = _open(tree, splits, frontier, width)
        used = slots >= 0
        inner = used & (tree.left[slots] >= 0)
        leaf = used & ~inner
        child = np.full(slots.shape, ~0, dtype=np.int64)  # an unused lane names a leaf that exists
        child[inner] = next_node + np.arange(int(inner.sum()))
        child[leaf] = ~(next_leaf + np.arange(int(leaf.sum())))
        nodes = np.zeros((len(slots), 8, width), dtype=tree.box.dtype)
        nodes[:, 0:3] = np.where(used, tree.box[:3][:, slots], np.inf).transpose(1, 0, 2)
        nodes[:, 3:6] = np.where(used, -tree.box[3:][:, slots], -np.inf).transpose(1, 0, 2)
        nodes[:, 6] = as_reals(child, tree.box.dtype)
        levels.append(nodes)
        frontier = slots[inner]
        leaf_nodes.append(slots[leaf])
        next_node += len(frontier)
        next_leaf += int(leaf.sum())
    return np.concatenate(levels), np.concatenate(leaf_nodes), len(levels)


def as_reals(integers: np.ndarray, dtype: np.dtype) -> np.ndarray:
    """The bits of integers as floats of ``dtype``, so that both can lie in one array."""
    return integers.astype(np.int64 if dtype == np.float64 else np.int32).view(dtype)


def _levels(tree: BinaryTree) -> list[np.ndarray]:
    """The binary nodes by level, the root first."""
    levels = [np.zeros(1, dtype=np.int64)]
    while True:
        inner = levels[-1][tree.left[levels[-1]] >= 0]
        if len(inner) == 0:
            return levels
        levels.append(np.concatenate((tree.left[inner], tree.right[inner])))


def _plan(tree: BinaryTree, width: int) -> np.ndarray:
    """(nodes, width + 1): of k lanes granted to a node, how many its left child gets; 0 where one lane is cheapest.

    Column 0 holds the division of a whole wide node's lanes, for a node that becomes one.
    """
    area = half_area(tree.box).astype(np.float64)
    cost = np.empty((len(area), width + 1))
    splits = np.zeros((len(area), width + 1), dtype=np.int8)
    for level in reversed(_levels(tree)):
        is_leaf = tree.left[level] < 0
        cost[level[is_leaf]] = LEAF_COST * area[level[is_leaf], None]
        inner = level[~is_leaf]
        left, right = cost[tree.left[inner]], cost[tree.right[inner]]
        divided = np.full((len(inner), width + 1), np.inf)
        left_lanes = np.zeros((len(inner), width + 1), dtype=np.int8)
        for lanes in range(2, width + 1):
            for first in range(1, lanes):
                trial = left[:, first] + right[:, lanes - first]
                better = trial < divided[:, lanes]
                divided[better, lanes] = trial[better]
                left_lanes[better, lanes] = first
        own_node = area[inner] + divided[:, width]
        cost[inner] = np.minimum(divided, own_node[:, None])
        splits[inner] = np.where(divided < own_node[:, None], left_lanes, 0)
        splits[inner, 0] = left_lanes[:, width]
    return splits


def _open(tree: BinaryTree, splits: np.ndarray, roots: np.ndarray, width: int) -> np.ndarray:
    """(roots, width) binary nodes that become each wide node's children, -1 in unused lanes, which come last."""
    slots = np.full((len(roots), width), -1)
    lanes = np.zeros_like(slots)
    slots[:, 0] = roots
    lanes[:, 0] = width
    left_lanes = splits[roots, 0]
    row, column = np.flatnonzero(left_lanes), np.zeros(np.count_nonzero(left_lanes), dtype=np.int64)
    first = left_lanes[row].astype(np.int64)
    while len(row):
        node, granted = slots[row, column], lanes[row, column]
        slots[row, column], lanes[row, column] = tree.left[node], first
        slots[row, column + first], lanes[row, column + first] = tree.right[node], granted - first
        left_lanes = np.where(slots >= 0, splits[slots, lanes], 0)
        row, column = np.nonzero(left_lanes)
        first = left_lanes[row, column].astype(np.int64)
    packed = np.argsort(slots < 0, axis=1, kind="stable")
    return np.take_along_axis(slots, packed, axis=1)
