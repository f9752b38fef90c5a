"""Directions and points drawn from the densities of independent.py, from given random numbers in the kernels' order.

Each function draws for the ``wanted`` entries only, and returns anything elsewhere.
"""

from __future__ import annotations

import numpy as np

from .aiming import AIM_FROM_CAMERA, AIM_FROM_LIGHT, AIM_FROM_NODE, sample_aim
from .integrand import film_direction
from .lobes import AIMS, Surface, sample_lobe
from .random import Streams
from .scene import World
from .vectors import Array, about


def sample_camera(world: World, streams: Streams, wanted: Array) -> Array:
    """The first direction: through a uniform point of the film, or aimed."""
    origin = np.broadcast_to(world.origin, (len(wanted), 3))
    direction, aimed = sample_aim(world, origin, AIM_FROM_CAMERA, streams, wanted)
    plain = wanted & ~aimed
    position = np.stack([streams.uniform(plain), streams.uniform(plain)], axis=-1)
    return np.where(aimed[:, None], direction, film_direction(world, position))


def sample_emitter_emission(world: World, x: Array, normal: Array, streams: Streams, wanted: Array) -> Array:
    """An emitter's first direction: about its normal, or aimed."""
    direction, aimed = sample_aim(world, x, AIM_FROM_LIGHT, streams, wanted)
    plain = wanted & ~aimed
    u, angle = streams.uniform(plain), 2 * np.pi * streams.uniform(plain)
    return np.where(aimed[:, None], direction, about(normal, np.sqrt(1 - u), angle))


def sample_scatter(world: World, s: Surface, known: Array, streams: Streams, wanted: Array) -> tuple[Array, Array]:
    """(the other direction at nodes whose ``known`` direction is given, whether there is one), aiming included."""
    direction, aimed = sample_aim(world, s.x, AIM_FROM_NODE, streams, wanted & AIMS[s.lobe])
    drawn, ok = sample_lobe(s, known, streams, wanted & ~aimed)
    return np.where(aimed[:, None], direction, drawn), aimed | ok


def sample_light(world: World, streams: Streams, wanted: Array) -> Array:
    """Which light without area."""
    cumulative = world.arrays["lights"]["cumulative"].astype(float)
    return np.searchsorted(cumulative[:-1], streams.uniform(wanted), side="right")


def sample_emitter(world: World, streams: Streams, wanted: Array) -> tuple[Array, Array]:
    """(triangle, point) on an emitter."""
    cumulative = world.arrays["emitter_cdf"].astype(float)
    chosen = np.searchsorted(cumulative[:-1], streams.uniform(wanted), side="right")
    root, share = np.sqrt(streams.uniform(wanted)), streams.uniform(wanted)
    triangle = world.arrays["emitter_triangles"][chosen]
    weights = np.stack([1 - root, root * (1 - share), root * share], axis=-1)
    return triangle, np.einsum("nk,nki->ni", weights, world.corners[triangle])
