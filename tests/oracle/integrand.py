"""The integrand C of theory.md, 1, and the chain's target I: luminance of C, times a weight of the film position."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import map_coordinates

from .lights import intensity
from .lobes import lobe_value
from .paths import CONNECT, Paths, surface
from .scene import LUMINANCE, World
from .vectors import Array, dot


def film_position(world: World, v: Array) -> Array:
    """Where on the film (n, 2) directions fall: x to the right and y down, 0 to 1; NaN behind the camera."""
    c = world.camera
    depth = v @ c["forward"].astype(float)
    with np.errstate(all="ignore"):
        right, down = v @ c["right"].astype(float) / c["tan_x"], -(v @ c["up"].astype(float)) / c["tan_y"]
        return np.where(depth[:, None] > 0, (np.stack([right, down], axis=-1) / depth[:, None] + 1) / 2, np.nan)


def film_direction(world: World, position: Array) -> Array:
    """The direction through a film position."""
    c = world.camera
    right, down = (2 * position[:, :1] - 1) * c["tan_x"].astype(float), (2 * position[:, 1:] - 1) * c["tan_y"].astype(float)
    v = c["forward"].astype(float) + right * c["right"].astype(float) - down * c["up"].astype(float)
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def importance(world: World, v: Array) -> Array:
    """The camera's W = 1 / (A cos³), A the film's area at unit distance; zero off the film."""
    c = world.camera
    depth = v @ c["forward"].astype(float)
    position = film_position(world, v).real
    with np.errstate(all="ignore"):
        inside = np.all((position >= 0) & (position < 1), axis=-1)
        return np.where(inside, 1 / (4.0 * c["tan_x"].astype(float) * c["tan_y"].astype(float) * depth**3), 0.0)


def radiance_of(world: World, paths: Paths) -> Array:
    """C as RGB (visibility not looked at)."""
    c = importance(world, paths.v[:, 1])[:, None] * np.ones(3)
    for i in range(1, paths.length):
        c = c * lobe_value(surface(world, paths, i), -paths.v[:, i], paths.v[:, i + 1])
    if paths.ending == CONNECT:
        return c * intensity(world, paths.light, -paths.v[:, -1]) / paths.t[:, -1:] ** 2
    front = dot(paths.ng[:, -1], paths.v[:, -1]) < 0
    return c * np.where(front[:, None], world.radiance[paths.triangle[:, -1]], 0)


def film_weight_at(evenness: Array, positions: Array) -> Array:
    """The target's weight at film positions (n, 2), x first: linear between the centres of the grid's cells."""
    size = len(evenness)
    at = np.clip(positions.T[::-1] * size - 0.5, 0, size - 1.001)  # short of the last centre, as in the kernel
    return map_coordinates(evenness.astype(float), at, order=1, mode="nearest")


def film_weight(world: World, v: Array) -> Array:
    """The evenness of directions' film positions."""
    if world.evenness is None:
        return np.ones(len(v))
    return film_weight_at(world.evenness, np.nan_to_num(film_position(world, v.real)))


def log_pi(world: World, paths: Paths) -> Array:
    """log I; minus infinity where the path carries no light."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.log(radiance_of(world, paths) @ LUMINANCE * film_weight(world, paths.v[:, 1]))
