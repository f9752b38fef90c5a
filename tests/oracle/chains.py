"""Between the oracle and a Sampler: its scene, and its chains' paths read and written."""

from __future__ import annotations

import numpy as np

from pylmc.device import tables
from pylmc.device.tables import SCENE_ARRAYS
from pylmc.sampling.sampler import Sampler

from .integrand import log_pi
from .paths import Paths, paths_through
from .scene import World
from .vectors import Array


def world_of(sampler: Sampler) -> World:
    """The sampler's scene, with the weights over the film that its start has chosen."""
    device = sampler.device_scene
    initial = sampler.compiled.arrays["evenness"]
    buffer = device.buffers[list(SCENE_ARRAYS).index("evenness")]
    return World(sampler.compiled, device.read(buffer, initial.dtype, initial.shape), sampler.settings.aim)


def read_states(sampler: Sampler) -> Array:
    """The chains' states as structs of float32 or float64."""
    return sampler.device_scene.read_struct(sampler._states, "ChainState", sampler.chains)


def paths_of(world: World, states: Array) -> dict[tuple[int, int], tuple[Array, Paths]]:
    """Paths by (length, ending): which states, and the paths made again from triangles and barycentrics."""
    out = {}
    for length, ending in sorted({(int(k), int(e)) for k, e in zip(states["length"], states["ending"], strict=True)}):
        which = np.flatnonzero((states["length"] == length) & (states["ending"] == ending))
        vertex = states["vertex"][which][:, :length]
        u, v = vertex["bu"].astype(float), vertex["bv"].astype(float)
        weights = np.stack([1 - u - v, u, v], axis=-1)
        paths = paths_through(world, length, ending, states["light"][which], vertex["triangle"], weights, vertex["lobe"])
        out[length, ending] = which, paths
    return out


def read_paths(sampler: Sampler, world: World) -> dict[tuple[int, int], tuple[Array, Paths]]:
    """The chains' paths."""
    return paths_of(world, read_states(sampler))


def write_states(sampler: Sampler, states: Array) -> None:
    """Make these structs the chains' states, whether or not the sampler has been started."""
    sampler._states = sampler.device_scene.upload_struct(states, "ChainState")
    sampler.chains = len(states)
    sampler.groups = sampler.groups or sampler.path_groups()


def adopt(sampler: Sampler, world: World, states: Array) -> None:
    """Make another sampler's states, of the same greatest length, the chains of one that has not been started.

    Directions, lengths and log I are those of the nodes in this sampler's numbers; log p_ind is left for it to find.
    """
    states = states.copy()
    for which, paths in paths_of(world, states).values():
        vertex = states["vertex"][which]
        vertex["v"][:, : paths.length], vertex["t"][:, : paths.length] = paths.v[:, 1:], paths.t[:, 1:]
        states["vertex"][which] = vertex
        states["log_i"][which] = log_pi(world, paths)
    states["log_p"] = np.nan
    write_states(sampler, states)


def write_paths(sampler: Sampler, paths: Paths, weights: Array) -> None:
    """Make these paths (with the barycentric ``weights`` that they were made from) the chains' states."""
    raw = np.zeros(len(paths.light), tables.chain_state(sampler.settings.max_depth, np.dtype(tables.CHAIN_VERTEX)))
    raw["length"], raw["ending"], raw["light"] = paths.length, paths.ending, paths.light
    vertex = raw["vertex"]
    for i in range(1, paths.length + 1):
        vertex["v"][:, i - 1], vertex["t"][:, i - 1] = paths.v[:, i], paths.t[:, i]
        vertex["bu"][:, i - 1], vertex["bv"][:, i - 1] = weights[:, i - 1, 1], weights[:, i - 1, 2]
        vertex["triangle"][:, i - 1], vertex["lobe"][:, i - 1] = paths.triangle[:, i], paths.lobe[:, i]
    write_states(sampler, raw)
