"""GGX reflection of a conductor, or of a surface whose Fresnel term is Schlick's, counted from the mirror direction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from .base import COLOUR, MIRROR, Lobe


@dataclass(frozen=True, kw_only=True)
class Reflect(Lobe):
    """``specular`` + ``specular_tinted`` times the material's texture: reflectance at normal incidence, linear RGB.

    ``alpha``: GGX roughness. ``schlick``: whether it grows to one at grazing incidence. ``separable``: Smith's masking as a
    product, not height-correlated.
    """

    name: ClassVar[str] = "reflect"
    reference: ClassVar[str] = MIRROR
    fields: ClassVar[list[Any]] = [
        ("specular", *COLOUR),
        ("specular_tinted", *COLOUR),
        ("alpha", np.float64),
        ("schlick", np.int32),
        ("separable", np.int32),
    ]

    alpha: float
    specular: Any = 0.0
    specular_tinted: Any = 0.0
    schlick: bool = False
    separable: bool = False

    @property
    def width(self) -> float:
        return self.alpha
