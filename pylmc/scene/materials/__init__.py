"""Materials: what a surface does to light, as sums of lobes; a file each, and a line here.

Diffuse and conductor surfaces scatter on both sides; a dielectric separates an inside (against the normal) from an
outside. Reflectances are linear RGB in [0, 1].
"""

from .diffuse import Diffuse as Diffuse
from .material import Material as Material
from .metallic_roughness import MetallicRoughness as MetallicRoughness
from .plastic import Plastic as Plastic
from .rough_conductor import RoughConductor as RoughConductor
from .rough_dielectric import RoughDielectric as RoughDielectric
