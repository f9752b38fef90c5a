"""Where chains were on the film, launch after launch, in bounded memory: the trace behind ESS and R-hat."""

from __future__ import annotations

import numpy as np

from .diagnostics import TRACED_CHAINS, mixing

LONGEST = 2048  # draws; with as many, the means of two take their place


class Trace:
    """The first TRACED_CHAINS of ``chains`` chains, as means over a number of launches that grows with the run."""

    def __init__(self, chains: int) -> None:
        self.chains, self._traced = chains, min(chains, TRACED_CHAINS)
        self._draws: list[np.ndarray] = []
        self._launches, self._sum, self._in_sum = 1, np.zeros((self._traced, 2)), 0  # of a draw; of the one to come
        self._count, self._first, self._square = 0, np.zeros(2), np.zeros(2)  # moments of single positions

    def add(self, positions: np.ndarray) -> None:
        """The chains' positions now (chains, 2), which are copied."""
        now = positions[: self._traced].astype(np.float64)
        self._count, self._first, self._square = self._count + 1, self._first + now.mean(0), self._square + (now**2).mean(0)
        self._sum, self._in_sum = self._sum + now, self._in_sum + 1
        if self._in_sum < self._launches:
            return
        self._draws.append((self._sum / self._launches).astype(np.float32))
        self._sum, self._in_sum = np.zeros_like(self._sum), 0
        if len(self._draws) == LONGEST:
            self._draws = [(a + b) / 2 for a, b in zip(self._draws[::2], self._draws[1::2], strict=True)]
            self._launches *= 2

    def mixing(self) -> tuple[float, float] | None:
        """(effective sample size, R-hat) of all chains: see :func:`pylmc.sampling.diagnostics.mixing`."""
        if not self._draws:
            return None
        draws = np.stack(self._draws, axis=1)
        found = mixing(draws)
        if found is None:
            return None
        size, rhat = found
        if self._launches > 1:  # a mean of launches stands for as many draws as its variance is smaller than theirs
            single = self._square / self._count - (self._first / self._count) ** 2
            size *= float(np.min(single / draws.astype(np.float64).var(axis=(0, 1))))
        return size * self.chains / self._traced, rhat
