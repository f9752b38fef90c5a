"""Plastics and varnished surfaces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...colour import LUMINANCE
from ...errors import PylmcError
from ...lobes import Coat, CoatedDiffuse, Lobe
from ...lobes.coated_diffuse import coat_table
from ..texture import Texture
from ..values import as_rgb
from .material import Material
from .microfacets import MAX_IOR, check_alpha, check_ior, check_masking


@dataclass(frozen=True)
class Plastic(Material):
    """A diffuse base of ``reflectance`` (RGB or Texture) under a GGX coat of roughness ``alpha`` and index ``ior``.

    Both sides are alike. The coat reflects without colour; what enters leaves again after any number of bounces between
    base and coat, coloured as by one bounce (Mitsuba's ``roughplastic`` with ``nonlinear=false``; a white base gives out at
    most what arrives). ``masking`` as for RoughConductor.
    """

    reflectance: Any = 0.5
    alpha: float = 0.1
    ior: float = 1.49
    masking: str = "height-correlated"

    def __post_init__(self) -> None:
        if not isinstance(self.reflectance, Texture):
            object.__setattr__(self, "reflectance", as_rgb(self.reflectance, "Plastic.reflectance", 1.0))
        object.__setattr__(self, "alpha", check_alpha(self.alpha, "Plastic"))
        check_masking(self.masking, "Plastic")
        ior = check_ior(self.ior, "Plastic")
        if not 1.001 < ior <= MAX_IOR:
            raise PylmcError(
                f"Plastic: ior={ior:g} must be above 1, the index of a coat over air, and at most {MAX_IOR:g} (acrylic: 1.49)"
            )
        object.__setattr__(self, "ior", ior)

    def lobes(self) -> list[Lobe]:
        """What the material is a sum of: its base, unless it is black, and its coat."""
        separable = self.masking == "separable"
        transmitted = coat_table(self.alpha, self.ior, separable)
        colour = self.texture.mean() if self.texture else self.reflectance
        # Fresnel's term grows towards grazing: leave the coat a share even where it reflects little
        coat = Coat(share=0.15, alpha=self.alpha, ior=self.ior, separable=separable)
        base = CoatedDiffuse(
            share=float(np.array(colour) @ LUMINANCE),
            diffuse=1.0 if self.texture else self.reflectance,
            transmitted=transmitted,
        )
        return [base, coat] if base.share > 0 else [coat]
