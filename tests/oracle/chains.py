"""Between the oracle and a Sampler: its scene, and its chains' paths read and written."""

from __future__ import annotations

import numpy as np

from pylmc.sampling.chains import resume
from pylmc.sampling.evenness import GRID
from pylmc.sampling.sampler import Sampler
from pylmc.sampling.states import ChainArrays, no_chains

from .integrand import log_pi
from .paths import Paths, paths_through
from .scene import World
from .vectors import Array


def world_of(sampler: Sampler) -> World:
    """The sampler's scene, with the weights over the film that its start has chosen; ones before it has."""
    return World(sampler.compiled, evenness_of(sampler), sampler.settings.aim)


def evenness_of(sampler: Sampler) -> Array:
    return sampler.evenness if sampler.groups else np.ones((GRID, GRID), np.float32)


def paths_of(world: World, states: ChainArrays) -> dict[tuple[int, int], tuple[Array, Paths]]:
    """Paths by (length, ending): which states, and the paths made again from triangles and barycentrics."""
    out = {}
    for length, ending in sorted({(int(k), int(e)) for k, e in zip(states.length, states.ending, strict=True)}):
        which = np.flatnonzero((states.length == length) & (states.ending == ending))
        u, v = np.moveaxis(states.barycentrics[which, :length].astype(float), -1, 0)
        weights = np.stack([1 - u - v, u, v], axis=-1)
        triangle, lobe = states.triangle[which, :length], states.lobe[which, :length]
        paths = paths_through(world, length, ending, states.light[which], triangle, weights, lobe)
        out[length, ending] = which, paths
    return out


def read_paths(sampler: Sampler, world: World) -> dict[tuple[int, int], tuple[Array, Paths]]:
    """The chains' paths."""
    return paths_of(world, sampler.state.arrays())


def write_states(sampler: Sampler, states: ChainArrays) -> None:
    """Make these the chains' states, whether or not the sampler has been started."""
    groups = sampler.groups or sampler.path_groups()
    sampler.resume(resume(sampler.device_scene, states, groups, evenness_of(sampler)))


def adopt(sampler: Sampler, world: World, states: ChainArrays) -> None:
    """Make another sampler's states, of the same greatest length, the chains of one that has not been started.

    Directions, lengths and log I are those of the nodes in this sampler's numbers; log p_ind is left for it to find.
    """
    v, t, log_i = states.v.copy(), states.t.copy(), states.log_i.copy()
    for which, paths in paths_of(world, states).values():
        v[which, : paths.length], t[which, : paths.length] = paths.v[:, 1:], paths.t[:, 1:]
        log_i[which] = log_pi(world, paths)
    write_states(sampler, states._replace(v=v, t=t, log_i=log_i, log_p=np.full_like(log_i, np.nan)))


def write_paths(sampler: Sampler, paths: Paths, weights: Array) -> None:
    """Make these paths (with the barycentric ``weights`` that they were made from) the chains' states."""
    count, k = len(paths.light), paths.length
    states = no_chains(count, sampler.settings.max_depth)
    states.length[:], states.ending[:], states.light[:] = k, paths.ending, paths.light
    states.v[:, :k], states.t[:, :k] = paths.v[:, 1 : k + 1], paths.t[:, 1 : k + 1]
    states.barycentrics[:, :k] = weights[:, :k, 1:]
    states.triangle[:, :k], states.lobe[:, :k] = paths.triangle[:, 1 : k + 1], paths.lobe[:, 1 : k + 1]
    write_states(sampler, states)
