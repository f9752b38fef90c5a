"""The lobes of a node: value, density of its own sampling, and reference direction (theory.md, 1 and 2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .microfacet import fresnel, ggx_d_at, shadowing, smith_lambda
from .vectors import Array, dot, magnitude, mirror, norm, unit

DIFFUSE, REFLECT, DIELECTRIC_REFLECT, TRANSMIT = range(4)


@dataclass(frozen=True)
class Surface:
    """Nodes' local properties, batched: geometric and shading normal, texture colour, material record, lobe."""

    x: Array
    ng: Array
    ns: Array
    tint: Array
    material: Array
    lobe: Array

    @property
    def alpha(self) -> Array:
        """GGX roughness; of lobes without one, any positive number."""
        return np.maximum(self.material["alpha"].astype(float), 1e-9)

    def index_ratio(self, w: Array) -> Array:
        """Index of the far side over that of w's side."""
        ior = np.where(self.material["ior"] > 0, self.material["ior"], 1.0).astype(float)
        return np.where(dot(self.ns, w) > 0, ior, 1 / ior)

    @property
    def has_lobe(self) -> Array:
        """Whether the material has the lobe at all: mixed ones have two, a dielectric's two lobes are one choice."""
        diffuse, dielectric = self.material["choose_diffuse"], self.material["ior"] > 0
        glossy = (diffuse < 1) & ((self.lobe != REFLECT) == dielectric)
        return np.where(self.lobe == DIFFUSE, diffuse > 0, glossy)

    @property
    def narrow(self) -> Array:
        """Whether the node scatters as a near-mirror: a property of material and lobe alone."""
        return (self.lobe != DIFFUSE) & (self.material["narrow"] != 0)


def half_vectors(s: Surface, wi: Array, wo: Array) -> tuple[Array, Array, Array]:
    """(n on w_i's side, microfacet normal on n's side, eta of the refraction or one)."""
    n = np.where(dot(s.ns, wi)[:, None] > 0, s.ns, -s.ns)
    eta = np.where(s.lobe == TRANSMIT, s.index_ratio(wi), 1.0)
    m = wi + eta[:, None] * wo
    m = m / np.maximum(norm(m), 1e-300)[:, None]
    return n, m * np.where(dot(m, n) < 0, -1, 1)[:, None], eta


def lobe_value(s: Surface, wi: Array, wo: Array) -> Array:
    """f |cos θ_o| of each surface's own lobe as RGB, radiance convention (camera's side w_i)."""
    n, m, eta = half_vectors(s, wi, wo)
    ci, co, im, om = dot(n, wi), dot(n, wo), dot(m, wi), dot(m, wo)
    agree_i = dot(s.ns, wi) * dot(s.ng, wi) > 0
    same = agree_i & (dot(s.ng, wi) * dot(s.ng, wo) > 0) & (co > 0)
    opposite = agree_i & (dot(s.ng, wi) * dot(s.ng, wo) < 0) & (co < 0) & (im > 0) & (om < 0)
    with np.errstate(all="ignore"):
        micro = ggx_d_at(m, n, s.alpha) * shadowing(wi, wo, n, s.alpha, s.material["separable"] != 0)
        reflection = micro / (4 * ci)
        # Walter et al. (21) times cos θ_o, over the η² by which radiance is compressed
        refraction = (1 - fresnel(im, eta)) * micro * -im * om / (ci * (im + eta * om) ** 2)
        f0 = s.material["specular"] + s.material["specular_tinted"] * s.tint
        schlick = f0 + (1 - f0) * ((1 - np.clip(magnitude(im), 0, 1)) ** 5)[:, None]
        coloured = np.where(s.material["schlick"][:, None] != 0, schlick, f0)
        both = fresnel(im, s.index_ratio(wi))[:, None] * np.ones(3)
    out = np.zeros((len(wi), 3), np.result_type(reflection, coloured))
    for lobe, mask, value in (
        (DIFFUSE, same, (co / np.pi)[:, None] * s.material["diffuse"] * s.tint),
        (REFLECT, same, reflection[:, None] * coloured),
        (DIELECTRIC_REFLECT, same, reflection[:, None] * both),
        (TRANSMIT, opposite, refraction[:, None] * np.ones(3)),
    ):
        use = mask & (s.lobe == lobe)
        out[use] = value[use]
    return out


def lobe_density(s: Surface, known: Array, other: Array) -> Array:
    """Density per solid angle of the lobe's own sampling (no aiming): cosine, or visible normals (Heitz 2018)."""
    n, m, eta = half_vectors(s, known, other)
    ci, co, im, om = dot(n, known), dot(n, other), dot(m, known), dot(m, other)
    with np.errstate(all="ignore"):
        visible = ggx_d_at(m, n, s.alpha) / (1 + smith_lambda(known, n, s.alpha)) * np.maximum(im, 0) / ci
        reflected = visible / (4 * np.abs(om))
        refracted = visible * eta**2 * np.abs(om) / (im + eta * om) ** 2 * (1 - fresnel(im, eta))
        shared = fresnel(im, s.index_ratio(known))
        reflected_share = reflected * shared
    sides = (dot(s.ns, known) * dot(s.ns, other) > 0) & (dot(s.ng, known) * dot(s.ng, other) > 0)
    out = np.zeros(len(known))
    for lobe, mask, value in (
        (DIFFUSE, sides, np.abs(dot(s.ns, other)) / np.pi),
        (REFLECT, (co > 0) & (ci > 0), reflected),
        (DIELECTRIC_REFLECT, (co > 0) & (ci > 0), reflected_share),
        (TRANSMIT, (co < 0) & (im > 0) & (om < 0), refracted),
    ):
        use = mask & (s.lobe == lobe)
        out[use] = value[use]
    return out


def reference_direction(s: Surface, v: Array) -> Array:
    """Mirror direction, refracted direction (Snell in vectors), or the normal on the side of arrival."""
    n = np.where(dot(s.ns, v)[:, None] < 0, s.ns, -s.ns)
    tangential = (v - dot(v, n)[:, None] * n) / s.index_ratio(-v)[:, None]
    cosine2 = 1 - dot(tangential, tangential)
    down = np.sqrt(np.where(cosine2 > 0, cosine2, 0))[:, None]
    refracted = unit(tangential - down * n)
    out = np.where((s.lobe == DIFFUSE)[:, None], n, mirror(v, n))
    return np.where((s.lobe == TRANSMIT)[:, None], refracted, out)
