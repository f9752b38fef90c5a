"""What rounding may do to a quantity: its condition number, measured, and errors in units of it.

A kernel that makes q from a state with numbers of unit roundoff u does what exact arithmetic would do with a state moved by a
few u: each rounding of a node or direction moves the path by u times the scene's radius, one, and each rounding of a
derivative changes it by u of itself. So its error is a small multiple of u κ, κ being how fast q changes with those; what is
done to q itself afterwards adds u |q|. κ is measured: everything is moved at random by SIZE, small enough for q to be linear
and large enough for float64 to see it, and q's change is divided by it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .paths import Paths, complete
from .scene import World
from .vectors import Array

SIZE = 1e-9
DRAWS = 3


class Rounding:
    """Moves whatever it is given by up to SIZE, in place of rounding."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)

    def nodes(self, world: World, paths: Paths) -> Paths:
        """The paths with every node but the camera moved along each axis, off its surface too."""
        x = paths.x.copy()
        x[:, 1:] += SIZE * self.rng.uniform(-1, 1, x[:, 1:].shape)
        return complete(world, paths.length, paths.ending, paths.light, paths.triangle, paths.lobe, x)

    def relative(self, values: Array) -> Array:
        """Each number off by a part of itself; whole numbers stay."""
        if values.dtype.kind in "iu":
            return values
        return values * (1 + SIZE * self.rng.uniform(-1, 1, values.shape))


class Quantity(NamedTuple):
    """What the oracle says, (n, …), and its κ (n,)."""

    value: Array
    kappa: Array

    def roundings(self, kernel: Array, epsilon: float) -> Array:
        """|kernel - value| (n,), the largest of its components, in units of ε (1 + |value| + κ)."""
        own = tuple(range(1, self.value.ndim))
        size, error = np.abs(self.value).max(axis=own, initial=0), np.abs(kernel - self.value).max(axis=own, initial=0)
        return error / (epsilon * (1 + size + self.kappa))


def condition(function: Callable[..., dict[str, Array]], world: World, paths: Paths, *numbers: Array) -> dict[str, Quantity]:
    """The quantities that function(paths, rounding, *numbers) gives by name, each (n, …), with their κ.

    ``rounding``, which is None for the value itself, is for the function to apply to derivatives and to what it makes.
    """
    values = function(paths, None, *numbers)
    n, rounding = len(paths.light), Rounding(0)
    often = np.tile(np.arange(n), DRAWS)
    moved = function(rounding.nodes(world, paths.take(often)), rounding, *(rounding.relative(a[often]) for a in numbers))
    out = {}
    for name, value in values.items():
        with np.errstate(invalid="ignore"):
            change = moved[name].reshape(DRAWS, *value.shape) - value
        change = np.abs(np.nan_to_num(change, nan=0, posinf=0, neginf=0))  # jumps to nowhere left out
        out[name] = Quantity(value, change.max(axis=(0, *range(2, change.ndim)), initial=0) / SIZE)
    return out
