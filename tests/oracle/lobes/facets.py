"""What lobes of microfacets share: the facet between two directions, and integrals over the facets that one direction sees."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..microfacet import ggx_d_at, shadowing, smith_lambda, visible_normal
from ..random import Streams
from ..vectors import Array, any_tangent, dot, mirror, norm, sphere
from .surface import Surface


def half_vector(n: Array, wi: Array, wo: Array, eta: Array | float = 1.0) -> Array:
    """The microfacet normal between two directions, on n's side; eta: of a refraction."""
    m = wi + np.broadcast_to(eta, len(wi))[:, None] * wo
    m = m / np.maximum(norm(m), 1e-300)[:, None]
    return m * np.where(dot(m, n) < 0, -1, 1)[:, None]


def facets(s: Surface, n: Array, m: Array, wi: Array, wo: Array) -> Array:
    """D G2."""
    return ggx_d_at(m, n, s.alpha) * shadowing(wi, wo, n, s.alpha, s.material["separable"] != 0)


def reflected(s: Surface, wi: Array, wo: Array) -> tuple[Array, Array]:
    """(D G2 / (4 cos θ_i), 0 where the directions are not on one side; cosine at the facet)."""
    n = s.normal_towards(wi)
    m = half_vector(n, wi, wo)
    with np.errstate(all="ignore"):
        value = facets(s, n, m, wi, wo) / (4 * dot(n, wi))
    return np.where(s.same_side(wi, wo), value, 0), dot(m, wi)


def visible(s: Surface, n: Array, m: Array, known: Array) -> Array:
    """Density of drawing the facet normal m, visible from ``known``."""
    return ggx_d_at(m, n, s.alpha) / (1 + smith_lambda(known, n, s.alpha)) * np.maximum(dot(m, known), 0) / dot(n, known)


def reflected_density(s: Surface, known: Array, other: Array) -> tuple[Array, Array]:
    """(density of reflecting at a visible facet; cosine at the facet)."""
    n = s.normal_towards(known)
    m = half_vector(n, known, other)
    with np.errstate(all="ignore"):
        density = visible(s, n, m, known) / (4 * np.abs(dot(m, other)))
    return np.where((dot(n, other) > 0) & (dot(n, known) > 0), density, 0), dot(m, known)


def drawn_facet(s: Surface, known: Array, streams: Streams, wanted: Array) -> Array:
    """A visible facet's normal."""
    n = s.normal_towards(known)
    u1, u2 = streams.uniform(wanted), streams.uniform(wanted)
    return visible_normal(known, n, s.alpha, u1, u2, any_tangent(n))


def sample_reflection(s: Surface, known: Array, streams: Streams, wanted: Array) -> tuple[Array, Array]:
    """Reflection at a visible facet."""
    h = drawn_facet(s, known, streams, wanted)
    out = 2 * dot(known, h)[:, None] * h - known
    return out, wanted & (dot(known, h) > 0) & (dot(out, s.normal_towards(known)) > 0)


def reflection_peak(s: Surface, wi: Array, facet: Array) -> Array:
    """Where a facet near the shading normal reflects to."""
    return -mirror(wi, facet)


class FacetIntegrals(NamedTuple):
    reflected: float  # probability that a drawn facet reflects, to a direction on the right side
    refracted: float
    reflected_power: float  # the same times G2 / G1: what comes out, per unit of light
    refracted_power: float


def facet_integrals(s: Surface, wi: Array, share: Callable[[Array], Array] = np.ones_like, eta: float = 1.0) -> FacetIntegrals:
    """Integrals over visible facet normals, density G1 D max(w_i.h, 0) / cos θ_i, for one node and ``wi`` (3,).

    ``share``: which part a facet reflects, by the cosine at it; the rest it refracts, ``eta`` being the far index over the
    near one. Another way to albedos than integrals over directions.
    """
    up_axis, alpha = s.normal_towards(wi[None])[0], s.alpha[0]
    h, weight = sphere(160, 320, up_axis)
    keep = dot(h, up_axis) > 0
    h, weight = h[keep], weight[keep]
    n = np.broadcast_to(up_axis, h.shape)
    ki = h @ wi
    seen = weight * ggx_d_at(h, n, alpha) * np.maximum(ki, 0) / (up_axis @ wi) / (1 + smith_lambda(wi, up_axis, alpha))
    r = -mirror(np.broadcast_to(wi, h.shape), h)
    reflects = share(np.clip(ki, 0, 1))
    t = (ki / eta - np.sqrt(np.maximum(1 - (1 - ki**2) / eta**2, 0)))[:, None] * h - wi / eta

    def masked(w: Array) -> Array:
        i, o = smith_lambda(wi, up_axis, alpha), smith_lambda(w, n, alpha)
        return (1 / (1 + o)) if s.material["separable"][0] else (1 + i) / (1 + i + o)

    up, down = (ki > 0) & (r @ up_axis > 0), (ki > 0) & (t @ up_axis < 0)
    return FacetIntegrals(
        float((seen * reflects)[up].sum()),
        float((seen * (1 - reflects))[down].sum()),
        float((seen * reflects * masked(r))[up].sum()),
        float((seen * (1 - reflects) * masked(t))[down].sum()),
    )
