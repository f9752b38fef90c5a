"""The reflection of a dielectric coat, alike on both sides."""

from __future__ import annotations

import numpy as np

from pylmc.scene import Plastic

from ..microfacet import fresnel
from ..random import Streams
from ..vectors import Array
from .facets import facet_integrals, reflected, reflected_density, reflection_peak, sample_reflection
from .surface import Surface

AIMS = False
MATERIALS = [
    Plastic((0.9, 0.5, 0.1), alpha, ior, masking)
    for alpha, ior in ((0.4, 1.5), (0.2, 1.9), (0.02, 1.33))
    for masking in ("height-correlated", "separable")
]
peak = reflection_peak


def value(s: Surface, wi: Array, wo: Array) -> Array:
    micro, cosine = reflected(s, wi, wo)
    return (micro * fresnel(cosine, s.material["ior"]))[:, None] * np.ones(3)


def density(s: Surface, known: Array, other: Array) -> Array:
    return reflected_density(s, known, other)[0]


def sample(s: Surface, known: Array, streams: Streams, wanted: Array) -> tuple[Array, Array]:
    return sample_reflection(s, known, streams, wanted)


def totals(s: Surface, wi: Array) -> tuple[float, Array]:
    drawn = facet_integrals(s, wi).reflected
    return drawn, np.full(3, facet_integrals(s, wi, lambda c: fresnel(c, np.float64(s.material["ior"][0]))).reflected_power)
