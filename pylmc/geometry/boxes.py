"""Pairs of rectangles that overlap."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

FEW = 8  # rectangles of which all pairs are looked at


def overlapping_boxes(group: np.ndarray, low: np.ndarray, high: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Batches of pairs of rectangles, by number, that are of one group and overlap by more than a touch.

    ``group`` (N,) integers, ``low`` and ``high`` (N, 2) corners. A pair may come more than once. Groups of many are cut into
    cells of about FEW, and those again, until cutting helps no more; a rectangle is in every cell that it reaches into.
    """
    number = np.flatnonzero(np.all(high > low, axis=1))
    group = group[number]
    part_low, part_high = low[number], high[number]  # what of each lies in its cell
    while len(number):
        order = np.argsort(group, kind="stable")
        number, group, part_low, part_high = number[order], group[order], part_low[order], part_high[order]
        first = np.flatnonzero(np.append(True, group[1:] != group[:-1]))
        count = np.diff(np.append(first, len(group)))
        cells, corner, size = _cells(part_low, part_high, first, count)
        whole = cells.prod(axis=1) == 1
        yield from _pairs(number[np.repeat(whole, count)], count[whole], low, high)
        rest = np.flatnonzero(~np.repeat(whole, count))
        of_group = np.repeat(np.arange(len(first)), count)[rest]
        copy, group, cell_low = _cut(part_low[rest], part_high[rest], of_group, cells, corner, size)
        part_low = np.maximum(part_low[rest[copy]], cell_low)
        part_high = np.minimum(part_high[rest[copy]], cell_low + size[of_group[copy]])
        number = number[rest[copy]]


def _cells(low: np.ndarray, high: np.ndarray, first: np.ndarray, count: np.ndarray) -> tuple[np.ndarray, ...]:
    """Into how many cells (groups, 2) each group is cut, its low corner, and a cell's size."""
    corner, extent = np.minimum.reduceat(low, first), np.maximum.reduceat(high, first)
    extent -= corner
    # no smaller than two rectangles are wide, or there were more copies than pairs saved
    mean = np.maximum(np.add.reduceat(high - low, first) / count[:, None], np.finfo(float).tiny)
    cells = np.minimum(np.sqrt(count / FEW)[:, None], extent / (2 * mean))
    cells = np.maximum(cells, 1).astype(np.int64)
    return cells, corner, extent / cells


def _cut(
    low: np.ndarray, high: np.ndarray, group: np.ndarray, cells: np.ndarray, corner: np.ndarray, size: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """For every cell that each rectangle reaches into: the rectangle, the cell's number, and its low corner."""
    unit = np.where(size > 0, size, 1)[group]
    begin, end = (np.clip((edge - corner[group]) / unit, 0, cells[group] - 1).astype(np.int64) for edge in (low, high))
    wide, tall = (end - begin + 1).T
    copy = np.repeat(np.arange(len(low)), wide * tall)
    step = np.arange(len(copy)) - np.repeat(np.cumsum(wide * tall) - wide * tall, wide * tall)
    at = begin[copy] + np.column_stack([step % wide[copy], step // wide[copy]])
    of_group = group[copy]
    numbers = np.cumsum(cells.prod(axis=1)) - cells.prod(axis=1)
    return copy, numbers[of_group] + at[:, 1] * cells[of_group, 0] + at[:, 0], corner[of_group] + at * size[of_group]


def _pairs(number: np.ndarray, count: np.ndarray, low: np.ndarray, high: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """All overlapping pairs within runs of ``count`` rectangles."""
    end = np.repeat(np.cumsum(count), count)
    place, apart = np.arange(len(number)), 1
    while len(place := place[place + apart < end[place]]):
        one, other = number[place], number[place + apart]
        met = np.all(np.minimum(high[one], high[other]) > np.maximum(low[one], low[other]), axis=1)
        yield one[met], other[met]
        apart += 1
