"""The lobes that materials are sums of: the host's half, a file and a line here each (the device's: ``cl_kernels/lobes/``)."""

from .base import REFERENCES as REFERENCES
from .base import Lobe as Lobe
from .coat import Coat as Coat
from .coated_diffuse import CoatedDiffuse as CoatedDiffuse
from .dielectric import DielectricReflect as DielectricReflect
from .dielectric import DielectricTransmit as DielectricTransmit
from .diffuse import Diffuse as Diffuse
from .reflect import Reflect as Reflect

# A kind's place is its number: LOBE_<NAME> in the kernels, and what `States.lobes` shows.
KINDS: tuple[type[Lobe], ...] = tuple(sorted(Lobe.kinds, key=lambda kind: kind.name))
