"""Radiance known without a renderer: integrals over a pixel's area and over microfacet normals, in float64.

Independent of the kernels and of ``reference.py``: albedos are integrals over microfacet normals, of which a renderer never
samples all, and no sampling density occurs.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from pylmc.scene import Camera

Array = np.ndarray


def pixel_means(camera: Camera, radiance: Callable[[Array], Array], nodes: int = 4) -> Array:
    """Means over every pixel (height, width, ...) of ``radiance``, a function of unit directions (n, 3).

    A product of Gauss-Legendre rules of ``nodes`` by ``nodes`` points in each pixel: a pixel is a mean over its area.
    """
    at, weight = np.polynomial.legendre.leggauss(nodes)
    at, weight = (at + 1) / 2, weight / 2
    x = ((np.arange(camera.width)[:, None] + at) / camera.width).reshape(-1)
    y = ((np.arange(camera.height)[:, None] + at) / camera.height).reshape(-1)
    right, up, forward = camera.axes()
    half = np.tan(np.radians(camera.fov) / 2)
    across = (2 * x - 1)[None, :, None] * half * camera.width / camera.height
    down = (1 - 2 * y)[:, None, None] * half
    directions = forward + across * right + down * up
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    values = radiance(directions.reshape(-1, 3))
    values = values.reshape(camera.height, nodes, camera.width, nodes, -1)
    return np.einsum("iajbc,a,b->ijc", values, weight, weight)


def fresnel_reflectance(cosine: Array, eta: float) -> Array:
    """Unpolarised reflectance of a dielectric at the cosine of incidence; eta: index beyond over index before.

    From Snell's law as amplitudes of angles: (sin(i - t) / sin(i + t))² and (tan(i - t) / tan(i + t))², with the limit at 0.
    """
    i = np.arccos(np.clip(cosine, 0, 1 - 1e-12))
    sine = np.sin(i) / eta
    t = np.arcsin(np.minimum(sine, 1))
    s = np.sin(i - t) / np.sin(i + t)
    p = np.tan(i - t) / np.tan(i + t)
    return np.where(sine >= 1, 1.0, (s**2 + p**2) / 2)


class Albedo(NamedTuple):
    """Parts of the power that arrives in one direction: reflected and refracted. What is missing is scattered twice or more
    among the microfacets, which a single-scattering lobe leaves out."""

    reflected: Array
    refracted: Array


def ggx_albedo(cosine: Array, alpha: float, eta: float | None, separable: bool, nodes: int = 512) -> Albedo:
    """Directional albedo of a GGX surface at cosines of incidence (n,); eta None: all is reflected.

    albedo = ∫ F G2 D(h) |i·h| / cos θ_i dh, the Jacobian from h to the outgoing direction being cancelled by the lobe's. With
    u = tan² θ_h / (tan² θ_h + α²), D(h) cos θ_h dh is du dφ / 2π, so that the albedo is the mean over u and φ of
    F G2 |i·h| / (cos θ_i cos θ_h): midpoint rules in φ and, for the root at its end, in the square root of 1 - u.
    """
    root = (np.arange(nodes) + 0.5) / nodes
    u, weight = 1 - root**2, 2 * root / nodes
    tangent = alpha * np.sqrt(u / (1 - u))
    ch = 1 / np.sqrt(1 + tangent**2)
    phi = (np.arange(nodes // 2) + 0.5) * np.pi / (nodes // 2)  # symmetric about the plane of incidence
    hx, hz = (tangent * ch)[:, None] * np.cos(phi), np.broadcast_to(ch[:, None], (nodes, nodes // 2))

    def smith(c: Array) -> Array:
        return (np.sqrt(1 + alpha**2 * (1 / np.maximum(c**2, 1e-30) - 1)) - 1) / 2

    def masking(before: Array, after: Array) -> Array:
        return 1 / ((1 + before) * (1 + after)) if separable else 1 / (1 + before + after)

    found = []
    for ci in np.atleast_1d(cosine):
        ih = np.sqrt(1 - ci**2) * hx + ci * hz
        part = weight[:, None] / (nodes // 2) * np.maximum(ih, 0) / (ci * hz)
        reflectance = np.ones_like(ih) if eta is None else fresnel_reflectance(ih, eta)
        up = 2 * ih * hz - ci
        lambda_i = smith(np.asarray(ci))
        reflected = (part * reflectance * masking(lambda_i, smith(up)))[(ih > 0) & (up > 0)].sum()
        if eta is None:
            found.append((reflected, 0.0))
            continue
        under = np.sqrt(np.maximum(1 - (1 - ih**2) / eta**2, 0))
        down = (ih / eta - under) * hz - ci / eta
        refracted = (part * (1 - reflectance) * masking(lambda_i, smith(down)))[(ih > 0) & (down < 0)].sum()
        found.append((reflected, refracted))
    return Albedo(*np.array(found).T)
