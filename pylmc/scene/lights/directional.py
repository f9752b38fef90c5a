"""Light from infinity, such as the sun's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ..values import as_direction, as_power
from .light import INFINITY, Light, Placement


@dataclass(frozen=True, eq=False)
class DirectionalLight(Light):
    """Parallel light that travels along ``direction``: ``irradiance`` (RGB, power per area) on a surface across it.

    It fills the whole scene, however large; a room is lit through its openings alone.
    """

    name: ClassVar[str] = "directional"
    place: ClassVar[str] = INFINITY
    fields: ClassVar[list[Any]] = [
        ("direction", np.float64, (3,)),
        ("disc", np.float64),  # radius of the disc across the direction that light paths pass
    ]

    direction: Any
    irradiance: Any = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "direction", as_direction(self.direction, "DirectionalLight.direction"))
        object.__setattr__(self, "irradiance", as_power(self.irradiance, "DirectionalLight.irradiance"))

    def strength(self, placement: Placement) -> np.ndarray:
        """RGB irradiance, the same at every distance."""
        return np.array(self.irradiance)

    def values(self, placement: Placement) -> dict[str, Any]:
        """The record's fields, by name."""
        return {"direction": self.direction, "disc": 1.001 * placement.radius}
