"""The reflected part of a dielectric interface."""

from __future__ import annotations

import numpy as np

from ..microfacet import fresnel
from ..vectors import Array
from .facets import reflected, reflected_density, reflection_peak
from .interface import MATERIALS as MATERIALS
from .interface import integrals
from .interface import sample as sample
from .surface import Surface

AIMS = False
peak = reflection_peak


def value(s: Surface, wi: Array, wo: Array) -> Array:
    micro, cosine = reflected(s, wi, wo)
    return (micro * fresnel(cosine, s.index_ratio(wi)))[:, None] * np.ones(3)


def density(s: Surface, known: Array, other: Array) -> Array:
    drawn, cosine = reflected_density(s, known, other)
    return drawn * fresnel(cosine, s.index_ratio(known))


def totals(s: Surface, wi: Array) -> tuple[float, Array]:
    found = integrals(s, wi)
    return found.reflected, np.full(3, found.reflected_power)
