"""Chains as values: ``step(state, n, film) -> (State, Info)`` (theory.md, 6); pylmc.sampling.start makes the first State."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from typing import Any, NamedTuple

import numpy as np

from ..device import tables
from ..device.arrays import Film, Floats, Records
from ..device.device_scene import DeviceScene
from .films import places
from .groups import Group
from .states import ChainArrays, chain_arrays, chain_records

STEPS_PER_LAUNCH = 32  # so that counters of 32 bits do not overflow, and a launch does not hold a display's device for long


class Info(NamedTuple):
    """What chains counted, chains first, and after them the streams of independent paths that dark groups have.

    Columns are moves: 0 the large step (a stream's only one), m the block of m directions.
    proposed, acceptance (chains, moves). weight, weight_square (chains,): sums over large steps of I / p_ind and its square.
    splatted (chains,): luminance added to the film. trace (chains, 2): where on the film (x to the right, y down, 0 to 1)
    each chain is now. not_finite, rays (chains,): steps whose density was no number; rays traced.
    """

    proposed: np.ndarray
    acceptance: np.ndarray
    weight: np.ndarray
    weight_square: np.ndarray
    splatted: np.ndarray
    trace: np.ndarray
    not_finite: np.ndarray
    rays: np.ndarray

    def __add__(self, later: Any) -> Info:
        """Of these steps and the ``later`` ones."""
        return Info(*(ours + theirs for ours, theirs in zip(self, later, strict=True)))._replace(trace=later.trace)

    def since(self, earlier: Info) -> Info:
        """Of the steps after ``earlier``, which counted the first of them."""
        return Info(*(ours - theirs for ours, theirs in zip(self, earlier, strict=True)))._replace(trace=self.trace)


class State(NamedTuple):
    """A run's chains. ``step`` consumes it: what it holds on the device goes to the State that ``step`` returns.

    chains: on the device; :meth:`arrays` has them as host arrays. counters: on the device, of the launch under way. groups:
    who the chains are, and the start's candidates. counted: what the chains have counted in all; settled: up to the last
    whole launch of STEPS_PER_LAUNCH steps, so that sums do not depend on how the steps were asked for. evenness: the
    density's weights over the film, which the start has learnt. steps: how many are done; they name the random numbers,
    together with ``seed``. origins (chains,): the candidate that each chain started from. dark: the groups in which the
    start found no light; independent paths are drawn for them in place of chains' steps, by ``streams``. not_finite:
    candidates whose weight was no number.
    """

    chains: Records
    counters: Records
    groups: tuple[Group, ...]
    counted: Info
    settled: Info
    evenness: Floats
    steps: int
    seed: int
    origins: np.ndarray
    dark: tuple[Group, ...]
    streams: Records | None
    not_finite: int

    def arrays(self) -> ChainArrays:
        """The chains as host arrays. Raises PylmcError if the state was consumed."""
        return chain_arrays(self.chains)

    def by_group(self, values: np.ndarray) -> np.ndarray:
        """Sums (groups, ...) of an Info's values over each group's chains, or streams: groups first, then dark ones."""
        both = (*self.groups, *self.dark)
        return np.array([values[group.first : group.first + group.chains].sum(axis=0) for group in both])


def begun(
    chains: Records,
    groups: Sequence[Group],
    evenness: Floats,
    seed: int,
    origins: np.ndarray,
    dark: Sequence[Group] = (),
    not_finite: int = 0,
) -> State:
    """A State of chains that have made no step, and of the streams of ``dark`` groups, which are counted after them."""
    count = chains.count + sum(group.chains for group in dark)
    counters = Records(chains.device, "ChainCounters", count)
    nothing = _read(counters, np.ones(count))
    streams = independent_streams(chains.device, dark, len(groups)) if dark else None
    return State(
        chains, counters, tuple(groups), nothing, nothing, evenness, 0, seed, origins, tuple(dark), streams, not_finite
    )


def independent_streams(device: DeviceScene, groups: Sequence[Group], first_place: int) -> Records:
    """The table from which entry/bdpt.cl draws a stream for each chain of ``groups``, a place of the film a group."""
    parts = []
    for place, group in enumerate(groups, first_place):
        part = np.zeros(group.chains, tables.CHAIN_START)
        part["length"], part["ending"], part["slot"], part["scale"] = group.length, group.ending, place, 1 / group.unit
        parts.append(part)
    return Records.of(device, "ChainStart", np.concatenate(parts))


def resume(device: DeviceScene, arrays: ChainArrays, groups: Sequence[Group], evenness: np.ndarray, seed: int = 0) -> State:
    """A State of chains from host arrays, as if they had just been started; ``groups`` say which are whose."""
    chains = chain_records(device, arrays)
    return begun(chains, groups, Floats(device, evenness), seed, np.arange(chains.count))


def step(state: State, n: int, film: Film, **constants: Any) -> tuple[State, Info]:
    """Advance every chain by ``n`` steps, splatting into its group's slot of ``film``, and wait.

    Where the film has fewer slots than there are groups, those of the longest paths share one: see
    :mod:`pylmc.sampling.films`. Launches end at whole multiples of STEPS_PER_LAUNCH steps and where the call does; how the
    steps are shared out among calls changes nothing. ``constants`` replace kernel constants, for those who study variants
    of the kernel. Consumes ``state``. Raises PylmcError if it was consumed before.
    """
    chains, counters = state.chains.take(), state.counters.take()
    device, count = chains.device, chains.count
    kernel = device.kernel("entry/chains.cl", "run_chains", **constants)
    numbers = device.upload(device.moves.numbers())
    groups = (*state.groups, *state.dark)
    units = np.ones(counters.count)
    for group in groups:
        units[group.first : group.first + group.chains] = group.unit
    placed = places(groups, film.slots)
    table = placed.table(device, refined(state, state.settled))
    settled, counted, done = state.settled, state.counted, 0
    while True:
        steps = min(STEPS_PER_LAUNCH - (state.steps + done) % STEPS_PER_LAUNCH, n - done)
        device.launch(
            kernel,
            count,
            np.uint32(state.seed),
            np.uint64(state.steps + done),
            np.int32(steps),
            np.uint32(count),
            numbers,
            table.buffer,
            chains.buffer,
            counters.buffer,
            film.buffer,
            np.int32(film.pixels),
            evenness=state.evenness.buffer,
        )
        if state.streams is not None:
            device.launch(
                device.kernel("entry/bdpt.cl", "render_independent"),
                state.streams.count,
                np.uint32(state.seed),
                np.uint64(state.steps + done),
                np.int32(steps),
                np.uint32(state.streams.count),
                np.uint32(count),
                state.streams.buffer,
                table.buffer,
                counters.buffer,
                film.buffer,
                np.int32(film.pixels),
                evenness=state.evenness.buffer,
            )
        done += steps
        counted = settled + _read(counters, units)
        if steps and (state.steps + done) % STEPS_PER_LAUNCH == 0:
            settled = counted
            counters.clear()
            if placed.shared.any() and done < n:
                table = placed.table(device, refined(state, settled))
        if done >= n:
            break
    moved = state._replace(chains=chains, counters=counters, counted=counted, settled=settled, steps=state.steps + n)
    return moved, counted.since(state.counted)


def refined(state: State, counted: Info) -> list[Group]:
    """Copies of the state's groups, dark ones last, that know what was counted."""
    groups = [copy(group) for group in (*state.groups, *state.dark)]
    refine(groups, state, counted)
    return groups


def refine(groups: Sequence[Group], state: State, counted: Info) -> None:
    """Have the state's ``groups``, dark ones last, know what was counted."""
    sums = (state.by_group(values) for values in (counted.proposed, counted.weight, counted.weight_square))
    large_steps = state.chains.device.settings.large_steps
    for group, begun, moves, weight, square in zip(groups, (*state.groups, *state.dark), *sums, strict=True):
        steps = int(moves.sum()) // max(group.chains, 1)
        group.refine(begun, steps, int(moves[0]), float(weight), float(square), large_steps)


def _read(counters: Records, units: np.ndarray) -> Info:
    raw = counters.read()
    return Info(
        raw["proposed"].astype(np.int64),
        raw["acceptance"].astype(np.float64),
        raw["weight_sum"].astype(np.float64) * units,
        raw["weight_square_sum"].astype(np.float64) * units**2,
        raw["splatted"].astype(np.float64),
        raw["trace"].copy(),  # a view would keep all of the counters
        raw["not_finite"].astype(np.int64),
        raw["rays"].astype(np.int64),
    )
