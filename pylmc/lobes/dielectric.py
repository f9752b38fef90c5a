"""The two lobes of a rough interface between dielectrics, which are one choice: the directions say which of them it is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from .base import MIRROR, REFRACTED
from .facets import DielectricFacets


@dataclass(frozen=True, kw_only=True)
class DielectricReflect(DielectricFacets):
    """The reflected part."""

    name: ClassVar[str] = "dielectric_reflect"
    reference: ClassVar[str] = MIRROR
    pair: ClassVar[int] = 1


@dataclass(frozen=True, kw_only=True)
class DielectricTransmit(DielectricFacets):
    """The refracted part, which follows the reflected one in the material."""

    name: ClassVar[str] = "dielectric_transmit"
    reference: ClassVar[str] = REFRACTED
    pair: ClassVar[int] = -1
