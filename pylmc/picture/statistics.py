"""How wrong a picture still is: batch means, and the error that they tell."""

from __future__ import annotations

import numpy as np

from ..colour import LUMINANCE

FLOOR = 1e-2  # of the squared mean brightness: what relMSE adds to its denominator, so that black pixels do not rule


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


def relative_square(square: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """relMSE before its mean: squared differences (or variances) over reference² + FLOOR mean(reference)², per element.

    A black reference makes differences from it infinite, and none zero.
    """
    floor = max(FLOOR * float(reference.mean()) ** 2, float(np.finfo(np.float64).tiny))
    with np.errstate(over="ignore"):
        return square / (reference**2 + floor)


def relative_error(image: np.ndarray, variance: np.ndarray | None) -> float | None:
    """Root of the estimated relMSE of a picture (height, width, 3) from its luminance's variance (height, width).

    The same measure as ``pylmc compare``'s relMSE, with the picture in the reference's place; None for a black one.
    """
    brightness = image @ LUMINANCE
    if variance is None or not float(brightness.mean()) ** 2 > 0:
        return None
    return float(np.sqrt(np.mean(relative_square(variance, brightness))))
