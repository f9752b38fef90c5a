"""A diffuse base under a rough dielectric coat, counted from the normal: light enters and leaves through the coat."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np

from .base import COLOUR, NORMAL, Lobe

NODES = 64  # cosines at which the coat's transmittance is tabulated, 0 to 1; between them it is linear
_FACETS = 64  # microfacet normals along each of their two random numbers, by Gauss and Legendre


@dataclass(frozen=True, kw_only=True)
class CoatedDiffuse(Lobe):
    """f = ``diffuse`` / pi · t(cos θ_i) t(cos θ_o). ``transmitted`` (NODES,): t, see :func:`coat_table`.

    ``diffuse`` is the base's reflectance, linear RGB; the material's texture multiplies it.
    """

    name: ClassVar[str] = "coated_diffuse"
    reference: ClassVar[str] = NORMAL
    fields: ClassVar[list[Any]] = [("diffuse", *COLOUR), ("transmitted", np.float64, (NODES,))]

    diffuse: Any
    transmitted: Any


@lru_cache(maxsize=64)
def coat_table(alpha: float, ior: float, separable: bool) -> np.ndarray:
    """t = T / (ior √(1 - F)) at NODES cosines: T is the share of light that a GGX coat lets through from outside.

    F is what the coat's inner side throws back of diffuse light, so that t(cos θ_i) t(cos θ_o) sums up all bounces between
    coat and base for a base that is white, or whose colour shall not be deepened by them. T and F are those of single
    scattering by microfacets, and F is the mean over the table's own cosines, as in Mitsuba 3's roughplastic.
    """
    cosines = np.maximum(np.linspace(0, 1, NODES), 1e-6)
    through = _albedos(cosines, alpha, ior, separable)[1]
    inner = _albedos(cosines, alpha, 1 / ior, separable)[0]
    thrown_back = 2 * np.mean(inner * cosines)
    return through / (ior * np.sqrt(1 - thrown_back))


def _albedos(cosines: np.ndarray, alpha: float, eta: float, separable: bool) -> tuple[np.ndarray, np.ndarray]:
    """The power that a GGX interface reflects and lets through of light arriving at ``cosines`` (n,), each (n,).

    Means of Fresnel's term times G2 / G1 over visible microfacet normals (Dupuy and Benyoub 2023). ``eta``: the far side's
    index over the near side's.
    """
    at, weight = np.polynomial.legendre.leggauss(_FACETS)
    u1, u2 = np.meshgrid((at + 1) / 2, (at + 1) / 2, indexing="ij")
    c = cosines[:, None, None]
    wi = np.stack(np.broadcast_arrays(np.sqrt(1 - c**2), 0.0, c), axis=-1)
    slope = np.array([alpha, alpha, 1.0])
    stretched = wi * slope
    stretched = stretched / np.linalg.norm(stretched, axis=-1, keepdims=True)
    z = 1 - u2 * (1 + stretched[..., 2])
    sine, angle = np.sqrt(np.maximum(0, 1 - z**2)), 2 * np.pi * u1
    h = (np.stack(np.broadcast_arrays(sine * np.cos(angle), sine * np.sin(angle), z), axis=-1) + stretched) * slope
    h = h / np.linalg.norm(h, axis=-1, keepdims=True)

    k = np.einsum("...i,...i->...", wi, h)
    across = 1 - (1 - k**2) / eta**2
    kt = np.sqrt(np.maximum(0, across))
    s, p = (k - eta * kt) / (k + eta * kt), (eta * k - kt) / (eta * k + kt)
    fresnel = np.where(across > 0, (s**2 + p**2) / 2, 1.0)

    def smith(w: np.ndarray) -> np.ndarray:
        return (np.sqrt(1 + alpha**2 * (1 / np.maximum(w[..., 2] ** 2, 1e-30) - 1)) - 1) / 2

    def power(share: np.ndarray, w: np.ndarray, side: float) -> np.ndarray:
        before, after = smith(wi), smith(w)
        masking = 1 / (1 + after) if separable else (1 + before) / (1 + before + after)
        return np.einsum("nij,i,j->n", share * masking * ((k > 0) & (side * w[..., 2] > 0)), weight / 2, weight / 2)

    reflected = 2 * k[..., None] * h - wi
    refracted = (k / eta - kt)[..., None] * h - wi / eta
    return power(fresnel, reflected, 1.0), power(1 - fresnel, refracted, -1.0)
