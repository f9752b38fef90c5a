"""Point lights."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ..values import as_point, as_power
from .light import POINT, Light, Placement


@dataclass(frozen=True, eq=False)
class PointLight(Light):
    """A point that sends ``intensity`` (RGB, power per steradian) in every direction from ``position``."""

    name: ClassVar[str] = "point"
    place: ClassVar[str] = POINT
    fields: ClassVar[list[Any]] = [("position", np.float64, (3,))]

    position: Any
    intensity: Any = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", as_point(self.position, "PointLight.position"))
        object.__setattr__(self, "intensity", as_power(self.intensity, "PointLight.intensity"))

    def values(self, placement: Placement) -> dict[str, Any]:
        """The record's fields, by name."""
        return {"position": placement.of(self.position)}
