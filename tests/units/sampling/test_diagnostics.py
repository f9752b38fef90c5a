"""Effective sample size and R-hat."""

import numpy as np

from pylmc.sampling.diagnostics import TRACED_CHAINS, mixing

RNG = np.random.default_rng(3)


def test_independent_draws_count_as_many_as_they_are():
    size, rhat = mixing(RNG.random((2 * TRACED_CHAINS, 100, 2)))
    assert 0.8 < size / (2 * TRACED_CHAINS * 100) < 1.2  # of all chains, though only some are looked at
    assert abs(rhat - 1) < 0.01


def test_chains_that_stay_apart_are_seen():
    traces = 0.01 * RNG.random((8, 50, 2)) + np.arange(8)[:, None, None]
    size, rhat = mixing(traces)
    assert size < 20 and rhat > 2


def test_little_or_still_traces_tell_nothing():
    assert mixing(RNG.random((8, 3, 2))) is None
    assert mixing(RNG.random((1, 50, 2))) is None
    assert mixing(np.ones((8, 50, 2))) is None
