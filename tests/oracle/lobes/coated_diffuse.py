"""A diffuse base under a coat, sampled in proportion to the cosine."""

from __future__ import annotations

import numpy as np

from ..vectors import Array, dot
from .coat import MATERIALS as MATERIALS
from .diffuse import density as density
from .diffuse import peak as peak
from .diffuse import sample as sample
from .surface import Surface

AIMS = True


def transmitted(s: Surface, cosine: Array) -> Array:
    """The table, linear between its entries."""
    table = s.material["transmitted"].astype(float)
    at = cosine * (table.shape[1] - 1)
    low = np.clip(np.floor(at.real).astype(int), 0, table.shape[1] - 2)
    before, after = (np.take_along_axis(table, i[:, None], axis=1)[:, 0] for i in (low, low + 1))
    return before + (at - low) * (after - before)


def value(s: Surface, wi: Array, wo: Array) -> Array:
    n = s.normal_towards(wi)
    cosine = dot(n, wo)
    scale = cosine / np.pi * transmitted(s, dot(n, wi)) * transmitted(s, cosine)
    return np.where(s.same_side(wi, wo), scale, 0)[:, None] * s.material["diffuse"] * s.tint


def totals(s: Surface, wi: Array) -> tuple[float, Array]:
    """The outgoing half is the integral of t(c) 2 c, exact for a polygon by Simpson's rule between its corners."""
    corners = np.linspace(0, 1, s.material["transmitted"].shape[1])
    middle = (corners[1:] + corners[:-1]) / 2
    many = s.take(np.zeros(len(corners), int))
    at_corners = transmitted(many, corners) * 2 * corners
    at_middle = transmitted(many.take(slice(1, None)), middle) * 2 * middle
    out = ((at_corners[1:] + 4 * at_middle + at_corners[:-1]) / 6).mean()
    into = transmitted(s, np.abs(s.ns[0] @ wi)[None])[0]
    return 1.0, into * out * s.material["diffuse"][0].astype(float)
