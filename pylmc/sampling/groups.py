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
    candidates that were drawn but whose weight is no number; they count as paths without light. ``unit``: what weights are
    counted in on a device, for their squares must not overflow.

    A group of which the start found no path has ``streams`` of independent paths in place of chains, with b their mean weight
    times ``share``. With n_0 candidates and n_1 large steps a group's b is the sum of their weights over n_0 + n_1; where
    the n_0 had none, n_1 / (n_0 + n_1) of the mean weight is what the others' would have been, so that b is right on
    average over starts. Without the share it would be too large, and too small without the group.
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
    unit: float = 1.0
    streams: bool = False
    share: float = 1.0

    def settle(self) -> None:
        """Set the sums from the candidates' weights."""
        lost = np.isnan(self.log_weights)
        self.not_finite = int(lost.sum())
        self.log_weights[lost] = -np.inf
        weights = np.exp(self.log_weights)
        self.weight_sum, self.weight_square_sum = float(weights.sum()), float((weights**2).sum())

    @property
    def name(self) -> str:
        """As shown to people: length and ending."""
        return f"{self.length} {ENDINGS[self.ending]}"

    @property
    def b(self) -> float:
        """The integral of the density over this group, in scaled units."""
        return self.share * self.weight_sum / max(self.weighed, 1)

    @property
    def worth(self) -> float:
        """What a splat of one, by each of the group's chains or streams in each step, is to the picture."""
        return self.share * self.unit if self.streams else self.b

    def refine(self, begun: Group, steps: int, drawn: int, weight: float, square: float, large_steps: float) -> None:
        """Take in what ``steps`` of the group that was ``begun`` have drawn; ``large_steps``: the probability of one."""
        self.steps, self.weighed = steps, begun.weighed + drawn
        self.weight_sum, self.weight_square_sum = begun.weight_sum + weight, begun.weight_square_sum + square
        if self.streams:
            large = large_steps * steps * self.chains  # those that chains would have made
            self.weighed, self.share = drawn, large / (begun.weighed + large)

    @property
    def b_error(self) -> float:
        """Standard error of b."""
        n = max(self.weighed, 2)
        return float(self.share * np.sqrt(max(self.weight_square_sum / n - (self.weight_sum / n) ** 2, 0) / n))
