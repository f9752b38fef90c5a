"""GGX reflection by a dielectric coat, counted from the mirror direction; what it lets through is another lobe's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from .base import MIRROR, Lobe


@dataclass(frozen=True, kw_only=True)
class Coat(Lobe):
    """``alpha``: GGX roughness. ``ior``: the coat's index over that of either side. ``separable``: Smith's masking as a
    product, not height-correlated.
    """

    name: ClassVar[str] = "coat"
    reference: ClassVar[str] = MIRROR
    fields: ClassVar[list[Any]] = [("alpha", np.float64), ("ior", np.float64), ("separable", np.int32)]

    alpha: float
    ior: float
    separable: bool = False

    @property
    def width(self) -> float:
        return self.alpha
