"""The variance of a run's picture, from batches whose ends depend on the work done alone."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..picture.statistics import BatchMeans

BATCHES = 16  # of a run, at most, before they become twice as long
FEWEST = 4  # batches of the present length that tell more than those of half the length did


class Batches:
    """Compares batches of launches. They become longer as the run does, so that correlation within them fades.

    ``size``: launches of the first batches. After BATCHES of them each next one is twice as long, up to twice the work, and
    so on; the estimate comes from batches of one length, by which memory is bounded: four pictures' luminance.
    """

    def __init__(self, size: int) -> None:
        self.size = size
        self.launches = 0
        self._means = BatchMeans()
        self._last: tuple[np.ndarray | float, int] = 0.0, 0
        self._before: np.ndarray | None = None  # variance times launches, by batches of half the length

    def advance(self, luminance: Callable[[], np.ndarray]) -> None:
        """A launch is done. ``luminance()``: of the picture so far (height, width), read where a batch ends."""
        self.launches += 1
        last, since = self._last
        if self.launches - since < self.size:
            return
        total = luminance() * self.launches
        self._means.add((total - last) / (self.launches - since), self.launches - since)
        self._last = total, self.launches
        if self.launches == BATCHES * self.size:
            self._before, self._means, self.size = self._spread(), BatchMeans(), 2 * self.size

    def _spread(self) -> np.ndarray | None:
        spread = self._means.variance_of_mean()
        return None if spread is None else spread * (self._means.count * self.size)

    def variance(self) -> np.ndarray | None:
        """Of the picture's luminance (height, width); None before there are two batches."""
        spread = self._spread() if self._means.count >= FEWEST or self._before is None else self._before
        return None if spread is None else spread / self.launches
