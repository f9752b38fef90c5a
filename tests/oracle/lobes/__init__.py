"""The lobes of a node: value, density of its own sampling, and a draw of it (theory.md, 1 and 6); a file for each kind.

A kind's file is called as the kind is and found by that. It has

    AIMS                                    whether its draws go to the targets, part of the time
    MATERIALS                               materials that have such a lobe, for the tests of all lobes
    value(surface, wi, wo)                  f |cos θ_o| as RGB, radiance convention (camera's side w_i)
    density(surface, known, other)          per solid angle, of drawing ``other`` without aiming
    sample(surface, known, streams, wanted) (the other direction, lobe, whether there is one), for the ``wanted``
    peak(surface, wi, facet)                a direction near the lobe's peak, for a microfacet normal near the shading normal
    totals(surface, wi)                     (probability that a draw succeeds, albedo as RGB) at one direction, otherwise found
"""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

import numpy as np

from pylmc import lobes as registered

from ..random import Streams
from ..vectors import Array, dot
from .surface import PAIR_OF, Surface

KINDS: tuple[ModuleType, ...] = tuple(import_module(f".{kind.name}", __name__) for kind in registered.KINDS)
NAMES = [kind.name for kind in registered.KINDS]
AIMS = np.array([kind.AIMS for kind in KINDS])


def number(name: str) -> int:
    """The number of a kind, which is also a lobe's signature."""
    return NAMES.index(name)


def lobe_value(s: Surface, wi: Array, wo: Array) -> Array:
    """f |cos θ_o| of each surface's own lobe as RGB."""
    out = np.zeros((len(wi), 3), np.result_type(wi, wo, s.ns))
    agree = dot(s.ns, wi) * dot(s.ng, wi) > 0  # whether both normals face the camera's side
    for lobe in np.unique(s.lobe[agree]):
        use = agree & (s.lobe == lobe)
        out[use] = KINDS[lobe].value(s.take(use), wi[use], wo[use])
    return out


def lobe_density(s: Surface, known: Array, other: Array) -> Array:
    """Density per solid angle of the lobe's own sampling, without aiming."""
    out = np.zeros(len(known))
    for lobe in np.unique(s.lobe[s.lobe >= 0]):
        use = s.lobe == lobe
        out[use] = KINDS[lobe].density(s.take(use), known[use], other[use])
    return out


def sample_lobe(s: Surface, known: Array, streams: Streams, wanted: Array) -> tuple[Array, Array]:
    """(the other direction, whether there is one) at nodes whose ``known`` direction is given, without aiming."""
    out, ok = np.zeros(known.shape), np.zeros(len(known), bool)
    for lobe in np.unique(s.lobe[wanted]):
        use = wanted & (s.lobe == lobe)
        direction, found = KINDS[lobe].sample(s, known, streams, use)
        out[use], ok[use] = direction[use], found[use]
    return out, ok


def choose_lobe(s: Surface, streams: Streams, wanted: Array) -> Array:
    """A lobe of each material by its own chances; of a pair, which is one choice, the reflecting one."""
    chances = np.where(PAIR_OF >= 0, s.material["choice"], 0.0).astype(float)
    mixed = wanted & ((chances > 0).sum(axis=1) > 1)
    u = np.where(mixed, streams.uniform(mixed), 0.0)[:, None]
    before = s.material["before"].astype(float)
    return np.argmax((chances > 0) & (u >= before) & (u < before + chances), axis=1)


def settled_lobe(s: Surface, arriving: Array, leaving: Array) -> Array:
    """Which of a pair's two lobes the finished path uses."""
    through = dot(s.ng, arriving) * dot(s.ng, leaving) > 0
    pair = PAIR_OF[s.lobe]
    return np.where(pair == 0, s.lobe, s.lobe + through - (pair < 0))
