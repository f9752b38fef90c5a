"""The moves of a chain, a file each: one is added by a line here and its name in ``MOVES``."""

from __future__ import annotations

import numpy as np

from ..settings import Settings
from .large import Large
from .move import Move
from .small import Small

# A move's place is its number in the kernels, whose switch is made from this list. Their chances add up to one.
MOVES: tuple[type[Move], ...] = (Large, Small)


def move_numbers(settings: Settings) -> np.ndarray:
    """What markov_step.cl reads, float32: the moves' cumulative chances, then each one's own numbers."""
    chances = np.cumsum([move.chance(settings) for move in MOVES])
    return np.array([*chances, *(number for move in MOVES for number in move.numbers(settings))], np.float32)


def columns(settings: Settings) -> tuple[str, ...]:
    """The names of what is counted, in the order of the counters' columns."""
    return tuple(name for move in MOVES for name in move.columns(settings))


def move_macros(settings: Settings) -> dict[str, object]:
    """Each move's number, and MOVES(F) as markov_step.cl takes it."""
    macros: dict[str, object] = {"NUM_MOVES": len(MOVES)}
    listed, column, number = [], 0, len(MOVES)
    for i, move in enumerate(MOVES):
        word = f"MOVE_{move.name.upper()}"
        macros[word] = i
        listed.append(f"F({word}, {move.name}, {move.state}, {column}, {number})")
        column, number = column + len(move.columns(settings)), number + len(move.numbers(settings))
    return macros | {"MOVES(F)": " ".join(listed)}


def move_files() -> list[str]:
    """The kernel files behind MOVES."""
    return [f"moves/{move.name}.cl" for move in MOVES]
