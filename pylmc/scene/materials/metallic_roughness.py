"""glTF's material."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ...checks import check_number
from ..texture import Texture
from ..values import as_rgb
from .material import Material


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
