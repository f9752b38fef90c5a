"""What the two lobes of a dielectric interface share: one draw, whose facet reflects or refracts by its Fresnel term."""

from __future__ import annotations

import numpy as np

from pylmc.scene import RoughDielectric

from ..microfacet import fresnel
from ..random import Streams
from ..vectors import Array, dot, unit
from .facets import FacetIntegrals, drawn_facet, facet_integrals
from .surface import Surface

MATERIALS = [
    RoughDielectric(alpha, ior, masking)
    for alpha, ior in ((0.5, 1.5), (0.2, 1.5), (0.3, 0.75), (0.05, 1.33))
    for masking in ("height-correlated", "separable")
]


def sample(s: Surface, known: Array, streams: Streams, wanted: Array) -> tuple[Array, Array]:
    n, h, eta = s.normal_towards(known), drawn_facet(s, known, streams, wanted), s.index_ratio(known)
    kh = dot(known, h)
    ok = wanted & (kh > 0)
    through = ok & (streams.uniform(ok) >= fresnel(kh, eta))
    cosine_t = np.sqrt(np.maximum(1 - (1 - kh**2) / eta**2, 0))
    refracted = unit((kh / eta - cosine_t)[:, None] * h - known / eta[:, None])
    out = np.where(through[:, None], refracted, 2 * kh[:, None] * h - known)
    return out, ok & np.where(through, dot(out, n) < 0, dot(out, n) > 0)


def integrals(s: Surface, wi: Array) -> FacetIntegrals:
    eta = float(s.index_ratio(wi[None])[0])
    return facet_integrals(s, wi, lambda cosine: fresnel(cosine, np.float64(eta)), eta)
