"""The two lobes of a rough interface between dielectrics, which are one choice: the directions say which of them it is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from .base import MIRROR, REFRACTED, Lobe


@dataclass(frozen=True, kw_only=True)
class Interface(Lobe):
    """What both lobes have. ``alpha``: GGX roughness. ``ior``: index of the inside over the outside's.

    ``separable``: Smith's masking as a product, not height-correlated.
    """

    fields: ClassVar[list[Any]] = [("alpha", np.float64), ("ior", np.float64), ("separable", np.int32)]

    alpha: float
    ior: float
    separable: bool = False

    @property
    def width(self) -> float:
        return self.alpha


@dataclass(frozen=True, kw_only=True)
class DielectricReflect(Interface):
    """The reflected part."""

    name: ClassVar[str] = "dielectric_reflect"
    reference: ClassVar[str] = MIRROR
    pair: ClassVar[int] = 1


@dataclass(frozen=True, kw_only=True)
class DielectricTransmit(Interface):
    """The refracted part, which follows the reflected one in the material."""

    name: ClassVar[str] = "dielectric_transmit"
    reference: ClassVar[str] = REFRACTED
    pair: ClassVar[int] = -1
