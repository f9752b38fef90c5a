"""How well chains mix: effective sample size and R-hat."""

from __future__ import annotations

import numpy as np

TRACED_CHAINS = 64  # per group: enough for R-hat, and arviz's cost grows with their number


def mixing(traces: np.ndarray) -> tuple[float, float] | None:
    """(effective sample size, R-hat) of film positions (chains, draws, 2): the worse coordinate.

    The size counts draws of all chains. None where there are fewer than four draws, or nothing moved.
    """
    from arviz_stats.base import array_stats  # slow to import, wanted once at a render's end

    chains, draws = traces.shape[:2]
    if draws < 4 or chains < 2:
        return None
    sample = traces[:TRACED_CHAINS].astype(np.float64)
    if np.any(sample.std(axis=(0, 1)) == 0):
        return None
    sizes = [float(array_stats.ess(sample[:, :, i], chain_axis=0, draw_axis=1)) for i in range(2)]
    rhats = [float(array_stats.rhat(sample[:, :, i], chain_axis=0, draw_axis=1)) for i in range(2)]
    return min(sizes) * chains / len(sample), max(rhats)
