"""Chains as values: ``step(state, n, film) -> (State, Info)`` (theory.md, 6); pylmc.sampling.start makes the first State."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ..device.arrays import Film, Floats, Records
from ..device.device_scene import DeviceScene
from .groups import Group
from .states import ChainArrays, chain_arrays, chain_records

STEPS_PER_LAUNCH = 32  # so that counters of 32 bits do not overflow, and a launch does not hold a display's device for long


class Sums(NamedTuple):
    """The weights I / p_ind of independent paths by group, (groups,) each, the start's and those of large steps."""

    weighed: np.ndarray
    weight: np.ndarray
    weight_square: np.ndarray


class State(NamedTuple):
    """A run's chains. ``step`` consumes it: what it holds on the device goes to the State that ``step`` returns.

    chains: on the device; :meth:`arrays` has them as host arrays. groups: who they are, and the start's candidates.
    counts: what the run's chains have counted by group, (groups, moves) each. sums: see :class:`Sums`. evenness: the
    density's weights over the film, which the start has learnt. steps: how many are done; they name the random numbers,
    together with ``seed``. dark: names of the groups in which the start found no light. not_finite: steps and candidates
    whose density was no number. rays: traced by steps.
    """

    chains: Records
    groups: tuple[Group, ...]
    proposed: np.ndarray
    acceptance: np.ndarray
    sums: Sums
    evenness: Floats
    steps: int
    seed: int
    dark: tuple[str, ...]
    not_finite: int
    rays: int

    def arrays(self) -> ChainArrays:
        """The chains as host arrays. Raises PylmcError if the state was consumed."""
        return chain_arrays(self.chains)


class Info(NamedTuple):
    """What the steps of one call counted, chains first; columns are moves: 0 the large step, m the block of m directions.

    proposed, acceptance (chains, moves). weight, weight_square (chains,): sums over large steps of I / p_ind and its square.
    trace (chains, 2): where on the film (x to the right, y down, 0 to 1) each chain is now.
    """

    proposed: np.ndarray
    acceptance: np.ndarray
    weight: np.ndarray
    weight_square: np.ndarray
    trace: np.ndarray
    not_finite: int
    rays: int

    def __add__(self, later: Any) -> Info:
        """Of these steps and the ``later`` ones."""
        return Info(
            *(
                theirs if name == "trace" else ours + theirs
                for name, ours, theirs in zip(self._fields, self, later, strict=True)
            )
        )


def begun(
    chains: Records, groups: Sequence[Group], evenness: Floats, seed: int, dark: tuple[str, ...] = (), not_finite: int = 0
) -> State:
    """A State of chains that have made no step."""
    sums = Sums(
        np.array([group.weighed for group in groups], np.int64),
        np.array([group.weight_sum for group in groups], np.float64),
        np.array([group.weight_square_sum for group in groups], np.float64),
    )
    shape = len(groups), chains.device.settings.max_depth + 1
    counts = np.zeros(shape, np.int64), np.zeros(shape)
    return State(chains, tuple(groups), *counts, sums, evenness, 0, seed, dark, not_finite, 0)


def resume(device: DeviceScene, arrays: ChainArrays, groups: Sequence[Group], evenness: np.ndarray, seed: int = 0) -> State:
    """A State of chains from host arrays, as if they had just been started; ``groups`` say which are whose."""
    return begun(chain_records(device, arrays), groups, Floats(device, evenness), seed)


def step_numbers(device: DeviceScene) -> tuple[np.float32, np.float32, np.float32]:
    """What markov_step.cl needs to know of a step: the probability of a large one, and the range of log h."""
    low, high = device.settings.step_length
    return np.float32(device.settings.large_steps), np.float32(np.log(low)), np.float32(np.log(high))


def step(state: State, n: int, film: Film, **constants: Any) -> tuple[State, Info]:
    """Advance every chain by ``n`` steps, splatting into its group's slot of ``film``, and wait.

    ``constants`` replace kernel constants, for those who study variants of the kernel. Consumes ``state``. Raises
    PylmcError if it was consumed before.
    """
    chains = state.chains.take()
    device, count = chains.device, chains.count
    kernel = device.kernel("entry/chains.cl", "run_chains", **constants)
    counters = Records(device, "ChainCounters", count)
    info = None
    for done in range(0, max(n, 1), STEPS_PER_LAUNCH):
        device.launch(
            kernel,
            count,
            np.uint32(state.seed),
            np.uint64(state.steps + done),
            np.int32(min(STEPS_PER_LAUNCH, n - done)),
            np.uint32(count),
            *step_numbers(device),
            chains.buffer,
            counters.buffer,
            film.buffer,
            np.int32(film.pixels),
            evenness=state.evenness.buffer,
        )
        part = _read(counters)
        info = part if info is None else info + part
        counters.clear()
    assert info is not None
    return _advanced(state, chains, n, info), info


def _read(counters: Records) -> Info:
    raw = counters.read()
    return Info(
        raw["proposed"].astype(np.int64),
        raw["acceptance"].astype(np.float64),
        raw["weight_sum"].astype(np.float64),
        raw["weight_square_sum"].astype(np.float64),
        raw["trace"].copy(),  # a view would keep all of the counters
        int(raw["not_finite"].sum(dtype=np.int64)),
        int(raw["rays"].sum(dtype=np.int64)),
    )


def _advanced(state: State, chains: Records, n: int, info: Info) -> State:
    def by_group(values: np.ndarray) -> np.ndarray:
        return np.array([values[g.first : g.first + g.chains].sum(axis=0) for g in state.groups]).reshape(
            len(state.groups), *values.shape[1:]
        )

    sums = Sums(
        state.sums.weighed + by_group(info.proposed[:, 0]),
        state.sums.weight + by_group(info.weight),
        state.sums.weight_square + by_group(info.weight_square),
    )
    return state._replace(
        chains=chains,
        proposed=state.proposed + by_group(info.proposed),
        acceptance=state.acceptance + by_group(info.acceptance),
        sums=sums,
        steps=state.steps + n,
        not_finite=state.not_finite + info.not_finite,
        rays=state.rays + info.rays,
    )
