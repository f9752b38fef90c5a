"""Films in bounded memory: the longest paths share one, and the picture is the same."""

import numpy as np
import pytest

import pylmc
from pylmc import Sampler
from pylmc.colour import LUMINANCE
from pylmc.integrators import made
from pylmc.picture.estimators import picture
from pylmc.sampling import films
from pylmc.sampling.films import film_for, places

SIDE, DEPTH = 12, 5


def sampler(**settings: object) -> Sampler:
    chosen = {"max_depth": DEPTH, "chains": 512, "candidates": 1 << 12, **settings}
    return Sampler(pylmc.load("box", width=SIDE, height=SIDE), **chosen)


def bounded(monkeypatch: pytest.MonkeyPatch, slots: int) -> None:
    monkeypatch.setattr(films, "FILM_BYTES", slots * SIDE * SIDE * 24)


def test_memory_has_a_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    device = sampler().device_scene
    assert film_for(device, 5, SIDE, SIDE).slots == 5
    bounded(monkeypatch, 3)
    assert film_for(device, 5, SIDE, SIDE).slots == 3 and film_for(device, 2, SIDE, SIDE).slots == 2
    bounded(monkeypatch, 0)
    assert film_for(device, 5, SIDE, SIDE).slots == 1


def test_the_longest_paths_share() -> None:
    own = sampler()
    groups = own.init(seed=1)
    shared = places(groups, 3)
    assert [shared.slot[i] for i in range(DEPTH)] == [0, 1, 2, 2, 2]
    assert shared.shared.tolist() == [False, False, True, True, True]
    assert shared.chains == sum(group.chains for group in groups[2:])


@pytest.mark.parametrize("large_steps", [0.0, 0.3])
@pytest.mark.parametrize("slots", [1, 3])
def test_the_picture_is_the_same(slots: int, large_steps: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Up to rounding where the normalisation is the start's, and to its refinement where large steps refine it."""
    pictures, chains = [], []
    for share in (False, True):
        if share:
            bounded(monkeypatch, slots)
        each = sampler(large_steps=large_steps)
        each.init(seed=2)
        for n in (40, 56, 32):
            each.step(n)
        assert len(each.estimators()) == (slots if share else DEPTH)
        pictures.append(each.image() @ LUMINANCE)
        chains.append(each.state.arrays().v)
    np.testing.assert_array_equal(*chains)
    np.testing.assert_allclose(*pictures, rtol=1e-4 if large_steps == 0 else 0.05)


def test_dark_groups_share_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """On average over starts a shared film has the light that films of their own have."""
    sums = np.zeros((2, 100))
    for share in (0, 1):
        if share:
            bounded(monkeypatch, 1)
        each = Sampler(pylmc.load("glints", width=SIDE, height=SIDE), max_depth=4, even=False, chains=32, candidates=6)
        for seed in range(100):
            each.init(seed)
            each.step(96)
            sums[share, seed] = (each.image() @ LUMINANCE).mean()
    assert abs(sums[1].mean() / sums[0].mean() - 1) < 0.1


def test_independent_samples_share_exactly(monkeypatch: pytest.MonkeyPatch) -> None:
    pictures = []
    for slots in (DEPTH, 2):
        bounded(monkeypatch, slots)
        worker = made("bdpt", sampler())
        worker.prepare(3, quick=True)
        worker.advance()
        assert len(worker.estimators()) == slots
        pictures.append(picture(worker.estimators()))
    np.testing.assert_allclose(*pictures, rtol=1e-4)
