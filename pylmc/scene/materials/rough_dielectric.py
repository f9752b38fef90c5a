"""Rough interfaces between transparent media."""

from __future__ import annotations

from dataclasses import dataclass

from ...errors import PylmcError
from ...lobes import DielectricReflect, DielectricTransmit, Lobe
from .material import Material
from .microfacets import MAX_IOR, check_alpha, check_ior, check_masking


@dataclass(frozen=True)
class RoughDielectric(Material):
    """GGX interface (Walter et al. 2007) between outside and a medium of relative index ``ior`` inside.

    Reflects and refracts; radiance carries the 1/eta^2 of the solid-angle compression, as seen from the camera.
    ``masking`` as for RoughConductor.
    """

    alpha: float = 0.1
    ior: float = 1.5
    masking: str = "height-correlated"

    def __post_init__(self) -> None:
        object.__setattr__(self, "alpha", check_alpha(self.alpha, "RoughDielectric"))
        check_masking(self.masking, "RoughDielectric")
        ior = check_ior(self.ior, "RoughDielectric")
        if not (1 / MAX_IOR <= ior <= MAX_IOR and abs(ior - 1) > 1e-3):
            raise PylmcError(
                f"RoughDielectric: ior={ior:g} must lie between {1 / MAX_IOR:g} and {MAX_IOR:g} and differ from 1 (glass: 1.5)"
            )
        object.__setattr__(self, "ior", ior)

    def lobes(self) -> list[Lobe]:
        """What the material is a sum of: two lobes that are one choice."""
        separable = self.masking == "separable"
        return [
            DielectricReflect(alpha=self.alpha, ior=self.ior, separable=separable),
            DielectricTransmit(alpha=self.alpha, ior=self.ior, separable=separable),
        ]
