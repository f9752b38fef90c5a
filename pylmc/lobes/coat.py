"""GGX reflection by a dielectric coat, counted from the mirror direction; what it lets through is another lobe's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from .base import MIRROR
from .facets import DielectricFacets


@dataclass(frozen=True, kw_only=True)
class Coat(DielectricFacets):
    """Alike on both sides: ``ior`` is the coat's index over that of either."""

    name: ClassVar[str] = "coat"
    reference: ClassVar[str] = MIRROR
