"""The large step: an independent path of the same length and ending."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from ..settings import Settings
from .move import Move


class Large(Move):
    """Drawn by the bidirectional independent sampler (theory.md, 6); the one move that a chain without a path can make."""

    name: ClassVar[str] = "large"
    state: ClassVar[str] = "LargeStep"

    @classmethod
    def chance(cls, settings: Settings, features: Mapping[str, Any]) -> float:
        return settings.large_steps
