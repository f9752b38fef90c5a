"""The small step: a leading block of the path's directions moves by a preconditioned Langevin step."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from ..settings import Settings
from .move import Move


class Small(Move):
    """theory.md, 3. Its numbers are the bounds of log h; it is counted by how many directions move."""

    name: ClassVar[str] = "small"
    state: ClassVar[str] = "SmallStep"

    @classmethod
    def chance(cls, settings: Settings, features: Mapping[str, Any]) -> None:
        """What the other moves leave."""
        return None

    @classmethod
    def numbers(cls, settings: Settings) -> tuple[float, ...]:
        low, high = settings.step_length
        return float(np.log(low)), float(np.log(high))

    @classmethod
    def columns(cls, settings: Settings) -> tuple[str, ...]:
        return tuple(f"small, first {m} directions" for m in range(1, settings.max_depth + 1))
