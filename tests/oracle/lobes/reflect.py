"""GGX reflection of a conductor, or with Schlick's Fresnel term."""

from __future__ import annotations

import numpy as np

from pylmc.scene import MetallicRoughness, RoughConductor

from ..random import Streams
from ..vectors import Array, magnitude
from .facets import facet_integrals, reflected, reflected_density, reflection_peak, sample_reflection
from .surface import Surface

AIMS = False
MATERIALS = [
    *(
        RoughConductor(alpha, (0.9, 0.8, 0.7), masking)
        for alpha in (1.0, 0.3, 0.05, 1e-3)
        for masking in ("height-correlated", "separable")
    ),
    MetallicRoughness((0.9, 0.4, 0.1), 0.3, 0.6),
    MetallicRoughness((0.9, 0.4, 0.1), 1.0, 0.8),
]
peak = reflection_peak


def value(s: Surface, wi: Array, wo: Array) -> Array:
    micro, cosine = reflected(s, wi, wo)
    f0 = s.material["specular"] + s.material["specular_tinted"] * s.tint
    schlick = f0 + (1 - f0) * ((1 - np.clip(magnitude(cosine), 0, 1)) ** 5)[:, None]
    return micro[:, None] * np.where(s.material["schlick"][:, None] != 0, schlick, f0)


def density(s: Surface, known: Array, other: Array) -> Array:
    return reflected_density(s, known, other)[0]


def sample(s: Surface, known: Array, streams: Streams, wanted: Array) -> tuple[Array, Array]:
    return sample_reflection(s, known, streams, wanted)


def totals(s: Surface, wi: Array) -> tuple[float, Array]:
    drawn, f0 = facet_integrals(s, wi), (s.material["specular"] + s.material["specular_tinted"])[0].astype(float)
    grazing = facet_integrals(s, wi, lambda cosine: (1 - cosine) ** 5).reflected_power if s.material["schlick"][0] else 0.0
    return drawn.reflected, drawn.reflected_power * f0 + grazing * (1 - f0)
