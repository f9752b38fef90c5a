"""What rounding may do to a quantity: its condition number, measured, and errors in units of it.

A kernel that makes q from a state with numbers of unit roundoff u does what exact arithmetic would do with a state moved by a
few u: each rounding of a node or direction moves the path by u times the scene's radius, one, and each rounding of a
derivative changes it by u of itself. So its error is a small multiple of u κ, κ being how fast q changes with those; what is
done to q itself afterwards adds u |q|. κ is measured: everything is moved at random by SIZE, small enough for q to be linear
and large enough for float64 to see it, and q's change is divided by it.
"""

from __future__ import annotations

from collections.abc import Callable

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
        """Each number off by a part of itself."""
        return values * (1 + SIZE * self.rng.uniform(-1, 1, values.shape))


def largest(changes: Array) -> Array:
    """The largest (n,) over draws (d, n, …) and components of |changes| / SIZE, jumps to nowhere left out."""
    flat = np.abs(np.nan_to_num(changes, nan=0, posinf=0, neginf=0)).reshape(*changes.shape[:2], -1)
    return flat.max(axis=(0, 2)) / SIZE


def condition(function: Callable[[Paths, Rounding | None], Array], world: World, paths: Paths) -> tuple[Array, Array]:
    """(q = function(paths, None) (n, …), its κ (n,)); the function hands its second argument on to Tangents."""
    q = function(paths, None)
    changes = []
    with np.errstate(invalid="ignore"):
        for seed in range(DRAWS):
            rounding = Rounding(seed)
            changes.append(function(rounding.nodes(world, paths), rounding) - q)
    return q, largest(np.stack(changes))


def in_roundings(kernel: Array, oracle: Array, kappa: Array, epsilon: float) -> Array:
    """|kernel - oracle| (n, …), the largest of its components, in units of ε (1 + |oracle| + κ)."""
    size = np.abs(oracle).reshape(len(oracle), -1).max(axis=1)
    error = np.abs(kernel - oracle).reshape(len(oracle), -1).max(axis=1)
    return error / (epsilon * (1 + size + kappa))
