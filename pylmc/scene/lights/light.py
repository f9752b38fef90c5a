"""What all lights are that are no surfaces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ..kinds import Kind
from ..values import RGB

POINT, INFINITY = "point", "infinity"  # the places of lights: with a position, or with a direction alone


@dataclass(frozen=True, eq=False)
class Placement:
    """How the compiled scene is placed: x becomes (x - ``centre``) / ``scale``; ``radius`` is of the whole, scaled."""

    centre: np.ndarray
    scale: float
    radius: float

    def of(self, position: Any) -> np.ndarray:
        """A position (3,) in the compiled scene."""
        return (np.asarray(position, float) - self.centre) / self.scale


class Light(Kind):
    """Base of all lights, which are frozen dataclasses that check their fields. A subclass is registered by itself.

    Class attributes. ``name``: of the kernel file and of the functions in it. ``place``: what the end of a path is there.
    ``fields``: names and NumPy types of the parameters that the kernels read, float64 meaning ``real``; lights that call a
    parameter alike share its place in the record.
    """

    name: ClassVar[str] = ""
    place: ClassVar[str] = POINT
    fields: ClassVar[list[Any]] = []

    intensity: RGB

    def strength(self, placement: Placement) -> np.ndarray:
        """RGB that the kernels multiply what the light sends with: of lights with a position, irradiance at distance one."""
        return np.array(self.intensity) / placement.scale**2

    def values(self, placement: Placement) -> dict[str, Any]:
        """The record's fields, by name."""
        raise TypeError(f"{type(self).__name__} says nothing of its fields")
