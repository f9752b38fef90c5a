"""Groups of chains: one for each path length and ending, each with its own normalisation (theory.md, 6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..device.tables import ENDINGS


@dataclass
class Group:
    """The paths of one length (segments) and ending, with their own normalisation b; chains ``first : first + chains``.

    ``log_weights`` (n,) and ``positions`` on the film (n, 2) are those of the start's candidates. ``weight_sum`` and
    ``weight_square_sum`` add I / p_ind over ``weighed`` independent paths, so b is their mean. ``not_finite`` counts
    candidates that were drawn but whose weight is no number; they count as paths without light.
    """

    length: int
    ending: int
    slot: int
    log_weights: np.ndarray
    positions: np.ndarray
    weighed: int = 0
    weight_sum: float = 0.0
    weight_square_sum: float = 0.0
    first: int = 0
    chains: int = 0
    steps: int = 0
    not_finite: int = 0

    def settle(self) -> None:
        """Set the sums from the candidates' weights."""
        lost = np.isnan(self.log_weights)
        self.not_finite = int(lost.sum())
        self.log_weights[lost] = -np.inf
        weights = np.exp(self.log_weights)
        self.weight_sum, self.weight_square_sum = float(weights.sum()), float((weights**2).sum())

    @property
    def unit(self) -> float:
        """What weights are counted in on a device: b, or one where that is zero."""
        return self.b or 1.0

    @property
    def name(self) -> str:
        """As shown to people: length and ending."""
        return f"{self.length} {ENDINGS[self.ending]}"

    @property
    def b(self) -> float:
        """The integral of the density over this group, in scaled units."""
        return self.weight_sum / max(self.weighed, 1)

    @property
    def b_error(self) -> float:
        """Standard error of b."""
        n = max(self.weighed, 2)
        return float(np.sqrt(max(self.weight_square_sum / n - self.b**2, 0) / n))
