"""Materials: what a surface does to light, as sums of lobes; a file each.

Diffuse and conductor surfaces scatter on both sides; a dielectric separates an inside (against the normal) from an
outside. Reflectances are linear RGB in [0, 1].
"""

from .diffuse import Diffuse
from .metallic_roughness import MetallicRoughness
from .rough_conductor import RoughConductor
from .rough_dielectric import RoughDielectric

Material = Diffuse | RoughConductor | RoughDielectric | MetallicRoughness

__all__ = ["Diffuse", "Material", "MetallicRoughness", "RoughConductor", "RoughDielectric"]
