"""Lambertian reflection, sampled in proportion to the cosine."""

from __future__ import annotations

import numpy as np

from pylmc.scene import Diffuse

from ..random import Streams
from ..vectors import Array, about, dot
from .surface import Surface

AIMS = True
MATERIALS = [Diffuse((0.2, 0.5, 0.8))]


def value(s: Surface, wi: Array, wo: Array) -> Array:
    cosine = dot(s.normal_towards(wi), wo)
    return np.where(s.same_side(wi, wo), cosine / np.pi, 0)[:, None] * s.material["diffuse"] * s.tint


def density(s: Surface, known: Array, other: Array) -> Array:
    return np.where(s.same_side(known, other), np.abs(dot(s.ns, other)) / np.pi, 0)


def sample(s: Surface, known: Array, streams: Streams, wanted: Array) -> tuple[Array, Array]:
    u, angle = streams.uniform(wanted), 2 * np.pi * streams.uniform(wanted)
    return about(s.normal_towards(known), np.sqrt(1 - u), angle), wanted


def peak(s: Surface, wi: Array, facet: Array) -> Array:
    return facet


def totals(s: Surface, wi: Array) -> tuple[float, Array]:
    return 1.0, s.material["diffuse"][0].astype(float)
