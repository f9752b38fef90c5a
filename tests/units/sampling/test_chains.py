"""Chains as values: a State goes in, another comes out, and films lie apart from both."""

import numpy as np
import pytest

import pylmc
from pylmc import PylmcError, Sampler
from pylmc.device.arrays import Film
from pylmc.sampling.chains import State, resume, step
from pylmc.sampling.evenness import GRID
from pylmc.sampling.start import start


@pytest.fixture(scope="module")
def sampler() -> Sampler:
    return Sampler(pylmc.load("box", width=12, height=8), max_depth=3)


def begin(sampler: Sampler) -> tuple[State, Film]:
    state = start(sampler.device_scene, seed=3, chains=64, candidates=1 << 12)
    return state, Film(sampler.device_scene, len(state.groups), 8, 12)


def test_step_returns_the_next_state_and_consumes_the_last(sampler: Sampler) -> None:
    first, film = begin(sampler)
    before = first.arrays()
    second, info = step(first, 20, film)
    assert second.steps == 20 and second.seed == first.seed == 3
    assert info.proposed.sum() == 20 * second.chains.count
    np.testing.assert_array_equal(second.counted.proposed, info.proposed)
    assert (second.by_group(info.weight) > 0).all() and (info.rays > 0).all()
    after = second.arrays()
    np.testing.assert_array_equal(after.length, before.length)
    assert np.mean(np.any(after.v[:, 0] != before.v[:, 0], axis=1)) > 0.5
    for use in (first.arrays, lambda: step(first, 1, film)):
        with pytest.raises(PylmcError, match="consumed"):
            use()


def test_films_are_whose_they_are_given_by(sampler: Sampler) -> None:
    """One run splats into two films in turn; their sum is the film of the same run with one."""
    state, whole = begin(sampler)
    state, _ = step(state, 32, whole)
    step(state, 32, whole)
    state, early = begin(sampler)
    state, _ = step(state, 32, early)
    late = Film(sampler.device_scene, len(state.groups), 8, 12)
    step(state, 32, late)
    for slot in range(whole.slots):
        np.testing.assert_array_equal(early.words(slot) + late.words(slot), whole.words(slot))


def test_chains_go_to_the_host_and_back(sampler: Sampler) -> None:
    state, film = begin(sampler)
    arrays = state.arrays()
    again = resume(sampler.device_scene, arrays, state.groups, state.evenness.read(), seed=3)
    for ours, theirs in zip(arrays, again.arrays(), strict=True):
        np.testing.assert_array_equal(ours, theirs)
    twin = Film(sampler.device_scene, len(state.groups), 8, 12)
    moved, _ = step(state, 8, film)
    moved_again, _ = step(again, 8, twin)
    for ours, theirs in zip(moved.arrays(), moved_again.arrays(), strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_weighing_leaves_running_chains_as_they_are(sampler: Sampler) -> None:
    pictures = []
    for weigh in (False, True):
        sampler.init(seed=5, chains=64, candidates=1 << 12)
        sampler.step(32)
        if weigh:
            sampler.weigh(1 << 10, seed=9)
        sampler.step(32)
        sampler.counters()
        pictures.append(sampler.image())
    np.testing.assert_array_equal(*pictures)


def test_how_steps_are_asked_for_changes_nothing(sampler: Sampler) -> None:
    """Neither does who looks at the picture meanwhile: launches' sums end at whole multiples of their steps."""
    found = []
    for split in ((96,), (5, 27, 0, 1, 40, 23), (48, 48), (95, 1)):
        sampler.init(seed=4, chains=128, candidates=1 << 12)
        for n in split:
            sampler.step(n)
            if n != 96:
                sampler.image(), sampler.counters(), sampler.states()
        found.append((sampler.image(), *sampler.state.arrays(), *sampler.state.counted))
    for other in found[1:]:
        for ours, theirs in zip(found[0], other, strict=True):
            np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize("scale", [1e-25, 1e25])
def test_weights_may_be_of_any_size(sampler: Sampler, scale: float) -> None:
    """Their squares are beyond float32 on either side."""
    relative = []
    for factor in (1.0, scale):
        weights = np.full((GRID, GRID), factor, np.float32)
        sampler.resume(start(sampler.device_scene, seed=3, chains=64, candidates=1 << 12, evenness=weights))
        sampler.step(64)
        relative.append([group.b_error / group.b for group in sampler.groups])
        assert (sampler.state.counted.weight_square > 0).any()
    np.testing.assert_allclose(relative[1], relative[0], rtol=1e-3)
