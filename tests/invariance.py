"""Start exact, run, compare (theory.md, 8): the test that sees sign, Jacobian and determinant errors.

Chains that start in the target must still be distributed as the target after any number of steps. Two independent sets are
drawn from the target; one is moved; both are described by the same numbers, which are compared one by one.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import stats

from pylmc.sampler import Sampler
from pylmc.scene import Scene
from pylmc.states import States

CELLS = 6  # film cells per side


def features(states: States, scene: Scene) -> dict[str, np.ndarray]:
    """Numbers that describe each path: where it is on the film, its nodes, its last direction, its density."""
    right, up, forward = scene.camera.axes()
    depth = states.v_1 @ forward
    rows = np.arange(len(states.length))
    last = states.length - 1
    result = {"film x": states.v_1 @ right / depth, "film y": states.v_1 @ up / depth, "log pi": states.log_pi}
    for i in range(int(states.length.min()) - 1):
        for axis in range(3):
            result[f"node {i + 1} {'xyz'[axis]}"] = states.nodes[:, i, axis]
    for axis in range(3):
        result[f"last direction {'xyz'[axis]}"] = states.directions[rows, last, axis]
    omega = states.deviations[rows, last - 1]
    result["last deviation"] = np.hypot(omega[:, 0], omega[:, 1])
    return result


def p_values(before: States, after: States, scene: Scene) -> dict[str, float]:
    """Two-sample p-values: Kolmogorov and Smirnov's for each number that varies, χ² for the film's cells."""
    a, b = features(before, scene), features(after, scene)
    rng = np.random.default_rng(5)
    values = {}
    for name in a:
        both = np.concatenate([a[name], b[name]]).astype(np.float64)
        if np.ptp(both) < 1e-6 * np.abs(both).max() + 1e-12:
            continue
        # flat walls give coordinates that are equal up to rounding: a jitter keeps ties from looking like a difference
        noise = 1e-6 * np.ptp(both)
        jittered = [x[name] + noise * rng.random(len(x[name])) for x in (a, b)]
        values[name] = float(stats.ks_2samp(*jittered).pvalue)
    edges = [np.quantile(np.concatenate([a[k], b[k]]), np.linspace(0, 1, CELLS + 1)) for k in ("film x", "film y")]
    table = np.stack([np.histogram2d(f["film x"], f["film y"], bins=edges)[0].ravel() for f in (a, b)])
    values["film cells"] = float(stats.chi2_contingency(table[:, table.sum(axis=0) > 10]).pvalue)
    return values


def moved_and_fresh(
    scene: Scene, steps: int, chains: int = 8192, candidates: int = 1 << 18, **settings: Any
) -> tuple[Sampler, States, States]:
    """Two exact samples of the target from different seeds; the second has then been moved ``steps`` steps."""
    sampler = Sampler(scene, **settings)
    sampler.init(seed=101, chains=chains, candidates=candidates)
    fresh = sampler.states()
    sampler.init(seed=202, chains=chains, candidates=candidates)
    sampler.step(steps)
    return sampler, fresh, sampler.states()


def select(states: States, keep: np.ndarray) -> States:
    """The states of some chains only."""
    return States(*(array[keep] for array in states))


def smallest_by_group(sampler: Sampler, fresh: States, moved: States) -> tuple[float, str, int]:
    """(smallest p-value, what it belongs to, number of tests) over all path groups with chains enough to compare."""
    smallest, where, tests = 1.0, "nothing", 0
    for length, ending in {(g.length, g.ending) for g in sampler.groups}:
        a, b = ((s.length == length) & (s.ending == ending) for s in (fresh, moved))
        if min(a.sum(), b.sum()) < 500:
            continue
        for name, p in p_values(select(fresh, a), select(moved, b), sampler.scene).items():
            tests += 1
            if p < smallest:
                smallest, where = p, f"{name}, {length} segments, {('connect', 'hit')[ending]}"
    return smallest, where, tests
