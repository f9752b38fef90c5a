"""GGX microfacets in angles and tangents (Walter et al. 2007), and Fresnel's formulas."""

from __future__ import annotations

import numpy as np

from .vectors import Array, dot


def ggx_d(cosine: Array, alpha: Array) -> Array:
    """GGX distribution in the angle θ of the microfacet normal: α² / (π cos⁴θ (α² + tan²θ)²)."""
    c2 = np.clip(cosine, 1e-150, 1) ** 2
    tan2 = (1 - c2) / c2
    return np.where(cosine > 0, alpha**2 / (np.pi * c2**2 * (alpha**2 + tan2) ** 2), 0.0)


def ggx_d_at(m: Array, n: Array, alpha: Array) -> Array:
    """The same from vectors; tan θ as a ratio of lengths, exact for the narrowest lobes."""
    c = dot(m, n)
    sine = np.cross(m, n)
    tan2 = dot(sine, sine) / np.maximum(c**2, 1e-300)
    return np.where(c > 0, alpha**2 / (np.pi * c**4 * (alpha**2 + tan2) ** 2), 0.0)


def smith_lambda(w: Array, n: Array, alpha: Array) -> Array:
    """Smith's Λ of GGX."""
    sine = np.cross(w, n)
    tan2 = dot(sine, sine) / dot(w, n) ** 2
    return (np.sqrt(1 + alpha**2 * tan2) - 1) / 2


def shadowing(wi: Array, wo: Array, n: Array, alpha: Array, separable: Array) -> Array:
    """G2, height-correlated or the product of both G1."""
    i, o = smith_lambda(wi, n, alpha), smith_lambda(wo, n, alpha)
    return np.where(separable, 1 / (1 + i) / (1 + o), 1 / (1 + i + o))


def fresnel(cosine: Array, eta: Array) -> Array:
    """Unpolarised reflectance from the angles of incidence and refraction (Snell); eta: far index over near."""
    sine2_t = np.maximum(1 - cosine**2, 0) / eta**2
    inside = sine2_t < 1
    ct = np.sqrt(np.where(inside, 1 - sine2_t, 0))
    with np.errstate(invalid="ignore"):  # 0 / 0 in the surface itself
        rs = (cosine - eta * ct) / (cosine + eta * ct)
        rp = (ct - eta * cosine) / (ct + eta * cosine)
    return np.where(inside, (rs**2 + rp**2) / 2, 1.0)


def visible_normal(w: Array, n: Array, alpha: Array, u1: Array, u2: Array, tangent: Array) -> Array:
    """A normal drawn with density G1(w) D(h) |w.h| / |w.n| (Dupuy and Benyoub 2023): w mirrored in the stretched cap."""
    axes = np.stack([tangent, np.cross(n, tangent), n], axis=-2)
    stretch = np.stack([alpha, alpha, np.ones_like(alpha)], axis=-1)
    local = np.einsum("nij,nj->ni", axes, w) * stretch
    local = local / np.maximum(np.linalg.norm(local, axis=-1, keepdims=True), 1e-300)
    z = 1 - u2 * (1 + local[:, 2])  # uniform between -local_z and 1
    sine = np.sqrt(np.maximum(1 - z**2, 0))
    cap = np.stack([sine * np.cos(2 * np.pi * u1), sine * np.sin(2 * np.pi * u1), z], axis=-1)
    h = np.einsum("ni,nij->nj", (cap + local) * stretch, axes)
    return h / np.linalg.norm(h, axis=-1, keepdims=True)
