"""A run as a list of estimators: all that looking at a picture, merging runs or mixing integrators needs to know of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np


class Splats(Protocol):
    """A film that grows: what was added to each pixel so far."""

    def read(self) -> np.ndarray:
        """A new array (height, width, 3), float64; reading changes nothing."""


class Estimator(NamedTuple):
    """A part of the picture: ``film`` times ``normalisation`` over ``work``, times ``weight``.

    name: what it estimates, as shown to people ("3 connect"). normalisation: radiance, in the scene's units, that the film's
    numbers stand for where one unit of work was done. work: mutations, samples or passes. weight: its share where several
    estimate the same part of the light.
    """

    name: str
    film: Splats
    normalisation: float
    work: int
    weight: float = 1.0

    def read(self) -> np.ndarray:
        """Its part of the picture (height, width, 3)."""
        part = self.film.read()
        part *= self.weight * self.normalisation / max(self.work, 1)
        return part


def picture(estimators: Sequence[Estimator]) -> np.ndarray:
    """The sum of all parts (height, width, 3), read one at a time: large films do not fit into memory together."""
    total = estimators[0].read()
    for estimator in estimators[1:]:
        total += estimator.read()
    return total
