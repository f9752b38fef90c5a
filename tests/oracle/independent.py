"""The density p_ind of the bidirectional independent sampler (theory.md, 6), from area densities."""

from __future__ import annotations

import numpy as np

from . import lights
from .aiming import AIM_FROM_CAMERA, AIM_FROM_LIGHT, AIM_FROM_NODE, aimed
from .integrand import importance
from .lobes import AIMS, lobe_density
from .paths import HIT, Paths, surface
from .scene import World
from .vectors import Array, dot


def camera_density(world: World, v: Array) -> Array:
    """Density of the first direction: uniform on the film, or aimed."""
    return aimed(world, np.broadcast_to(world.origin, v.shape), v, importance(world, v), AIM_FROM_CAMERA)


def emitter_emission_density(world: World, x: Array, normal: Array, direction: Array) -> Array:
    """Density of the first direction from an emitter: cosine about its normal, or aimed."""
    return aimed(world, x, direction, np.maximum(dot(normal, direction), 0) / np.pi, AIM_FROM_LIGHT)


def scatter_density(world: World, paths: Paths, i: int, known: Array, other: Array) -> Array:
    """Density of drawing ``other`` at node i, aiming included."""
    s = surface(world, paths, i)
    plain = lobe_density(s, known, other)
    return np.where(AIMS[s.lobe], aimed(world, s.x, other, plain, AIM_FROM_NODE), plain)


def light_chances(world: World) -> Array:
    """Probability of each light without area."""
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
    light[last] = world.emitter_density[paths.triangle[:, last]] if hit else light_chances(world)[paths.light]
    for j in range(last - 1, 0, -1):
        away = -paths.v[:, j + 1]
        if j == last - 1:
            if hit:
                density = emitter_emission_density(world, paths.x[:, last], paths.ng[:, last], away)
            else:
                density = lights.emission_density(world, paths.light, paths.x[:, j], away)
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
