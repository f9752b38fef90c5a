"""Diffuse surfaces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ...lobes import Diffuse as DiffuseLobe
from ...lobes import Lobe
from ..texture import Texture
from ..values import as_rgb
from .material import Material


@dataclass(frozen=True)
class Diffuse(Material):
    """Lambertian reflection on both sides: f = reflectance / pi. Its reference direction is the normal."""

    reflectance: Any = 0.5

    def __post_init__(self) -> None:
        if not isinstance(self.reflectance, Texture):
            object.__setattr__(self, "reflectance", as_rgb(self.reflectance, "Diffuse.reflectance", 1.0))

    def lobes(self) -> list[Lobe]:
        """What the material is a sum of."""
        return [DiffuseLobe(diffuse=1.0 if self.texture else self.reflectance)]
