"""Lights without area: where a path ends on one, what it sends, and how a light path sets out; a file for each kind.

A kind's file is called as the kind is and found by that. With ``light`` being a record of the compiled scene's, it has

    INFINITE                                whether it has no position
    end(light, near)                        x_K (n, 3) of paths whose last node but one is ``near``
    emitted(light, direction)               what is sent in a direction, as a part of the light's intensity
    density(world, light, to, direction)    of the first segment, which runs along ``direction`` to the node ``to``: per solid
                                            angle, or, from infinity, per area across it
    sample(world, light, streams, wanted)   (origin, direction) of first segments, for the ``wanted``
"""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

import numpy as np

from pylmc.scene import Light

from ..random import Streams
from ..scene import World
from ..vectors import Array

KINDS: list[ModuleType] = [import_module(f".{name}", __name__) for name in sorted(kind.name for kind in Light.kinds)]


def ends(world: World, light: Array, near: Array) -> Array:
    """x_K of paths that are joined to the lights ``light`` (n,)."""
    out = np.zeros_like(near)
    for index, record in enumerate(world.arrays["lights"]):
        use = light == index
        out[use] = KINDS[record["kind"]].end(record, near[use])
    return out


def from_infinity(world: World, light: Array) -> Array:
    """Which of the lights ``light`` (n,) have no position."""
    return np.array([KINDS[kind].INFINITE for kind in world.arrays["lights"]["kind"]])[light]


def intensity(world: World, light: Array, direction: Array) -> Array:
    """RGB that lights send in directions, over the square of the distance."""
    out = np.zeros((len(light), 3), direction.dtype)
    for index, record in enumerate(world.arrays["lights"]):
        use = light == index
        out[use] = KINDS[record["kind"]].emitted(record, direction[use])[:, None] * record["intensity"].astype(float)
    return out


def emission_density(world: World, light: Array, to: Array, direction: Array) -> Array:
    """Density of light paths' first segments, aiming included."""
    out = np.zeros(len(light))
    for index, record in enumerate(world.arrays["lights"]):
        use = light == index
        out[use] = KINDS[record["kind"]].density(world, record, to[use], direction[use])
    return out


def sample_emission(world: World, light: Array, streams: Streams, wanted: Array) -> tuple[Array, Array]:
    """(origins, directions) of the ``wanted`` light paths' first segments; origins of those alone."""
    origin, direction = np.zeros((len(light), 3)), np.zeros((len(light), 3))
    for index, record in enumerate(world.arrays["lights"]):
        use = wanted & (light == index)
        x, v = KINDS[record["kind"]].sample(world, record, streams, use)
        origin[use], direction[use] = np.broadcast_to(x, v.shape)[use], v[use]
    return origin[wanted], direction
