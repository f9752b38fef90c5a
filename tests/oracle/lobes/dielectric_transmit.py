"""The refracted part of a dielectric interface (Walter et al. 2007), radiance divided by the square of the relative index."""

from __future__ import annotations

import numpy as np

from ..microfacet import fresnel
from ..vectors import Array, dot
from .facets import facets, half_vector, visible
from .interface import MATERIALS as MATERIALS
from .interface import integrals
from .interface import sample as sample
from .surface import Surface

AIMS = False


def value(s: Surface, wi: Array, wo: Array) -> Array:
    n, eta = s.normal_towards(wi), s.index_ratio(wi)
    m = half_vector(n, wi, wo, eta)
    ci, im, om = dot(n, wi), dot(m, wi), dot(m, wo)
    opposite = (dot(s.ng, wi) * dot(s.ng, wo) < 0) & (dot(n, wo) < 0) & (im > 0) & (om < 0)
    with np.errstate(all="ignore"):
        # Walter et al. (21) times cos θ_o, over the η² by which radiance is compressed
        out = (1 - fresnel(im, eta)) * facets(s, n, m, wi, wo) * -im * om / (ci * (im + eta * om) ** 2)
    return np.where(opposite, out, 0)[:, None] * np.ones(3)


def density(s: Surface, known: Array, other: Array) -> Array:
    n, eta = s.normal_towards(known), s.index_ratio(known)
    m = half_vector(n, known, other, eta)
    im, om = dot(m, known), dot(m, other)
    with np.errstate(all="ignore"):
        out = visible(s, n, m, known) * eta**2 * np.abs(om) / (im + eta * om) ** 2 * (1 - fresnel(im, eta))
    return np.where((dot(n, other) < 0) & (im > 0) & (om < 0), out, 0)


def peak(s: Surface, wi: Array, facet: Array) -> Array:
    eta, cosine = s.index_ratio(wi)[:, None], dot(wi, facet)[:, None]
    return -wi / eta + (cosine / eta - np.sqrt(np.maximum(1 - (1 - cosine**2) / eta**2, 0))) * facet


def totals(s: Surface, wi: Array) -> tuple[float, Array]:
    """Radiance is stretched by η² on the way in; what is conserved is power."""
    found = integrals(s, wi)
    return found.refracted, np.full(3, found.refracted_power / s.index_ratio(wi[None])[0] ** 2)
