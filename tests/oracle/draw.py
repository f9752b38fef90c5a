"""A path of the independent sampler (theory.md, 6) from given random numbers: its split, then nodes from both ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .displaced import keeps_off, visible
from .integrand import importance, log_pi
from .lights import sample_emission
from .lobes import Surface, choose_lobe, settled_lobe
from .paths import CONNECT, HIT, Paths, complete, surface
from .random import Streams
from .sampling import sample_camera, sample_emitter, sample_emitter_emission, sample_light, sample_scatter
from .scene import World
from .vectors import Array, unit


class Draft:
    """Paths being drawn: what is known so far, and which are still alive."""

    def __init__(self, world: World, length: int, ending: int, n: int) -> None:
        self.world, self.length, self.ending = world, length, ending
        self.x = np.zeros((n, length + 1, 3))
        self.x[:, 0] = world.origin
        self.triangle, self.lobe = np.full((n, length + 1), -1), np.full((n, length + 1), -1)
        self.light, self.alive = np.zeros(n, int), np.ones(n, bool)

    def node(self, i: int) -> Surface:
        """Node i as a scatterer."""
        world, triangle, x = self.world, np.maximum(self.triangle[:, i], 0), self.x[:, i]
        return Surface(
            x,
            world.normals[triangle],
            world.shading_normal(triangle, x),
            world.texture(triangle, x),
            world.materials[triangle],
            self.lobe[:, i],
        )

    def trace(self, i: int, j: int, direction: Array, wanted: Array, streams: Streams) -> None:
        """Node j is what rays from node i along ``direction`` meet, with a lobe of its material's choice."""
        t, hit = self.world.cast(self.x[wanted, i], direction[wanted], self.triangle[wanted, i])
        self.x[wanted, j] = self.x[wanted, i] + np.where(hit >= 0, t, 1.0)[:, None] * direction[wanted]
        self.triangle[wanted, j] = hit
        self.alive[wanted] &= hit >= 0
        self.alive[wanted] &= keeps_off(self.world, self.path(), max(i, j))[wanted]
        going = wanted & self.alive
        self.lobe[going, j] = choose_lobe(self.node(j), streams, going)[going]

    def path(self) -> Paths:
        """The path as it stands."""
        return complete(self.world, self.length, self.ending, self.light, self.triangle, self.lobe, self.x)


def draw_path(world: World, length: int, ending: int, streams: Streams) -> tuple[Paths, Array]:
    """(paths, whether the draw came to one) of the given length and ending, one from each stream."""
    n = len(streams.used)
    draft = Draft(world, length, ending, n)
    everyone = np.ones(n, bool)
    split = streams.index(length + 1 if ending == HIT else length, everyone)
    for i in range(1, length + 1):  # x_1 … x_k from the camera
        wanted = draft.alive & (split >= i)
        if i == 1:
            direction = sample_camera(world, streams, wanted)
            ok = importance(world, direction) > 0
        else:
            known = unit(draft.x[:, i - 2] - draft.x[:, i - 1])
            direction, ok = sample_scatter(world, draft.node(i - 1), known, streams, wanted)
        draft.alive &= ok | ~wanted
        draft.trace(i - 1, i, direction, wanted & draft.alive, streams)
    from_light = draft.alive & (split < length)
    if ending == CONNECT:
        draft.light = np.where(from_light, sample_light(world, streams, from_light), 0)
    else:
        triangle, x = sample_emitter(world, streams, from_light)
        draft.triangle[from_light, -1], draft.x[from_light, -1] = triangle[from_light], x[from_light]
        normal = world.normals[draft.triangle[:, -1]]
    for j in range(length - 1, 0, -1):  # x_{k+1} … x_{K-1} from the light
        wanted = draft.alive & (split < j)
        if j == length - 1 and ending == CONNECT:
            draft.x[wanted, -1], direction = sample_emission(world, draft.light, streams, wanted)
            ok = everyone
        elif j == length - 1:
            direction, ok = sample_emitter_emission(world, draft.x[:, -1], normal, streams, wanted), everyone
        else:
            known = unit(draft.x[:, j + 2] - draft.x[:, j + 1])
            direction, ok = sample_scatter(world, draft.node(j + 1), known, streams, wanted)
        draft.alive &= ok | ~wanted
        draft.trace(j + 1, j, direction, wanted & draft.alive, streams)
    paths = settled(world, draft.path())
    exists = draft.alive & np.isfinite(np.where(draft.alive, log_pi(world, paths), -np.inf))
    for k in range(length):  # the segment that joins the two parts
        joins = np.flatnonzero(exists & (split == k))
        joined = paths.take(joins)
        exists[joins] = keeps_off(world, joined, k + 1) & visible(world, joined, k + 1)
    return paths, exists


def settled(world: World, paths: Paths) -> Paths:
    """With each dielectric node's lobe as the directions say."""
    lobe = paths.lobe.copy()
    for i in range(1, paths.length):
        lobe[:, i] = settled_lobe(surface(world, paths, i), paths.v[:, i], paths.v[:, i + 1])
    return replace(paths, lobe=lobe)
