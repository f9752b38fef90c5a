"""The trace behind ESS and R-hat: bounded, and as good as all of it."""

import numpy as np
import pytest

from pylmc.sampling import traces
from pylmc.sampling.diagnostics import mixing
from pylmc.sampling.traces import Trace


def autoregressive(chains: int, draws: int, correlation: float) -> np.ndarray:
    """Positions (draws, chains, 2) whose effective number is draws times chains times (1 - c) / (1 + c)."""
    rng = np.random.default_rng(4)
    x = rng.normal(size=(draws, chains, 2))
    x[1:] *= np.sqrt(1 - correlation**2)
    for i in range(1, draws):
        x[i] += correlation * x[i - 1]
    return x


def test_a_short_trace_is_all_of_it() -> None:
    positions = autoregressive(8, 100, 0.5).astype(np.float32)
    trace = Trace(8)
    for now in positions:
        trace.add(now)
    assert trace.mixing() == mixing(positions.transpose(1, 0, 2))


@pytest.mark.parametrize("correlation", [0.0, 0.9])
def test_a_long_trace_takes_no_more_memory_and_tells_the_same(correlation: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(traces, "LONGEST", 64)
    positions = autoregressive(16, 2000, correlation)
    trace = Trace(16)
    for now in positions:
        trace.add(now)
        assert len(trace._draws) < 64
    found = trace.mixing()
    assert found is not None
    effective = positions[..., 0].size * (1 - correlation) / (1 + correlation)
    assert found[0] == pytest.approx(effective, rel=0.25)
    assert found[1] == pytest.approx(1, abs=0.03)


def test_positions_are_copied_and_chains_beyond_the_traced_ones_count() -> None:
    trace, positions = Trace(1000), np.zeros((1000, 2))
    rng = np.random.default_rng(1)
    for _ in range(100):
        positions[:] = rng.random((1000, 2))
        trace.add(positions)
    found = trace.mixing()
    assert found is not None and found[0] == pytest.approx(100_000, rel=0.3)
