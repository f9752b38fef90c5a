"""The standard error of a picture's mean luminance, as chains have it: start, normalisation and steps together.

A group's part of the mean is b times the mean luminance that its chains splat a step. Both are means over independent
candidates of the start, and over what the chains that began from each did later: chains of one candidate are alike, and a
candidate's weight is part of b as well. So the error is told by the spread over candidates of what each did to the product,
to first order, with all that its chains did (a variance that is robust to clusters; Liang & Zeger 1986).
"""

from __future__ import annotations

import numpy as np

from .chains import State
from .groups import Group


def mean_variance(state: State) -> float | None:
    """The variance of the picture's mean luminance in scaled units, or None before the first step."""
    if state.steps == 0:
        return None
    known = sum(_of_chains(state, group) for group in state.groups)
    share = state.chains.device.settings.large_steps
    return known + sum(_of_streams(state, group, share) for group in state.dark)


def _of_chains(state: State, group: Group) -> float:
    part = slice(group.first, group.first + group.chains)
    counted = state.counted
    drawn = group.weighed + int(counted.proposed[part, 0].sum())
    b = (group.weight_sum + counted.weight[part].sum()) / drawn
    splatted = counted.splatted[part] / state.steps
    mean = splatted.mean()
    # of chains: what they splat, and the weights of their large steps
    by_chains = b * (splatted - mean) / group.chains
    large = mean * (counted.weight[part] - b * counted.proposed[part, 0]) / drawn
    origins = state.origins[part]
    begun = np.unique(origins).size
    if begun > 1:  # their mean is their own
        by_chains *= np.sqrt(begun / (begun - 1))
    of_candidates = mean * (np.exp(group.log_weights) - b) / drawn
    together = np.bincount(origins, by_chains + large, minlength=of_candidates.size)
    together[: of_candidates.size] += of_candidates
    return float((together**2).sum())


def _of_streams(state: State, group: Group, large_steps: float) -> float:
    share = large_steps * state.steps * group.chains
    splatted = state.counted.splatted[group.first : group.first + group.chains]
    return (share / (group.weighed + share) * group.unit / state.steps) ** 2 * variance_of_mean(splatted)


def variance_of_mean(values: np.ndarray) -> float:
    """That of independent values' mean."""
    return float(values.var(ddof=1) / len(values))
