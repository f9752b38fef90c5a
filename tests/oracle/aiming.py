"""Aimed directions (theory.md, 6): densities and draws of directions that go, part of the time, to one of the targets."""

from __future__ import annotations

import numpy as np

from .random import Streams
from .scene import World
from .vectors import Array, about, any_tangent, unit

AIM_MARGIN, AIM_OFFSETS = 1.002, 1.25  # portals are aimed at with this margin, and so many offsets of rays
AIM_FROM_LIGHT, AIM_FROM_NODE, AIM_FROM_CAMERA = 0.5, 0.25, 0.1  # the latter two where aiming is done everywhere


def aimed_half_size(world: World, target: np.void) -> Array:
    """The rectangle that is aimed at, a little larger than the portal."""
    return AIM_MARGIN * target["half_size"].astype(float) + AIM_OFFSETS * world.ray_offset


def cone_of_sphere(target: np.void, x: Array) -> Array:
    """1 - cos of the cone that a sphere fills seen from x; 2, the whole sphere of directions, from inside."""
    distance = np.linalg.norm(target["centre"].astype(float) - x, axis=-1)
    sine2 = np.minimum((float(target["half_size"][0]) / distance) ** 2, 1)
    return np.where(sine2 < 1, sine2 / (1 + np.sqrt(1 - sine2)), 2.0)


def target_density(world: World, target: np.void, x: Array, direction: Array) -> Array:
    """Density of a direction aimed at one target: uniform in a sphere's cone, or in the area of a rectangle."""
    centre = target["centre"].astype(float)
    if target["sphere"]:
        to = centre - x
        apart = np.linalg.norm(direction - to / np.linalg.norm(to, axis=-1, keepdims=True), axis=-1) ** 2 / 2  # 1 - cos
        fall = cone_of_sphere(target, x)
        return np.where(apart <= fall, 1 / (2 * np.pi * fall), 0)
    normal, axis = target["normal"].astype(float), target["axis"].astype(float)
    cosine = direction @ normal
    with np.errstate(all="ignore"):
        t = ((centre - x) @ normal) / cosine
        offset = x + t[:, None] * direction - centre
        half = aimed_half_size(world, target)
        inside = (t > 0) & (np.abs(offset @ axis) <= half[0]) & (np.abs(offset @ np.cross(normal, axis)) <= half[1])
        return np.where(inside, t**2 / (4.0 * half[0] * half[1] * np.abs(cosine)), 0)


def aim_share(world: World, share: float) -> float:
    """How often a direction aims: the light's always do with their share, the others where the setting says so."""
    return share if share == AIM_FROM_LIGHT or world.aim == "everywhere" else 0.0


def aimed(world: World, x: Array, direction: Array, otherwise: Array, share: float) -> Array:
    """Density of a direction aimed at one of the targets with probability ``share``."""
    targets = world.arrays["targets"]
    share = aim_share(world, share)
    if not len(targets):
        return otherwise
    total = sum(target_density(world, target, x, direction) for target in targets)
    return (1 - share) * otherwise + share * total / len(targets)


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


def density_across(world: World, x: Array, direction: Array, otherwise: float, share: float) -> Array:
    """Density, by area across ``direction`` (3,), of the line through x (n, 3): aimed at one of the targets or not."""
    targets = world.arrays["targets"]
    if not len(targets):
        return np.full(len(x), otherwise)
    total = np.zeros(len(x))
    for target in targets:
        to = x - target["centre"].astype(float)
        if target["sphere"]:
            radius = float(target["half_size"][0])
            apart = np.linalg.norm(np.cross(to, direction), axis=-1)
            total += np.where(apart <= radius, 1 / (np.pi * radius**2), 0)
            continue
        normal, axis, half = target["normal"].astype(float), target["axis"].astype(float), aimed_half_size(world, target)
        met = to - ((to @ normal) / (direction @ normal))[:, None] * direction
        inside = (np.abs(met @ axis) <= half[0]) & (np.abs(met @ np.cross(normal, axis)) <= half[1])
        total += np.where(inside, 1 / (4 * half[0] * half[1] * abs(direction @ normal)), 0)
    return (1 - share) * otherwise + share * total / len(targets)


def sample_across(world: World, direction: Array, share: float, streams: Streams, wanted: Array) -> tuple[Array, Array]:
    """(points that lines along ``direction`` (3,) pass, which were aimed): with probability ``share`` at a target."""
    targets = world.arrays["targets"]
    passed, aimed = np.zeros((len(wanted), 3)), np.zeros(len(wanted), bool)
    if not len(targets):
        return passed, aimed
    aimed = wanted & (streams.uniform(wanted) < share)
    chosen = streams.index(len(targets), aimed)
    u1, u2 = streams.uniform(aimed), streams.uniform(aimed)
    for index, target in enumerate(targets):
        centre, axis = target["centre"].astype(float), target["axis"].astype(float)
        if target["sphere"]:
            tangent, radius = any_tangent(direction), float(target["half_size"][0]) * np.sqrt(u1)
            across = np.cross(direction, tangent)
            a, b = radius * np.cos(2 * np.pi * u2), radius * np.sin(2 * np.pi * u2)
        else:
            tangent, across = axis, np.cross(target["normal"].astype(float), axis)
            a, b = ((2 * u - 1) * half for u, half in zip((u1, u2), aimed_half_size(world, target), strict=True))
        point = centre + a[:, None] * tangent + b[:, None] * across
        passed = np.where((aimed & (chosen == index))[:, None], point, passed)
    return passed, aimed
