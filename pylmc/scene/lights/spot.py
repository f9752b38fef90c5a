"""Spot lights."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ...checks import check_number
from ..values import as_direction, as_point, as_power
from .light import POINT, Light, Placement


@dataclass(frozen=True, eq=False)
class SpotLight(Light):
    """A point that sends ``intensity`` (RGB, power per steradian) along ``direction``, and less aside of it.

    Angles are half-angles in degrees, from the axis: full intensity up to ``inner_angle``, none from ``outer_angle`` on, and
    between them the square of a line in the cosine, as in glTF's KHR_lights_punctual.
    """

    name: ClassVar[str] = "spot"
    place: ClassVar[str] = POINT
    fields: ClassVar[list[Any]] = [
        ("position", np.float64, (3,)),
        ("direction", np.float64, (3,)),
        ("spread", np.float64),  # 1 - cos of the angle: narrow cones keep their digits
        ("full_spread", np.float64),
    ]

    position: Any
    direction: Any
    intensity: Any = 1.0
    inner_angle: float = 0.0
    outer_angle: float = 45.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", as_point(self.position, "SpotLight.position"))
        object.__setattr__(self, "direction", as_direction(self.direction, "SpotLight.direction"))
        object.__setattr__(self, "intensity", as_power(self.intensity, "SpotLight.intensity"))
        outer = check_number("SpotLight.outer_angle", self.outer_angle, 0.01, 180, "half-angle in degrees")
        inner = check_number("SpotLight.inner_angle", self.inner_angle, 0, outer, "half-angle in degrees, outer_angle at most,")
        object.__setattr__(self, "outer_angle", outer)
        object.__setattr__(self, "inner_angle", inner)

    def values(self, placement: Placement) -> dict[str, Any]:
        """The record's fields, by name."""
        return {
            "position": placement.of(self.position),
            "direction": self.direction,
            "spread": 2 * np.sin(np.radians(self.outer_angle) / 2) ** 2,
            "full_spread": 2 * np.sin(np.radians(self.inner_angle) / 2) ** 2,
        }
