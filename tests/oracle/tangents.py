"""Tangents of whole paths (theory.md, 4): derivatives by complex steps, exact to rounding, and by central differences.

f(δ + iε e_k) = f(δ) + iε ∂f/∂δ_k + O(ε²), and ε = 1e-30 leaves the square far below rounding (Squire & Trapp 1998): forward
mode without a second copy of any formula. The differences see only values and are what the complex steps are checked by.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .charts import Charts
from .displaced import Moved, displaced, log_climbed
from .rounding import Rounding
from .vectors import Array

EPSILON = 1e-30


class Tangents:
    """Derivatives with respect to the charts' coordinates of whatever a displaced path determines.

    All columns at once: each path is displaced 2 m times, side by side. ``rounding``: applied to every derivative.
    """

    def __init__(self, charts: Charts, rounding: Rounding | None = None) -> None:
        self.charts, self.rounding = charts, rounding
        n, columns = len(charts.p), 2 * charts.m
        delta = 1j * EPSILON * np.repeat(np.eye(columns), n, axis=0)
        self.moved = displaced(charts.take(np.tile(np.arange(n), columns)), delta)

    def of(self, function: Callable[[Moved], Array]) -> Array:
        """d function(Moved) / d delta, (n, …, 2 m)."""
        slopes = np.imag(function(self.moved)) / EPSILON
        slopes = np.moveaxis(slopes.reshape(2 * self.charts.m, -1, *slopes.shape[1:]), 0, -1)
        return slopes if self.rounding is None else self.rounding.relative(slopes)

    def gradient(self) -> Array:
        """∇ of the log density in the charts' coordinates (n, 2 m), as the drift follows it."""
        return self.of(lambda moved: log_climbed(self.charts, moved))


def differences(charts: Charts, function: Callable[[Moved], Array], step: float) -> Array:
    """The same by five-point differences of ``step`` times the coordinate's size."""
    columns = []
    size = charts.size()
    for k in range(2 * charts.m):
        delta = np.zeros_like(size)
        delta[:, k] = step * size[:, k]
        f = [function(displaced(charts, scale * delta)) for scale in (-2, -1, 1, 2)]
        slope = (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / 12
        columns.append(slope / delta[:, k].reshape(-1, *[1] * (slope.ndim - 1)))
    return np.stack(columns, axis=-1)
