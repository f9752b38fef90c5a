"""Light paths x_0 (camera), x_1 … x_K (theory.md, 1), and all that follows from their nodes."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from .lights import ends, from_infinity
from .lobes import Surface
from .scene import World
from .vectors import Array, norm

CONNECT, HIT = range(2)


@dataclass(frozen=True)
class Paths:
    """Paths of one length K and ending. Arrays are (n, K+1, …), node 0 the camera; v, t: the arriving segment."""

    length: int
    ending: int
    light: Array
    triangle: Array
    lobe: Array
    x: Array
    v: Array
    t: Array
    reach: Array  # t, but of segments that come from infinity, whose t is one
    ng: Array
    ns: Array
    tint: Array

    @property
    def free(self) -> int:
        """How many directions are free."""
        return self.length - (self.ending == CONNECT)

    def take(self, which: Any) -> Paths:
        """A part of the paths."""
        names = [field.name for field in fields(self) if field.name not in ("length", "ending")]
        return replace(self, **{name: getattr(self, name)[which] for name in names})


def complete(world: World, length: int, ending: int, light: Array, triangle: Array, lobe: Array, x: Array) -> Paths:
    """All that follows from the nodes x (n, K+1, 3) and their triangles (-1: the camera or the light itself)."""
    if ending == CONNECT:
        x = x.copy()
        x[:, -1] = ends(world, light, x[:, -2])
    on = np.maximum(triangle, 0)
    solid = (triangle >= 0)[..., None]
    ng = np.where(solid, world.normals[on], 0)
    ns = np.where(solid, world.shading_normal(on, x), 0)
    tint = np.where(solid, world.texture(on, x), 1)
    t, v = np.zeros(x.shape[:2], x.dtype), np.zeros_like(x)
    steps = np.diff(x, axis=1)
    t[:, 1:] = norm(steps)
    with np.errstate(invalid="ignore"):
        v[:, 1:] = steps / t[:, 1:, None]
    reach = t.copy()
    if ending == CONNECT:
        reach[:, -1] = np.where(from_infinity(world, light), np.inf, t[:, -1])
    return Paths(length, ending, light, triangle, lobe, x, v, t, reach, ng, ns, tint)


def paths_through(world: World, length: int, ending: int, light: Array, triangle: Array, weights: Array, lobe: Array) -> Paths:
    """Paths through the given points (barycentric ``weights``) of ``triangle`` (n, K); -1: the light itself."""
    n = len(light)
    x = np.zeros((n, length + 1, 3))
    x[:, 0] = world.origin
    x[:, 1:] = np.einsum("njk,njki->nji", weights, world.corners[np.maximum(triangle, 0)])
    none = np.full((n, 1), -1)
    full, lobes = np.concatenate([none, triangle], axis=1), np.concatenate([none, lobe], axis=1)
    return complete(world, length, ending, light, full, lobes, x)


def surface(world: World, paths: Paths, i: int) -> Surface:
    """Node i as a scatterer."""
    material = world.materials[np.maximum(paths.triangle[:, i], 0)]
    return Surface(paths.x[:, i], paths.ng[:, i], paths.ns[:, i], paths.tint[:, i], material, paths.lobe[:, i])
