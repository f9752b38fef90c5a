"""The moves of a chain, a file each: one is added by a line here and its name in ``MOVES``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..settings import Settings
from .large import Large
from .move import Move
from .relight import Relight
from .small import Small

# Their chances add up to one. The large step is always there: a chain without a path can make no other.
MOVES: tuple[type[Move], ...] = (Large, Small, Relight)


class Moves:
    """The moves that a run makes, with these ``settings`` in a scene of these ``features``."""

    def __init__(self, settings: Settings, features: Mapping[str, Any]) -> None:
        given = {move: move.chance(settings, features) for move in MOVES}
        rest = 1 - sum(chance for chance in given.values() if chance is not None)
        chances = {move: rest if chance is None else chance for move, chance in given.items()}
        self.settings, self.chosen = settings, [move for move in MOVES if move is Large or chances[move] > 0]
        self._chances = [chances[move] for move in self.chosen]

    def numbers(self) -> np.ndarray:
        """What markov_step.cl reads, float32: the moves' cumulative chances, then each one's own numbers."""
        own = (number for move in self.chosen for number in move.numbers(self.settings))
        return np.array([*np.cumsum(self._chances), *own], np.float32)

    def columns(self) -> tuple[str, ...]:
        """The names of what is counted, in the order of the counters' columns."""
        return tuple(name for move in self.chosen for name in move.columns(self.settings))

    def macros(self) -> dict[str, object]:
        """Each move's number, and MOVES(F) as markov_step.cl takes it."""
        macros: dict[str, object] = {"NUM_MOVES": len(self.chosen)}
        listed, column, number = [], 0, len(self.chosen)
        for i, move in enumerate(self.chosen):
            word = f"MOVE_{move.name.upper()}"
            macros[word] = i
            listed.append(f"F({word}, {move.name}, {move.state}, {column}, {number})")
            column, number = column + len(move.columns(self.settings)), number + len(move.numbers(self.settings))
        return macros | {"MOVES(F)": " ".join(listed)}

    def files(self) -> list[str]:
        """The kernel files behind MOVES."""
        return [f"moves/{move.name}.cl" for move in self.chosen]
