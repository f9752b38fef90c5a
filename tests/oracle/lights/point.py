"""Point lights."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..aiming import AIM_FROM_LIGHT, aimed, sample_aim
from ..random import Streams
from ..scene import World
from ..vectors import Array

INFINITE = False


def end(light: Any, near: Array) -> Array:
    return np.broadcast_to(light["position"].astype(float), near.shape)


def emitted(light: Any, direction: Array) -> Array:
    return np.ones(len(direction))


def density(world: World, light: Any, to: Array, direction: Array) -> Array:
    return aimed(world, end(light, to), direction, np.full(len(to), 1 / (4 * np.pi)), AIM_FROM_LIGHT)


def sample(world: World, light: Any, streams: Streams, wanted: Array) -> tuple[Array, Array]:
    origin = end(light, np.zeros((len(wanted), 3)))
    direction, at_target = sample_aim(world, origin, AIM_FROM_LIGHT, streams, wanted)
    plain = wanted & ~at_target
    z, angle = 1 - 2 * streams.uniform(plain), 2 * np.pi * streams.uniform(plain)
    sine = np.sqrt(1 - z**2)
    drawn = np.stack([sine * np.cos(angle), sine * np.sin(angle), z], axis=-1)
    return origin, np.where(at_target[:, None], direction, drawn)
