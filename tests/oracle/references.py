"""The reference directions that deviations are counted from (theory.md, 2)."""

from __future__ import annotations

import numpy as np

from .lobes.surface import Surface
from .vectors import Array, dot, mirror, unit


def reference_direction(s: Surface, v: Array) -> Array:
    """Mirror direction, refracted direction (Snell in vectors), or the normal on the side of arrival."""
    n = np.where(dot(s.ns, v)[:, None] < 0, s.ns, -s.ns)
    tangential = (v - dot(v, n)[:, None] * n) / s.index_ratio(-v)[:, None]
    cosine2 = 1 - dot(tangential, tangential)
    down = np.sqrt(np.where(cosine2 > 0, cosine2, 0))[:, None]
    refracted = unit(tangential - down * n)
    out = np.where(s.refers_to("normal")[:, None], n, mirror(v, n))
    return np.where(s.refers_to("refracted")[:, None], refracted, out)
