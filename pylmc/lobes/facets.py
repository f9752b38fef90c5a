"""What the lobes of a dielectric surface's microfacets have in common."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from .base import Lobe


@dataclass(frozen=True, kw_only=True)
class DielectricFacets(Lobe):
    """``alpha``: GGX roughness. ``ior``: index of the far side, of an interface the inside, over that of the near one.

    ``separable``: Smith's masking as a product, not height-correlated.
    """

    fields: ClassVar[list[Any]] = [("alpha", np.float64), ("ior", np.float64), ("separable", np.int32)]

    alpha: float
    ior: float
    separable: bool = False

    @property
    def width(self) -> float:
        return self.alpha
