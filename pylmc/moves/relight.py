"""Relight: the path is joined to another light, and all the rest of it stays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from ..settings import Settings
from .move import Move


class Relight(Move):
    """Where a scene has several lights without area (Extension of theory.md, 6). Paths that end on an emitter stay."""

    name: ClassVar[str] = "relight"
    state: ClassVar[str] = "RelightStep"

    @classmethod
    def chance(cls, settings: Settings, features: Mapping[str, Any]) -> float:
        return settings.light_steps * (1 - settings.large_steps) if features["NUM_LIGHTS"] > 1 else 0.0
