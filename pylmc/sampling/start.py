"""The start of chains in their density: weigh independent paths, resample them in proportion (theory.md, 6)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..device import tables
from ..device.arrays import Floats, Records
from ..device.device_scene import DeviceScene
from ..errors import PylmcError
from .chains import State, begun
from .evenness import GRID, even_weights
from .groups import Group

CANDIDATES_PER_LAUNCH = 1 << 17
PILOT_FROM = 1 << 31  # numbers of the pilot's paths, beyond those of any start's candidates
FEWEST = 8  # chains of a group
DARK_UNIT = 1e-4  # of all light: what the weights of a group are counted in of which nothing is known


def path_groups(device: DeviceScene) -> list[Group]:
    """A group for each path length and ending that the settings admit, nothing known of them yet."""
    longest, endings = device.settings.max_depth, device.compiled.endings
    kinds = [(k, e) for k in range(1, longest + 1) for e in endings if k > 1 or e == 1]
    if not kinds:
        raise PylmcError(
            "max_depth=1 leaves only emitters seen directly, and this scene has point lights only; use --max-depth 2 or more"
        )
    return [Group(length, ending, slot, np.zeros(0), np.zeros((0, 2))) for slot, (length, ending) in enumerate(kinds)]


def weigh(
    device: DeviceScene, candidates: int, seed: int, evenness: Floats | None = None, numbers_from: int = 0
) -> list[Group]:
    """Draw ``candidates`` independent paths per group and keep their weights I / p_ind: the estimate of each b.

    I is luminance times ``evenness``. Paths are named by ``seed`` and their numbers, from ``numbers_from`` on. Touches no
    chains. Where nothing carries light all weights are zero: see :func:`check_found`.
    """
    groups = path_groups(device)
    kernel = device.kernel("entry/bootstrap.cl", "weigh_candidates")
    out, out_positions = device.zero_reals(CANDIDATES_PER_LAUNCH), device.zero_reals(2 * CANDIDATES_PER_LAUNCH)
    for group in groups:
        parts, places = [], []
        for first in range(0, candidates, CANDIDATES_PER_LAUNCH):
            count = min(CANDIDATES_PER_LAUNCH, candidates - first)
            device.launch(
                kernel,
                count,
                np.uint32(seed),
                np.uint32(group.slot),
                np.int32(group.length),
                np.int32(group.ending),
                np.uint32(numbers_from + first),
                np.uint32(count),
                out,
                out_positions,
                evenness=None if evenness is None else evenness.buffer,
            )
            parts.append(device.read_reals(out, CANDIDATES_PER_LAUNCH)[:count])
            places.append(device.read_reals(out_positions, (CANDIDATES_PER_LAUNCH, 2))[:count])
        group.log_weights = np.concatenate(parts).astype(np.float64)
        group.positions = np.concatenate(places)
        group.weighed = candidates
        group.settle()
    return groups


def check_found(groups: list[Group], candidates: int, max_depth: int) -> None:
    """Raises PylmcError if no path of any group carries light."""
    if not any(group.weight_sum > 0 for group in groups):
        raise PylmcError(
            f"no light path was found in {candidates * len(groups)} tries (up to {max_depth} segments): check "
            "that the camera sees a surface that light can reach, or raise --max-depth"
        )


class Pilot(NamedTuple):
    """What a start must know beforehand, from paths that are none of its own, the same ones whatever the seed.

    evenness: the density's weights (GRID, GRID) over the film, by a rough picture; ones where settings say so. Fitted to
    the candidates that they then weigh they would come out too low, and b with them. shares: each group's part of the
    light. Shares by the start's own candidates would give a group the fewer large steps the less light these found.
    """

    evenness: np.ndarray
    shares: np.ndarray


def pilot(device: DeviceScene, candidates: int, evenness: np.ndarray | None = None) -> Pilot:
    """From a quarter of a start's ``candidates``. ``evenness``: weights of one's own."""
    groups = weigh(device, max(candidates // 4, 1), 0, numbers_from=PILOT_FROM)
    weights = [np.exp(group.log_weights) for group in groups]
    if evenness is None:
        positions = np.concatenate([group.positions for group in groups])
        even = device.settings.even
        evenness = even_weights(positions, np.concatenate(weights)) if even else np.ones((GRID, GRID), np.float32)
    light = np.zeros(len(groups))
    for i, (group, weight) in enumerate(zip(groups, weights, strict=True)):
        found = weight > 0
        x, y = np.minimum((group.positions[found] * GRID).astype(int), GRID - 1).T
        light[i] = (weight[found] * evenness[y, x]).sum()
    total = light.sum()
    return Pilot(evenness, light / total if total > 0 else np.full(len(groups), 1 / len(groups)))


def start(device: DeviceScene, seed: int, chains: int, candidates: int, evenness: np.ndarray | None = None) -> State:
    """``chains`` chains in their density: candidates, resampled in proportion to their weights.

    Chains are shared out among the groups in proportion to b, as a pilot found it. A group in which the candidates found no
    light has streams of independent paths in place of its chains. ``evenness``: weights (GRID, GRID) of the density over
    the film; None: the pilot's. The same seed gives the same chains. Raises PylmcError if no path carries light.
    """
    known = pilot(device, candidates, evenness)
    weights = Floats(device, known.evenness)
    weighed = weigh(device, candidates, seed, weights)
    check_found(weighed, candidates, device.settings.max_depth)
    for group, share in zip(weighed, known.shares, strict=True):
        group.chains = max(round(chains * share), FEWEST)
    groups, dark = [g for g in weighed if g.weight_sum > 0], [g for g in weighed if not g.weight_sum > 0]
    total = sum(group.b for group in groups)
    first = 0
    for group in (*groups, *dark):
        group.streams = not group.weight_sum > 0
        group.first, group.unit = first, group.b or DARK_UNIT * total
        first += group.chains
    rng = np.random.default_rng([seed, 1])
    starts = [_resampled(group, slot, rng) for slot, group in enumerate(groups)]
    table = Records.of(device, "ChainStart", np.concatenate(starts))
    states = Records(device, "ChainState", table.count)
    kernel = device.kernel("entry/bootstrap.cl", "start_chains")
    device.launch(
        kernel, table.count, np.uint32(seed), np.uint32(table.count), table.buffer, states.buffer, evenness=weights.buffer
    )
    origins = np.concatenate([part["number"] for part in starts])
    return begun(states, groups, weights, seed, origins, dark, sum(group.not_finite for group in weighed))


def _resampled(group: Group, slot: int, rng: np.random.Generator) -> np.ndarray:
    """The table from which the kernel starts a group's chains: systematic resampling of its candidates."""
    weights = np.exp(group.log_weights - group.log_weights.max())
    points = (np.arange(group.chains) + rng.random()) / group.chains * weights.sum()
    chosen = np.minimum(np.searchsorted(np.cumsum(weights), points, side="right"), len(weights) - 1)
    part = np.zeros(group.chains, tables.CHAIN_START)
    part["group"], part["slot"], part["number"] = group.slot, slot, chosen
    part["length"], part["ending"] = group.length, group.ending
    return part
