"""Light from infinity: the last node is one length along the light's direction from the last but one."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..aiming import AIM_FROM_LIGHT, density_across, sample_across
from ..random import Streams
from ..scene import World
from ..vectors import Array, any_tangent

INFINITE = True


def end(light: Any, near: Array) -> Array:
    return near - light["direction"].astype(float)


def emitted(light: Any, direction: Array) -> Array:
    return np.ones(len(direction))


def density(world: World, light: Any, to: Array, direction: Array) -> Array:
    return density_across(world, to, light["direction"].astype(float), 1 / (np.pi * float(light["disc"]) ** 2), AIM_FROM_LIGHT)


def sample(world: World, light: Any, streams: Streams, wanted: Array) -> tuple[Array, Array]:
    direction, disc = light["direction"].astype(float), float(light["disc"])
    passed, at_target = sample_across(world, direction, AIM_FROM_LIGHT, streams, wanted)
    plain = wanted & ~at_target
    radius, angle = disc * np.sqrt(streams.uniform(plain)), 2 * np.pi * streams.uniform(plain)
    tangent = any_tangent(direction)
    flat = np.cos(angle)[:, None] * tangent + np.sin(angle)[:, None] * np.cross(direction, tangent)
    passed = np.where(at_target[:, None], passed, radius[:, None] * flat)
    origin = passed - (passed @ direction + 2 * disc)[:, None] * direction
    return origin, np.broadcast_to(direction, origin.shape)
