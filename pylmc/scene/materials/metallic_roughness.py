"""glTF's material."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...checks import check_number
from ...colour import LUMINANCE
from ...lobes import Diffuse, Lobe, Reflect
from ..texture import Texture
from ..values import as_rgb
from .material import Material

SMOOTHEST = 1e-3  # alpha of a roughness of zero: a perfect mirror is met by no path


@dataclass(frozen=True)
class MetallicRoughness(Material):
    """glTF's material: a diffuse and a GGX lobe, blended by ``metallic``; alpha = roughness squared.

    diffuse = 0.96 base_color (1 - metallic); specular F0 = mix(0.04, base_color, metallic) with Schlick's Fresnel.
    """

    base_color: Any = 1.0
    metallic: float = 0.0
    roughness: float = 0.5

    def __post_init__(self) -> None:
        if not isinstance(self.base_color, Texture):
            object.__setattr__(self, "base_color", as_rgb(self.base_color, "MetallicRoughness.base_color", 1.0))
        for name in ("metallic", "roughness"):
            object.__setattr__(self, name, check_number(f"MetallicRoughness.{name}", getattr(self, name), 0, 1))

    def lobes(self) -> list[Lobe]:
        """What the material is a sum of: a diffuse base, unless it is a metal, and its gloss."""
        factor = np.ones(3) if self.texture else np.array(self.base_color)
        brightness = float(np.array(self.texture.mean() if self.texture else self.base_color) @ LUMINANCE)
        metallic = self.metallic
        # Schlick's Fresnel term grows towards grazing: leave the specular lobe a share even where F0 is small
        gloss = Reflect(
            share=0.1 + 0.04 * (1 - metallic) + brightness * metallic,
            alpha=max(self.roughness**2, SMOOTHEST),
            specular=0.04 * (1 - metallic),
            specular_tinted=factor * metallic,
            schlick=True,
        )
        # what the dielectric coat reflects at normal incidence does not reach the diffuse base
        base = Diffuse(share=brightness * (1 - metallic), diffuse=factor * (1 - metallic) * (1 - 0.04))
        return [base, gloss] if base.share > 0 else [gloss]
