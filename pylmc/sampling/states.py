"""Chains as host arrays: what a Sampler hands out, what its chains counted, and the content of the chains themselves."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..device import tables
from ..device.arrays import Records
from ..device.device_scene import DeviceScene


class ChainArrays(NamedTuple):
    """All that a chain holds between steps, chains first. K is the greatest path length; what is beyond a path's own is idle.

    length, ending (chains,): segments, 0 connect or 1 hit. light: which of the scene's lights the path is connected to.
    group: the chain's place in its State's ``groups``. log_i: log of the density, -inf for a dark chain; log_p: log of the
    independent sampler's density, NaN (or below -1e29) where it is not known. colour (chains, 3): what the chain splats. v
    (chains, K, 3) and t (chains, K): each segment's direction and length, in scaled units. barycentrics (chains, K, 2),
    triangle, lobe (chains, K): the node that it leads to; triangle -1 for a light without area.
    """

    length: np.ndarray
    ending: np.ndarray
    light: np.ndarray
    group: np.ndarray
    log_i: np.ndarray
    log_p: np.ndarray
    colour: np.ndarray
    v: np.ndarray
    t: np.ndarray
    barycentrics: np.ndarray
    triangle: np.ndarray
    lobe: np.ndarray

    def only(self, which: np.ndarray) -> ChainArrays:
        """Some of the chains: those that an index or a mask selects."""
        return ChainArrays(*(array[which] for array in self))


def no_chains(count: int, max_depth: int) -> ChainArrays:
    """Arrays for ``count`` chains of paths of up to ``max_depth`` segments, zero everywhere."""
    integers = [np.zeros(count, np.int32) for _ in range(4)]
    numbers = [np.zeros((count, *shape)) for shape in ((), (), (3,), (max_depth, 3), (max_depth,), (max_depth, 2))]
    return ChainArrays(*integers, *numbers, *(np.zeros((count, max_depth), np.int32) for _ in range(2)))


CHAIN_FIELDS = {"length": "length", "ending": "ending", "light": "light", "slot": "group", "log_i": "log_i", "log_p": "log_p"}
VERTEX_FIELDS = ("v", "t", "triangle", "lobe")


def chain_arrays(chains: Records) -> ChainArrays:
    """The chains that lie on a device, as host arrays."""
    raw = chains.read()
    vertex = raw["vertex"]
    return ChainArrays(
        **{ours: raw[theirs] for theirs, ours in CHAIN_FIELDS.items()},
        colour=raw["colour"],
        **{name: vertex[name] for name in VERTEX_FIELDS},
        barycentrics=np.stack([vertex["bu"], vertex["bv"]], axis=-1),
    )


def chain_records(device: DeviceScene, arrays: ChainArrays) -> Records:
    """Host arrays as chains on a device, whose greatest path length must be theirs."""
    vertex = np.dtype(tables.CHAIN_VERTEX)
    raw = np.zeros(len(arrays.length), tables.chain_state(device.settings.max_depth, vertex))
    for theirs, ours in CHAIN_FIELDS.items():
        raw[theirs] = getattr(arrays, ours)
    raw["colour"] = arrays.colour
    for name in VERTEX_FIELDS:
        raw["vertex"][name] = getattr(arrays, name)
    raw["vertex"]["bu"], raw["vertex"]["bv"] = np.moveaxis(arrays.barycentrics, -1, 0)
    return Records.of(device, "ChainState", raw)


class States(NamedTuple):
    """The chains as arrays, chains first. K is the greatest path length; entries beyond a path's own are NaN (or -1).

    length, ending (chains,): segments, 0 connect or 1 hit. v_1 (chains, 3). nodes x_1 … x_K (chains, K, 3), in scene
    units; directions v_1 … v_K (chains, K, 3). deviations Ω_i (chains, K, 2): of v_{i+1} from the lobe's reference
    direction at x_i. lobes (chains, K): places in ``pylmc.lobes.KINDS``, whose ``name`` says which. kinds (chains, K): each
    free direction's chart: 0 projection, 1 deviation, 2 next node, 3 + i portal i. log_pi: log of the target I in scaled
    units; log_p: log of the independent sampler's density. factors L (chains, 2 K, 2 K): Q = L Lᵀ. gradients (chains, 2 K):
    of the log density in the charts' coordinates, where drift is on. A path with a direction out of its chart's reach
    (orthographic charts reach half the sphere) has kinds -1 and L = 0: only large steps move it.
    """

    length: np.ndarray
    ending: np.ndarray
    v_1: np.ndarray
    nodes: np.ndarray
    directions: np.ndarray
    deviations: np.ndarray
    lobes: np.ndarray
    kinds: np.ndarray
    log_pi: np.ndarray
    log_p: np.ndarray
    factors: np.ndarray
    gradients: np.ndarray


class Trial(NamedTuple):
    """One step of each chain, tried and not taken; chains first. K is the greatest path length.

    move (chains,): the step's column among the counters' ``moves``: 0 a large step, m a small one of the block of m
    directions, K + 1 another light. h: the small step's length, and xi
    (chains, 2 K) its standard normal numbers; NaN beyond. exists: whether there was a proposal that carries light; where
    there was none the rest is NaN (or -1). nodes x_1 … x_K (chains, K, 3), in scaled units, directions v_1 … v_K, lobes and
    triangles (chains, K): the proposal. log_forward, log_reverse: log p(X̂|X) and log p(X|X̂), per solid angle of the
    directions that moved. log_pi: log of the density I at the proposal. acceptance: the probability of it, 0 without a
    proposal; drawn: the uniform number that decides; accepted: whether it is below.
    """

    move: np.ndarray
    h: np.ndarray
    xi: np.ndarray
    exists: np.ndarray
    nodes: np.ndarray
    directions: np.ndarray
    lobes: np.ndarray
    triangles: np.ndarray
    log_forward: np.ndarray
    log_reverse: np.ndarray
    log_pi: np.ndarray
    acceptance: np.ndarray
    drawn: np.ndarray
    accepted: np.ndarray


class Counters(NamedTuple):
    """What the chains counted since the last call: chains first, then a column for each of ``moves``, which are their names.

    trace (chains, 2): where on the film (x to the right, y down, 0 to 1) each chain is now.
    """

    proposed: np.ndarray
    acceptance: np.ndarray
    trace: np.ndarray
    not_finite: int
    rays: int
    moves: tuple[str, ...]
