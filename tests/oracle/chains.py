"""Between the oracle and a Sampler: its scene, and its chains' paths read and written."""

from __future__ import annotations

import numpy as np

from pylmc.device_scene import SCENE_ARGUMENTS
from pylmc.sampler import Sampler

from .paths import Paths, paths_through
from .scene import World
from .vectors import Array


def world_of(sampler: Sampler) -> World:
    """The sampler's scene, with the weights over the film that its start has chosen."""
    device = sampler.device_scene
    initial = sampler.compiled.arrays["evenness"]
    buffer = device.buffers[list(SCENE_ARGUMENTS).index("evenness")]
    return World(sampler.compiled, device.read(buffer, initial.dtype, initial.shape))


def read_paths(sampler: Sampler, world: World) -> dict[tuple[int, int], tuple[Array, Paths]]:
    """The chains' paths by (length, ending): which chains, and the paths made again from triangles and barycentrics."""
    device = sampler.device_scene
    raw = device.read(sampler._states, device.dtypes["ChainState"], sampler.chains)
    out = {}
    for length, ending in sorted({(int(k), int(e)) for k, e in zip(raw["length"], raw["ending"], strict=True)}):
        which = np.flatnonzero((raw["length"] == length) & (raw["ending"] == ending))
        vertex = raw["vertex"][which][:, :length]
        u, v = vertex["bu"].astype(float), vertex["bv"].astype(float)
        weights = np.stack([1 - u - v, u, v], axis=-1)
        paths = paths_through(world, length, ending, raw["light"][which], vertex["triangle"], weights, vertex["lobe"])
        out[length, ending] = which, paths
    return out


def write_paths(sampler: Sampler, paths: Paths, weights: Array) -> None:
    """Make these paths (with the barycentric ``weights`` that they were made from) the chains' states."""
    device = sampler.device_scene
    n = len(paths.light)
    raw = np.zeros(n, device.dtypes["ChainState"])
    raw["length"], raw["ending"], raw["light"] = paths.length, paths.ending, paths.light
    vertex = raw["vertex"]
    for i in range(1, paths.length + 1):
        vertex["v"][:, i - 1], vertex["t"][:, i - 1] = paths.v[:, i], paths.t[:, i]
        vertex["bu"][:, i - 1], vertex["bv"][:, i - 1] = weights[:, i - 1, 1], weights[:, i - 1, 2]
        vertex["triangle"][:, i - 1], vertex["lobe"][:, i - 1] = paths.triangle[:, i], paths.lobe[:, i]
    sampler._states = device.upload(raw)
    sampler.chains = n
