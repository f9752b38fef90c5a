"""How wrong a picture still is, and how well its chains mix: batch means, effective sample size, R-hat."""

from __future__ import annotations

import numpy as np

LUMINANCE = np.array([0.212671, 0.715160, 0.072169])
TRACED_CHAINS = 64  # per group: enough for R-hat, and arviz's cost grows with their number


class BatchMeans:
    """The variance of a mean of weighted batches, per element, accumulated as they come (Welford; West 1979)."""

    def __init__(self) -> None:
        self.count = 0
        self._weight = 0.0
        self._mean: np.ndarray | float = 0.0
        self._spread: np.ndarray | float = 0.0

    def add(self, batch: np.ndarray, weight: float) -> None:
        """One batch's mean and its weight (the work it took)."""
        self.count += 1
        self._weight += weight
        step = batch - self._mean
        self._mean = self._mean + step * (weight / self._weight)
        self._spread = self._spread + weight * step * (batch - self._mean)

    def variance_of_mean(self) -> np.ndarray | None:
        """The estimated variance of the mean over all batches, or None before there are two."""
        if self.count < 2:
            return None
        return np.asarray(self._spread) / (self._weight * (self.count - 1))


def relative_error(image: np.ndarray, variance: np.ndarray | None) -> float | None:
    """Root of the estimated relMSE of a picture (height, width, 3) from its luminance's variance (height, width).

    The same measure as ``pylmc compare``'s relMSE, with the picture in the reference's place.
    """
    if variance is None:
        return None
    brightness = image @ LUMINANCE
    floor = 1e-2 * float(brightness.mean()) ** 2
    if not floor > 0:
        return None
    return float(np.sqrt(np.mean(variance / (brightness**2 + floor))))


def mixing(traces: np.ndarray) -> tuple[float, float] | None:
    """(effective sample size, R-hat) of film positions (chains, draws, 2): the worse coordinate.

    The size counts draws of all chains. None where there are fewer than four draws, or nothing moved.
    """
    from arviz_stats.base import array_stats  # slow to import, wanted once at a render's end

    chains, draws = traces.shape[:2]
    if draws < 4 or chains < 2:
        return None
    sample = traces[:TRACED_CHAINS].astype(np.float64)
    if np.any(sample.std(axis=(0, 1)) == 0):
        return None
    sizes = [float(array_stats.ess(sample[:, :, i], chain_axis=0, draw_axis=1)) for i in range(2)]
    rhats = [float(array_stats.rhat(sample[:, :, i], chain_axis=0, draw_axis=1)) for i in range(2)]
    return min(sizes) * chains / len(sample), max(rhats)
