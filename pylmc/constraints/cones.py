"""Cones: the segment from a spot light stays in its cone, as a direction does in its lobe (Extension of theory.md, 5)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

from ..scene import SpotLight
from .constraint import Constraint, Found


@dataclass(frozen=True)
class Cones(Constraint):
    """``angles``: half-angles in degrees of the spot lights narrower than a half-space; wider ones bound nothing."""

    name: ClassVar[str] = "cones"

    angles: tuple[float, ...]

    @classmethod
    def find(cls, found: Found) -> Self:
        spots = [light for light in found.scene.lights if isinstance(light, SpotLight)]
        return cls(tuple(spot.outer_angle for spot in spots if spot.outer_angle < 90))

    @property
    def present(self) -> bool:
        return bool(self.angles)

    def lines(self) -> list[str]:
        """How many, and the narrowest."""
        return [f"cones       {len(self.angles)} spot light(s), from {min(self.angles):g} degrees"] if self.angles else []
