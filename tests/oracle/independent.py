"""The density p_ind of the bidirectional independent sampler (theory.md, 6), from area densities."""

from __future__ import annotations

import numpy as np

from .integrand import importance
from .lobes import AIMS, lobe_density
from .paths import HIT, Paths, surface
from .scene import World
from .vectors import Array, dot

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


def camera_density(world: World, v: Array) -> Array:
    """Density of the first direction: uniform on the film, or aimed."""
    return aimed(world, np.broadcast_to(world.origin, v.shape), v, importance(world, v), AIM_FROM_CAMERA)


def emission_density(world: World, x: Array, normal: Array | None, direction: Array) -> Array:
    """Density of the light's first direction: cosine about an emitter's normal, or alike all round (no normal); or aimed."""
    uniform = np.full(len(x), 1 / (4 * np.pi))
    plain = uniform if normal is None else np.maximum(dot(normal, direction), 0) / np.pi
    return aimed(world, x, direction, plain, AIM_FROM_LIGHT)


def scatter_density(world: World, paths: Paths, i: int, known: Array, other: Array) -> Array:
    """Density of drawing ``other`` at node i, aiming included."""
    s = surface(world, paths, i)
    plain = lobe_density(s, known, other)
    return np.where(AIMS[s.lobe], aimed(world, s.x, other, plain, AIM_FROM_NODE), plain)


def point_chances(world: World) -> Array:
    """Probability of each point light."""
    return np.diff(world.arrays["lights"]["cumulative"].astype(float), prepend=0)


def log_p(world: World, paths: Paths) -> Array:
    """log p_ind: the mean over the splits of area densities, turned into solid angle at the end."""
    last = paths.length
    n = len(paths.light)
    cosine = [np.ones(n)] + [np.abs(dot(paths.ng[:, i], paths.v[:, i])) for i in range(1, last + 1)]
    to_area = [np.ones(n)] + [cosine[i] / paths.t[:, i] ** 2 for i in range(1, last + 1)]
    camera: list[Array] = [np.ones(n), camera_density(world, paths.v[:, 1]) * to_area[1]]
    for i in range(2, last + 1):
        camera.append(scatter_density(world, paths, i - 1, -paths.v[:, i - 1], paths.v[:, i]) * to_area[i])
    light: list[Array] = [np.ones(n)] * (last + 1)
    hit = paths.ending == HIT
    light[last] = world.emitter_density[paths.triangle[:, last]] if hit else point_chances(world)[paths.light]
    for j in range(last - 1, 0, -1):
        away = -paths.v[:, j + 1]
        if j == last - 1:
            density = emission_density(world, paths.x[:, last], paths.ng[:, last] if hit else None, away)
        else:
            density = scatter_density(world, paths, j + 1, paths.v[:, j + 2], away)
        light[j] = density * np.abs(dot(paths.ng[:, j], away)) / paths.t[:, j + 1] ** 2
    splits = range(last + 1 if hit else last)
    with np.errstate(divide="ignore", invalid="ignore"):
        # x_1 … x_k from the camera, the rest from the light
        logs = [np.log(np.stack(camera[1 : k + 1] + light[k + 1 :])).sum(axis=0) for k in splits]
        log_sum = np.logaddexp.reduce(np.stack(logs), axis=0)
        log_sum -= np.log(len(splits))
        for i in range(1, paths.free + 1):
            log_sum -= np.log(to_area[i])
        for i in range(1, last):
            log_sum += np.log(surface(world, paths, i).choice)
    return log_sum
