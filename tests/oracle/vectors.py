"""Vectors over the last axis; all but any_tangent let complex steps through."""

from __future__ import annotations

import numpy as np

Array = np.ndarray


def dot(a: Array, b: Array) -> Array:
    """Inner products, without conjugation."""
    return np.einsum("...i,...i->...", a, b)


def norm(a: Array) -> Array:
    """Lengths."""
    return np.sqrt(dot(a, a))


def unit(a: Array) -> Array:
    """Normalised."""
    return a / np.maximum(norm(a), 1e-300)[..., None]


def magnitude(a: Array) -> Array:
    """|a| of numbers, smooth away from zero."""
    return np.where(a.real < 0, -a, a)


def mirror(v: Array, n: Array) -> Array:
    """v reflected about the plane across n."""
    return v - 2 * dot(v, n)[..., None] * n


def turn_minimally(u: Array, a: Array, b: Array) -> Array:
    """u turned by the rotation about a × b that takes a to b (Rodrigues' formula; any u, not only one across a)."""
    axis, cosine = np.cross(a, b), dot(a, b)[..., None]
    return cosine * u + np.cross(axis, u) + axis * dot(axis, u)[..., None] / (1 + cosine)


def any_tangent(n: Array) -> Array:
    """The kernels' convention for a tangent of n (Duff et al. 2017)."""
    s = np.copysign(1.0, n[..., 2])
    a = -1 / (s + n[..., 2])
    return np.stack([1 + s * n[..., 0] ** 2 * a, s * n[..., 0] * n[..., 1] * a, -s * n[..., 0]], axis=-1)


def about(axis: Array, cosine: Array, angle: Array) -> Array:
    """Unit vectors at a cosine and azimuth about unit vectors."""
    tangent = any_tangent(axis)
    sine = np.sqrt(np.maximum(1 - cosine**2, 0))
    flat = np.cos(angle)[:, None] * tangent + np.sin(angle)[:, None] * np.cross(axis, tangent)
    return sine[:, None] * flat + cosine[:, None] * axis


def sphere(n_cos: int, n_phi: int, n: Array) -> tuple[Array, Array]:
    """Directions and weights of a quadrature over the sphere about the axis n (3,).

    Gauss-Legendre in cos θ, on either side of the equator, times the midpoint rule in φ.
    """
    z, weight = np.polynomial.legendre.leggauss(n_cos)
    z, weight = np.concatenate([(z - 1) / 2, (z + 1) / 2]), np.concatenate([weight, weight]) / 2
    phi = (np.arange(n_phi) + 0.5) * 2 * np.pi / n_phi
    sine = np.sqrt(1 - z**2)[:, None]
    tangent = unit(np.cross(n, [1.0, 0.0, 0.0]))
    frame = np.stack([tangent, np.cross(n, tangent), n])
    local = np.stack([sine * np.cos(phi), sine * np.sin(phi), np.broadcast_to(z[:, None], (len(z), n_phi))], axis=-1)
    return local.reshape(-1, 3) @ frame, np.repeat(weight * 2 * np.pi / n_phi, n_phi)
