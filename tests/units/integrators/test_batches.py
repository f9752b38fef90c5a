"""The variance of a run's picture by batches of launches."""

import numpy as np
import pytest

from pylmc.integrators.batches import BATCHES, Batches


def run(batches: Batches, values: np.ndarray) -> int:
    """Advance by launches of these values (launches, pixels); how often the picture was read."""
    read = 0
    total = np.zeros(values.shape[1])
    for launch, value in enumerate(values, 1):
        total += value

        def luminance(mean: np.ndarray = total / launch) -> np.ndarray:
            nonlocal read
            read += 1
            return mean

        batches.advance(luminance)
    return read


@pytest.mark.parametrize("launches", [6, 16, 17, 20, 40, 1000])
def test_variance_of_independent_launches(launches: int) -> None:
    values = np.random.default_rng(2).normal(3, 2, (launches, 5000))
    batches = Batches(1)
    run(batches, values)
    found = batches.variance()
    assert found is not None and found.mean() == pytest.approx(4 / launches, rel=0.1)


def test_correlated_launches_are_seen_by_long_batches() -> None:
    steps = np.random.default_rng(3).normal(size=(640, 4000))
    values = np.zeros_like(steps)
    for i in range(1, len(steps)):
        values[i] = 0.8 * values[i - 1] + steps[i]
    batches = Batches(1)
    run(batches, values)
    found = batches.variance()
    assert found is not None and found.mean() == pytest.approx(values.mean(0).var(), rel=0.2)


def test_the_picture_is_read_seldom() -> None:
    batches = Batches(3)
    assert run(batches, np.ones((3 * BATCHES * 64, 1))) == BATCHES + 6 * BATCHES // 2


def test_one_batch_tells_nothing() -> None:
    batches = Batches(4)
    run(batches, np.ones((7, 1)))
    assert batches.variance() is None
