"""The lobes that materials are sums of: the host's half of each, a file each (the device's: ``cl_kernels/lobes/``)."""

from .base import REFERENCES, Lobe
from .dielectric import DielectricReflect, DielectricTransmit
from .diffuse import Diffuse
from .reflect import Reflect

# A kind's place is its number: LOBE_<NAME> in the kernels, and what `States.lobes` shows.
KINDS: tuple[type[Lobe], ...] = (Diffuse, Reflect, DielectricReflect, DielectricTransmit)

__all__ = ["KINDS", "REFERENCES", "DielectricReflect", "DielectricTransmit", "Diffuse", "Lobe", "Reflect"]
