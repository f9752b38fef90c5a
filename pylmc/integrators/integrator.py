"""What every integrator is: prepared once, advanced launch by launch, and at any time a list of estimators."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from typing import Any

import numpy as np

from ..colour import LUMINANCE
from ..picture.estimators import Estimator, picture
from ..sampling.sampler import Sampler
from .batches import Batches


class Integrator(ABC):
    """Advanced by :mod:`pylmc.rendering`, which keeps the time and the progress bar. Looking at it changes nothing.

    ``unit`` names what is counted: mutations or samples; ``done`` counts them; ``run_seconds`` is what ``advance`` took.
    """

    unit: str

    def __init__(self, sampler: Sampler) -> None:
        self.sampler = sampler
        self.done = self.rays = self.not_finite = self.launches = 0
        self.run_seconds = 0.0

    @abstractmethod
    def prepare(self, seed: int, quick: bool) -> None:
        """Compile and get ready; ``quick`` spends less on it, for short renders."""

    @abstractmethod
    def launch(self) -> None:
        """Do one launch's work, wait for it, and count it in ``done``."""

    @abstractmethod
    def estimators(self) -> list[Estimator]:
        """The parts of the picture so far."""

    @abstractmethod
    def diagnostics(self) -> dict[str, Any]:
        """What OUT.json tells of this integrator."""

    @abstractmethod
    def mean_error(self) -> float | None:
        """The standard error of the picture's mean luminance, or None where it is too early to tell."""

    def note(self) -> dict[str, str]:
        """A few words for the progress bar."""
        return {}

    def advance(self) -> None:
        """Do one launch's work, and close a batch where one ends."""
        before = time.perf_counter()
        self.launch()
        self.launches += 1
        if self.launches == 1:  # a launch's work is known now: a batch is a mutation or sample per pixel, or more
            self.batches = Batches(-(-self.sampler.film_pixels // max(self.done, 1)))
        self.batches.advance(lambda: self.image() @ LUMINANCE)
        self.run_seconds += time.perf_counter() - before

    def image(self) -> np.ndarray:
        """The picture so far (height, width, 3), in the scene's radiance."""
        return picture(self.estimators())

    def variance(self) -> np.ndarray | None:
        """The estimated variance of the picture's luminance (height, width), or None where it is too early."""
        return self.batches.variance() if self.launches else None
