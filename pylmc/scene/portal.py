"""Holes that light passes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import PylmcError
from .values import as_point, real_numbers


@dataclass(frozen=True, eq=False)
class Portal:
    """A rectangular hole: ``centre``, unit ``normal``, unit in-plane ``axis``, ``half_size`` along axis and normal × axis."""

    centre: Any
    normal: Any
    axis: Any
    half_size: Any

    def __post_init__(self) -> None:
        for name in ("centre", "normal", "axis"):
            object.__setattr__(self, name, as_point(getattr(self, name), f"Portal.{name}"))
        try:
            half = np.broadcast_to(real_numbers(self.half_size), 2)
        except (TypeError, ValueError):
            raise PylmcError(f"Portal.half_size={self.half_size!r}: give one positive number or two") from None
        if not np.all(np.isfinite(half)) or np.any(half <= 0):
            raise PylmcError(f"Portal.half_size={self.half_size!r} must be positive")
        n = np.linalg.norm(self.normal)
        if not n > 0:
            raise PylmcError("Portal.normal has length zero")
        normal = self.normal / n
        axis = self.axis - (self.axis @ normal) * normal
        if not np.linalg.norm(axis) > 1e-9 * np.linalg.norm(self.axis):
            raise PylmcError("Portal.axis is parallel to its normal; give a vector in the hole's plane")
        object.__setattr__(self, "normal", normal)
        object.__setattr__(self, "axis", axis / np.linalg.norm(axis))
        object.__setattr__(self, "half_size", (float(half[0]), float(half[1])))
