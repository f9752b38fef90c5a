"""Start exact, run, compare (theory.md, 8): the test that sees sign, Jacobian and determinant errors.

Chains that start in the target must still be distributed as the target after any number of steps. Two independent sets are
drawn from the target; one is moved; both are described by the same numbers, which are compared one by one: each coordinate
by Kolmogorov and Smirnov's test and by χ² over bins, each pixel of the film by itself, and all pixels by χ².

Drawing the sets is most of the work and does not depend on how chains move, so a :class:`Start` serves many ways of moving.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import stats

from pylmc.device.tables import ENDINGS
from pylmc.sampling.chains import resume
from pylmc.sampling.sampler import Sampler
from pylmc.sampling.start import start as start_chains
from pylmc.sampling.states import ChainArrays, States
from pylmc.scene import Scene
from studies.faults import FAULTS
from studies.probes import edited_source

BINS = 16  # of a coordinate, with equal counts
FEWEST = 400  # chains: groups with less are left out
INDEPENDENT = 4  # a group takes part with at most this part of its candidates' effective number


class Start:
    """Two independent exact samples of one target, the second ready to be moved.

    ``weights`` (GRID, GRID) multiply luminance over the film; None: those of pylmc.sampling.evenness.
    """

    def __init__(
        self,
        scene: Scene,
        weights: np.ndarray | None = None,
        *,
        precision: str = "single",
        max_depth: int = 3,
        chains: int = 8192,
        candidates: int = 1 << 19,
        seed: int = 101,
    ) -> None:
        self.scene, self.precision, self.max_depth = scene, precision, max_depth
        self.sampler = Sampler(scene, precision=precision, max_depth=max_depth)
        samples = []
        for draw in range(2):
            self.sampler.resume(start_chains(self.sampler.device_scene, seed + draw, chains, candidates, weights))
            effective = {(g.length, g.ending): g.weight_sum**2 / g.weight_square_sum for g in self.sampler.groups}
            samples.append((self.sampler.states(), effective))
        self.chains, self.weights = self.sampler.state.arrays(), self.sampler.evenness  # of the second
        (self.fresh, effective_fresh), (self.unmoved, effective) = samples
        self.take: dict[tuple[int, int], int] = {}  # chains of each (length, ending) that take part in comparisons
        for kind in effective.keys() & effective_fresh.keys():
            length, ending = kind
            counts = [int(((s.length == length) & (s.ending == ending)).sum()) for s in (self.fresh, self.unmoved)]
            self.take[kind] = min(*counts, int(min(effective[kind], effective_fresh[kind]) / INDEPENDENT))

    def described(self, chains: ChainArrays) -> States:
        """Chains laid open."""
        self.sampler.resume(resume(self.sampler.device_scene, chains, self.sampler.groups, self.weights))
        return self.sampler.states()


class Resumed(Sampler):
    """Chains of a Start, to be moved in a way of one's own. ``fault``: one of studies.faults, or "" for a sound step."""

    def __init__(self, start: Start, seed: int = 0, fault: str = "", chains: ChainArrays | None = None, **settings: Any):
        super().__init__(start.scene, precision=start.precision, max_depth=start.max_depth, **settings)
        groups = [copy(group) for group in start.sampler.groups]
        self.resume(resume(self.device_scene, start.chains if chains is None else chains, groups, start.weights, seed))
        if fault:
            with edited_source(FAULTS[fault]):
                self.step(0)  # builds the kernel, for all later steps


@dataclass(frozen=True)
class Outcome:
    """What a comparison found: (name, p-value) of every test, and how many steps of which kind were accepted.

    acceptance: of all steps; not_finite: steps whose ratio was NaN.
    """

    p_values: dict[str, float]
    acceptance: float = 0.0
    not_finite: int = 0

    @property
    def tests(self) -> int:
        return len(self.p_values)

    @property
    def worst(self) -> str:
        return min(self.p_values, key=self.p_values.__getitem__)

    @property
    def smallest(self) -> float:
        return self.p_values[self.worst]

    @property
    def corrected(self) -> float:
        """The smallest p-value after Šidák's correction: below alpha with probability alpha, or less for dependent tests."""
        return float(-np.expm1(self.tests * np.log1p(-min(self.smallest, 1 - 1e-16))))

    def threshold(self, alpha: float) -> float:
        """What the smallest p-value must exceed at level ``alpha``."""
        return float(-np.expm1(np.log1p(-alpha) / self.tests))


def features(states: States, scene: Scene) -> dict[str, np.ndarray]:
    """The coordinates of paths of one length: film, nodes, directions, deviations; and their log density. (n,) each."""
    right, up, forward = scene.camera.axes()
    depth = states.v_1 @ forward
    result = {"film x": states.v_1 @ right / depth, "film y": states.v_1 @ up / depth, "log pi": states.log_pi}
    for i in range(int(states.length[0])):
        for axis in range(3):
            result[f"node {i + 1} {'xyz'[axis]}"] = states.nodes[:, i, axis]
            result[f"direction {i + 1} {'xyz'[axis]}"] = states.directions[:, i, axis]
    for i in range(int(states.length[0]) - 1):
        omega = np.nan_to_num(states.deviations[:, i], nan=9.0)
        result |= {f"deviation {i + 1} p": omega[:, 0], f"deviation {i + 1} q": omega[:, 1]}
        result[f"deviation {i + 1} length"] = np.hypot(*omega.T)
    return result


def two_tables(a: np.ndarray, b: np.ndarray) -> float:
    """χ²'s p-value for two rows of counts to come from one distribution; cells with ten or less are left out."""
    table = np.stack([a, b])[:, a + b > 10]
    return float(stats.chi2_contingency(table).pvalue) if table.shape[1] > 1 else 1.0


def pixels(states: States, scene: Scene) -> np.ndarray:
    """The pixel of each path, as one number."""
    camera = scene.camera
    right, up, forward = camera.axes()
    depth = states.v_1 @ forward
    slope = np.tan(np.radians(camera.fov) / 2)
    across = np.stack([states.v_1 @ right * camera.height / camera.width, -states.v_1 @ up]) / (slope * depth)
    size = np.array([[camera.width], [camera.height]])
    column, row = np.clip(((across + 1) / 2 * size).astype(int), 0, size - 1)
    return row * camera.width + column


def group_p_values(a: States, b: States, scene: Scene) -> dict[str, float]:
    """Two-sample p-values for the paths of one length and ending."""
    described, values = (features(a, scene), features(b, scene)), {}
    rng = np.random.default_rng(5)
    for name in described[0]:
        one, other = (d[name].astype(np.float64) for d in described)
        both = np.concatenate([one, other])
        span = np.ptp(both)
        if span < 1e-6 * np.abs(both).max() + 1e-12:
            continue
        # flat walls give coordinates that are equal up to rounding: a jitter keeps ties from looking like a difference
        one, other = (x + 1e-6 * span * rng.random(len(x)) for x in (one, other))
        edges = np.quantile(np.concatenate([one, other]), np.linspace(0, 1, BINS + 1))
        values[f"{name}, KS"] = float(stats.ks_2samp(one, other, method="asymp").pvalue)
        values[f"{name}, χ²"] = two_tables(*(np.histogram(x, edges)[0] for x in (one, other)))
    count = scene.camera.width * scene.camera.height
    values["pixels, χ²"] = two_tables(*(np.bincount(pixels(s, scene), minlength=count) for s in (a, b)))
    signatures = np.unique(np.concatenate([a.lobes, b.lobes]), axis=0, return_inverse=True)[1].ravel()
    parts = np.split(signatures, [len(a.lobes)])
    values["lobes, χ²"] = two_tables(*(np.bincount(x, minlength=signatures.max() + 1) for x in parts))
    return values


def select(states: States, keep: np.ndarray) -> States:
    """The states of some chains only."""
    return States(*(array[keep] for array in states))


def compare(a: States, b: States, take: dict[tuple[int, int], int], scene: Scene) -> dict[str, float]:
    """p-values of all tests: coordinates and film of each (length, ending), of which ``take`` chains count; each pixel."""
    rng = np.random.default_rng(6)
    values, kept, width = {}, [], scene.camera.width
    for (length, ending), count in sorted(take.items()):
        members = [np.flatnonzero((s.length == length) & (s.ending == ending)) for s in (a, b)]
        count = min(count, *map(len, members))
        if count < FEWEST:
            continue
        parts = [select(s, rng.permutation(m)[:count]) for s, m in zip((a, b), members, strict=True)]
        found = group_p_values(*parts, scene)
        values |= {f"{length} {ENDINGS[ending]}: {name}": p for name, p in found.items()}
        kept.append([np.bincount(pixels(s, scene), minlength=width * scene.camera.height) for s in parts])
    # groups have as many chains in the one set as in the other, so that a pixel's count in either has the same mean
    for pixel, (one, other) in enumerate(np.sum(kept, axis=0).T):
        if one + other > 10:
            values[f"pixel {pixel % width}, {pixel // width}"] = float(stats.binomtest(one, one + other).pvalue)
    return values


def move(start: Start, steps: int, seed: int = 0, fault: str = "", **settings: Any) -> Outcome:
    """Move the second sample and compare it with the first."""
    sampler = Resumed(start, seed, fault, **settings)
    sampler.step(steps)
    counters = sampler.counters()
    acceptance = float(counters.acceptance.sum() / counters.proposed.sum())
    values = compare(start.fresh, start.described(sampler.state.arrays()), start.take, start.scene)
    return Outcome(values, acceptance, counters.not_finite)
