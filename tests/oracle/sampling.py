"""Directions and points drawn from the densities of independent.py, from given random numbers in the kernels' order.

Each function draws for the ``wanted`` entries only, and returns anything elsewhere.
"""

from __future__ import annotations

import numpy as np

from .independent import AIM_FROM_CAMERA, AIM_FROM_LIGHT, AIM_FROM_NODE, aim_share, aimed_half_size, cone_of_sphere
from .integrand import film_direction
from .lobes import AIMS, Surface, sample_lobe
from .random import Streams
from .scene import World
from .vectors import Array, about, unit


def sample_target(world: World, target: np.void, x: Array, u1: Array, u2: Array) -> Array:
    """A direction from x into a sphere's cone, or to a point of a rectangle."""
    centre, axis = target["centre"].astype(float), target["axis"].astype(float)
    if target["sphere"]:
        return about(unit(centre - x), 1 - cone_of_sphere(target, x) * u1, 2 * np.pi * u2)
    half = aimed_half_size(world, target)
    across = np.cross(target["normal"].astype(float), axis)
    point = centre + ((2 * u1 - 1) * half[0])[:, None] * axis + ((2 * u2 - 1) * half[1])[:, None] * across
    return unit(point - x)


def sample_aim(world: World, x: Array, share: float, streams: Streams, wanted: Array) -> tuple[Array, Array]:
    """(directions, which were aimed): with probability ``share`` at a target."""
    targets = world.arrays["targets"]
    direction, aimed = np.zeros(x.shape), np.zeros(len(x), bool)
    if not len(targets):
        return direction, aimed
    aimed = wanted & (streams.uniform(wanted) < aim_share(world, share))
    chosen = streams.index(len(targets), aimed)
    u1, u2 = streams.uniform(aimed), streams.uniform(aimed)
    for index, target in enumerate(targets):
        use = aimed & (chosen == index)
        direction[use] = sample_target(world, target, x[use], u1[use], u2[use])
    return direction, aimed


def sample_camera(world: World, streams: Streams, wanted: Array) -> Array:
    """The first direction: through a uniform point of the film, or aimed."""
    origin = np.broadcast_to(world.origin, (len(wanted), 3))
    direction, aimed = sample_aim(world, origin, AIM_FROM_CAMERA, streams, wanted)
    plain = wanted & ~aimed
    position = np.stack([streams.uniform(plain), streams.uniform(plain)], axis=-1)
    return np.where(aimed[:, None], direction, film_direction(world, position))


def sample_emission(world: World, x: Array, normal: Array | None, streams: Streams, wanted: Array) -> Array:
    """The light's first direction: about the emitter's normal, or all round (no normal), or aimed."""
    direction, aimed = sample_aim(world, x, AIM_FROM_LIGHT, streams, wanted)
    plain = wanted & ~aimed
    u, angle = streams.uniform(plain), 2 * np.pi * streams.uniform(plain)
    if normal is None:
        z = 1 - 2 * u
        sine = np.sqrt(1 - z**2)
        drawn = np.stack([sine * np.cos(angle), sine * np.sin(angle), z], axis=-1)
    else:
        drawn = about(normal, np.sqrt(1 - u), angle)
    return np.where(aimed[:, None], direction, drawn)


def sample_scatter(world: World, s: Surface, known: Array, streams: Streams, wanted: Array) -> tuple[Array, Array]:
    """(the other direction at nodes whose ``known`` direction is given, whether there is one), aiming included."""
    direction, aimed = sample_aim(world, s.x, AIM_FROM_NODE, streams, wanted & AIMS[s.lobe])
    drawn, ok = sample_lobe(s, known, streams, wanted & ~aimed)
    return np.where(aimed[:, None], direction, drawn), aimed | ok


def sample_light(world: World, streams: Streams, wanted: Array) -> Array:
    """Which point light."""
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
