"""Rough metals and mirrors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ...lobes import Lobe, Reflect
from ..values import as_rgb
from .material import Material
from .microfacets import check_alpha, check_masking


@dataclass(frozen=True)
class RoughConductor(Material):
    """GGX reflection of roughness ``alpha`` with the Smith term, Fresnel factor ``reflectance``, on both sides.

    ``alpha`` is the microfacet slope width itself (not its square root). Its reference is the mirror direction.
    ``masking`` is Smith's term, ``height-correlated`` or ``separable`` (what Mitsuba 3 uses; they agree as alpha -> 0).
    """

    alpha: float = 0.1
    reflectance: Any = 1.0
    masking: str = "height-correlated"

    def __post_init__(self) -> None:
        object.__setattr__(self, "alpha", check_alpha(self.alpha, "RoughConductor"))
        check_masking(self.masking, "RoughConductor")
        object.__setattr__(self, "reflectance", as_rgb(self.reflectance, "RoughConductor.reflectance", 1.0))

    def lobes(self) -> list[Lobe]:
        """What the material is a sum of."""
        return [Reflect(alpha=self.alpha, specular=self.reflectance, separable=self.masking == "separable")]
