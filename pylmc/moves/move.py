"""What all moves of a chain are: how often they are made, and how they are counted. The rest is the kernels'."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from ..settings import Settings


class Move:
    """Base of all moves. ``name``: of the kernel file and of the functions in it; ``state``: of what its stages hand on."""

    name: ClassVar[str] = ""
    state: ClassVar[str] = ""

    @classmethod
    def chance(cls, settings: Settings, features: Mapping[str, Any]) -> float | None:
        """The probability that a step is this move, in a scene with these ``features``.

        0: it is left out of the kernels. None, of one move alone: whatever the others leave.
        """
        raise NotImplementedError

    @classmethod
    def numbers(cls, settings: Settings) -> tuple[float, ...]:
        """What its kernels read, in single precision: as many whatever the settings are."""
        return ()

    @classmethod
    def columns(cls, settings: Settings) -> tuple[str, ...]:
        """What it is counted by, one name or more."""
        return (cls.name,)
