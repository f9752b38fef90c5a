"""What can fill a film: the Markov chains (lmc), their independent sampler alone (bdpt), a path tracer (path).

An integrator is advanced launch by launch by :mod:`pylmc.rendering`, which keeps the time, the progress bar and the batches.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np


class Integrator(Protocol):
    """``unit`` names what is counted: mutations or samples; ``done`` counts them; ``seconds`` what took how long."""

    unit: str
    done: int
    seconds: dict[str, float]

    def prepare(self, seed: int, quick: bool) -> None:
        """Compile and get ready; ``quick`` spends less on it, for short renders."""

    def advance(self) -> None:
        """Do one launch's work and wait for it."""

    def end_batch(self) -> None:
        """Close a batch, for the error estimate."""

    def image(self) -> np.ndarray:
        """The picture so far (height, width, 3), in the scene's radiance."""

    def variance(self) -> np.ndarray | None:
        """The estimated variance of the picture's luminance (height, width), or None where it is too early."""

    def note(self) -> dict[str, str]:
        """A few words for the progress bar."""

    def diagnostics(self) -> dict[str, Any]:
        """What OUT.json tells of this integrator."""
