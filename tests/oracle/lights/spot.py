"""Spot lights."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..aiming import AIM_FROM_LIGHT, aimed, sample_aim
from ..random import Streams
from ..scene import World
from ..vectors import Array, about
from .point import INFINITE as INFINITE
from .point import end as end


def fall(light: Any, direction: Array) -> Array:
    """1 - cos of the angle with the axis."""
    return 1 - direction @ light["direction"].astype(float)


def emitted(light: Any, direction: Array) -> Array:
    outer, inner = float(light["spread"]), float(light["full_spread"])
    share = (outer - fall(light, direction)) / max(outer - inner, 1e-300)
    return np.where(share.real >= 1, 1, np.where(share.real <= 0, 0, share)) ** 2


def density(world: World, light: Any, to: Array, direction: Array) -> Array:
    outer = float(light["spread"])
    inside = np.where(fall(light, direction) <= outer, 1 / (2 * np.pi * outer), 0)
    return aimed(world, end(light, to), direction, inside, AIM_FROM_LIGHT)


def sample(world: World, light: Any, streams: Streams, wanted: Array) -> tuple[Array, Array]:
    origin = end(light, np.zeros((len(wanted), 3)))
    direction, at_target = sample_aim(world, origin, AIM_FROM_LIGHT, streams, wanted)
    plain = wanted & ~at_target
    drawn, angle = float(light["spread"]) * streams.uniform(plain), 2 * np.pi * streams.uniform(plain)
    axis = np.broadcast_to(light["direction"].astype(float), origin.shape)
    return origin, np.where(at_target[:, None], direction, about(axis, 1 - drawn, angle))
