"""The path from X: a path whose first m directions have moved by delta in their charts (theory.md, 2).

Traced, each ray goes to what it meets first, found by trying every triangle. Else each node slides on the plane of a given
triangle, its own unless told: the smooth continuation that derivatives are of.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .charts import Charts, carry_frame
from .integrand import importance
from .lobes import lobe_value
from .paths import CONNECT, HIT, Paths, complete, surface
from .references import reference_direction
from .scene import LUMINANCE, World
from .vectors import Array, dot, magnitude, turn_minimally


@dataclass(frozen=True)
class Moved:
    """A displaced path, the frame at its first direction, Σ log dσ/dδ over the charts, and whether there is a path.

    s: the reference directions (n, K+1, 3) at the nodes before directions 2 … m + 2, index by direction.
    """

    paths: Paths
    s: Array
    frame: Array
    log_jacobian: Array
    exists: Array


def displaced(charts: Charts, delta: Array, traced: bool = False, onto: Array | None = None) -> Moved:
    """The path after moving coordinates by ``delta`` (n, 2 m); directions beyond m join the old nodes.

    ``onto``: the triangles (n, K+1) on whose planes nodes slide where they are not ``traced``.
    """
    base, world, m = charts.base, charts.world, charts.m
    n = len(base.light)
    dtype = np.result_type(base.x, delta)
    x, triangle = base.x.astype(dtype), (base.triangle if onto is None else onto).copy()
    s = np.zeros(x.shape, dtype)
    exists, log_jacobian = np.ones(n, bool), np.zeros(n, dtype)
    paths, frame, first_frame = base, charts.p, charts.p
    for j in range(1, m + 1):
        reference = base.v[:, j]
        if j > 1:
            here, arriving = surface(world, paths, j - 1), paths.v[:, j - 1]
            reference = s[:, j] = reference_direction(here, arriving)
            frame = carry_frame(here, arriving, frame, reference)
        v, log_j = charts.direction(j, delta[:, 2 * j - 2 : 2 * j], x[:, j - 1], reference, frame)
        exists &= np.all(np.isfinite(v), axis=-1) & np.isfinite(log_j)
        v = np.where(exists[:, None], v, base.v[:, j])
        log_jacobian = log_jacobian + log_j
        frame = turn_minimally(frame, reference, v)
        if j == 1:
            first_frame = frame
            exists &= importance(world, v).real > 0
        if traced:
            triangle[:, j], met = meet(world, x[:, j - 1], v, triangle[:, j - 1], base.triangle[:, j], exists)
            exists &= met
        ng = world.normals[triangle[:, j]]
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = dot(world.corners[triangle[:, j], 0] - x[:, j - 1], ng) / dot(v, ng)
        x[:, j] = np.where(exists[:, None], x[:, j - 1] + reach[:, None] * v, base.x[:, j])
        paths = complete(world, base.length, base.ending, base.light, triangle, base.lobe, x)
    for j in (m + 1, m + 2):
        if j <= base.length:
            s[:, j] = reference_direction(surface(world, paths, j - 1), paths.v[:, j - 1])
    if traced:
        exists &= carries_on(world, base, paths, m)
        if m < base.length:
            exists[exists] = visible(world, paths.take(exists), m + 1)
    return Moved(paths, s, first_frame, log_jacobian, exists)


def meet(world: World, x: Array, v: Array, leaves: Array, otherwise: Array, wanted: Array) -> tuple[Array, Array]:
    """(triangle that each ray meets, whether it meets any); ``otherwise`` where it does not or is not wanted."""
    _, hit = world.cast(x[wanted], v[wanted], leaves[wanted])
    triangle = otherwise.copy()
    triangle[wanted] = np.where(hit >= 0, hit, otherwise[wanted])
    met = wanted.copy()
    met[wanted] = hit >= 0
    return triangle, met


def carries_on(world: World, base: Paths, paths: Paths, m: int) -> Array:
    """Whether the moved nodes can scatter as before: the same lobes and narrowness, an emitter at the end of a hit.

    And whether segments keep off the surfaces they join.
    """
    ok = np.ones(len(paths.light), bool)
    for j in range(1, m + 1):
        if j < paths.length:
            ok &= surface(world, paths, j).has_lobe & (surface(world, paths, j).narrow == surface(world, base, j).narrow)
    if m == paths.length and paths.ending == HIT:
        ok &= world.arrays["triangles"]["emitter"][paths.triangle[:, -1]] >= 0
    for j in range(1, min(m + 1, paths.length) + 1):
        ok &= keeps_off(world, paths, j)
    return ok


def keeps_off(world: World, paths: Paths, j: int) -> Array:
    """Whether segment j leaves both of its surfaces by more than the offset of rays."""
    ok = paths.t[:, j] > 0
    for i in (j - 1, j):
        rise = np.abs(dot(paths.ng[:, i], paths.v[:, j])) * paths.t[:, j]
        ok &= (rise > world.ray_offset) | (paths.triangle[:, i] < 0)
    return ok


def visible(world: World, paths: Paths, j: int) -> Array:
    """Whether nothing blocks segment j."""
    t, hit = world.cast(paths.x[:, j - 1], paths.v[:, j], paths.triangle[:, j - 1])
    return (hit == paths.triangle[:, j]) | (t > paths.reach[:, j] * (1 - 1e-9)) | np.isinf(t)


def joint_log_jacobian(paths: Paths, m: int) -> Array:
    """log dσ/dA of the direction that joins a shorter block to the fixed node x_{m+1}: its own delta is zero."""
    if m >= paths.free:
        return np.zeros(len(paths.light))
    with np.errstate(divide="ignore"):
        return np.log(magnitude(dot(paths.ng[:, m + 1], paths.v[:, m + 1]))) - 2 * np.log(paths.t[:, m + 1])


def log_climbed(charts: Charts, moved: Moved) -> Array:
    """What the drift climbs: log of the target's density in the charts' coordinates, up to a constant.

    Each lobe counts by its own luminance, as if colours were grey; the film's weight and textures, all but constant at
    the scale of a step, are left out.
    """
    world, paths = charts.world, moved.paths
    total = np.log(importance(world, paths.v[:, 1])) + moved.log_jacobian + joint_log_jacobian(paths, charts.m)
    for i in range(1, paths.length):
        total = total + np.log(lobe_value(surface(world, paths, i), -paths.v[:, i], paths.v[:, i + 1]) @ LUMINANCE)
    return total - 2 * np.log(paths.t[:, -1]) if paths.ending == CONNECT else total
