"""What every lobe has in common: a name, a reference direction, its parameters, and its share of its material's draws.

A material is a sum of lobes (theory.md, 2). A kind of lobe is one file here and one in ``cl_kernels/lobes/``; the kernels'
dispatch, the device's record of a lobe and the tests of all lobes are made from ``pylmc.lobes.KINDS``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

NORMAL, MIRROR, REFRACTED = "normal", "mirror", "refracted"
REFERENCES = (NORMAL, MIRROR, REFRACTED)  # cl_kernels/references/ has a file for each
COLOUR = (np.float64, (3,))  # the type of an RGB field


@dataclass(frozen=True, kw_only=True)
class Lobe:
    """One lobe of a material. ``share``: of the material's draws, in proportion to its other lobes' shares.

    Class attributes. ``name``: of the kernel file and of the functions in it. ``reference``: the direction that deviations
    are counted from. ``fields``: names and NumPy types of the parameters that the kernels read, float64 meaning ``real``;
    lobes that call a parameter alike share its place in the record. ``pair``: 1 for the reflecting one of two lobes that
    are one choice, and follow each other in the material, -1 for the one that refracts, 0 for all others.
    """

    name: ClassVar[str] = ""
    reference: ClassVar[str] = NORMAL
    fields: ClassVar[list[Any]] = []
    pair: ClassVar[int] = 0

    kinds: ClassVar[list[type[Lobe]]] = []  # whoever has a name is registered by it

    share: float = 1.0

    def __init_subclass__(cls, **keywords: Any) -> None:
        super().__init_subclass__(**keywords)
        if "name" in vars(cls):
            Lobe.kinds.append(cls)

    @property
    def width(self) -> float | None:
        """GGX alpha of a lobe that narrows with it, or None for one of constant width."""
        return None

    def values(self) -> dict[str, Any]:
        """The record's fields, by name."""
        return {field[0]: getattr(self, field[0]) for field in self.fields}
