"""What the benches share: one run of an integrator, looked at on the way, and references made of long runs."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pylmc.colour import LUMINANCE
from pylmc.integrators import made
from pylmc.picture.metrics import trimmed
from pylmc.picture.statistics import relative_square
from pylmc.sampling.chains import STEPS_PER_LAUNCH
from pylmc.sampling.sampler import Sampler
from pylmc.scene import Scene

CANDIDATES = 1 << 15  # of the start, per path length and ending: little, so that the run itself decides
CHAINS = 4096


@dataclass
class Trace:
    """A run's pictures on the way: seconds and mutations (samples) so far, the luminance (height, width) at each stop."""

    seconds: list[float] = field(default_factory=list)
    work: list[int] = field(default_factory=list)
    pictures: list[np.ndarray] = field(default_factory=list)
    diagnostics: dict[str, Any] = field(default_factory=dict)

    @property
    def rate(self) -> float:
        """Mutations (samples) per second of run time."""
        return self.work[-1] / self.seconds[-1]


def prepared(sampler: Sampler, integrator: str, seed: int) -> Any:
    """An integrator that is compiled, started, and ready to advance."""
    worker: Any = made(integrator, sampler)
    start = {"candidates": CANDIDATES} if integrator == "lmc" else {}
    worker.prepare(seed, quick=True, **start)
    return worker


def run(sampler: Sampler, seconds: float, seed: int, integrator: str = "lmc", stops: Sequence[float] = (1.0,)) -> Trace:
    """Run for ``seconds`` and look at the picture at the given parts of it. The set-up does not count."""
    worker = prepared(sampler, integrator, seed)
    trace, pending = Trace(), list(stops)
    spent = 0.0
    while pending:
        before = time.perf_counter()
        worker.advance()
        spent += time.perf_counter() - before
        while pending and spent >= seconds * pending[0]:
            pending.pop(0)
            trace.seconds.append(spent)
            trace.work.append(worker.done)
            trace.pictures.append(worker.image() @ LUMINANCE)
    trace.diagnostics = worker.diagnostics()
    return trace


def rate_ratios(runs: Sequence[tuple[Sampler, str]], rounds: int, seconds: float) -> list[float]:
    """Each run's mutations (samples) per second over the first one's: medians over ``rounds``.

    The first takes its turn right beside each of the others, so that whatever else the machine does slows both alike.
    """
    first, *others = [prepared(sampler, integrator, 0) for sampler, integrator in runs]

    def rate(worker: Any) -> float:
        done, start = worker.done, time.perf_counter()
        while (spent := time.perf_counter() - start) < seconds or worker.done == done:
            worker.advance()
        return float((worker.done - done) / spent)

    found = np.array([[rate(worker) / rate(first) for worker in others] for _ in range(rounds)])
    return [1.0, *np.median(found, axis=0).tolist()]


@dataclass(frozen=True)
class Reference:
    """Luminance by greatest path length: ``mean[k]`` and ``variance[k]`` (of the mean), (height, width), for lengths to k."""

    mean: dict[int, np.ndarray]
    variance: dict[int, np.ndarray]


def reference(scene: Scene, depths: Sequence[int], seconds: float, runs: int = 6, device: Any = None) -> Reference:
    """A long double-precision reference: ``runs`` independent runs with all paths, summed up to each of ``depths``."""
    sampler = Sampler(scene, device=device, precision="double", max_depth=max(depths))
    pictures: dict[int, list[np.ndarray]] = {depth: [] for depth in depths}
    for index in range(runs):
        sampler.init(seed=900_000 + index, chains=CHAINS, candidates=4 * CANDIDATES)
        start = time.perf_counter()
        while time.perf_counter() - start < seconds / runs:
            sampler.step(STEPS_PER_LAUNCH)
            sampler.counters()
        parts = [estimator.read() @ LUMINANCE for estimator in sampler.estimators()]
        groups = (*sampler.groups, *sampler.dark_groups)
        for depth in depths:
            shorter = [part for part, group in zip(parts, groups, strict=True) if group.length <= depth]
            pictures[depth].append(np.sum(shorter, axis=0))
    return Reference(
        {k: np.mean(p, axis=0) for k, p in pictures.items()}, {k: np.var(p, axis=0, ddof=1) / runs for k, p in pictures.items()}
    )


def relative_mse(picture: np.ndarray, mean: np.ndarray, variance: np.ndarray) -> float:
    """relMSE of a luminance picture without the worst 0.1 % of its pixels, less what the reference's own noise adds."""
    error, noise = (trimmed(relative_square(square, mean)) for square in ((picture - mean) ** 2, variance))
    return float(error.mean() - noise.mean())


def cell_bias(pictures: Sequence[np.ndarray], mean: np.ndarray, variance: np.ndarray, cells: int = 16) -> tuple[float, float]:
    """(bias, its noise): root mean square over cells × cells of the film of the relative deviation of the pictures' mean.

    What the pictures' own spread (one picture an independent seed) and the reference's explain is taken off; the noise is
    about what would be found where there is no bias.
    """
    blocks = [_cells(picture, cells) for picture in pictures]
    truth = _cells(mean, cells)
    spread = np.var(blocks, axis=0, ddof=1) / len(blocks) + _cells(variance, cells) / (mean.size / cells**2)
    excess = relative_square((np.mean(blocks, axis=0) - truth) ** 2 - spread, truth)
    noise = np.sqrt(2 / excess.size) * float(relative_square(spread, truth).mean())
    return float(np.sqrt(max(excess.mean(), 0.0))), float(np.sqrt(noise))


def _cells(picture: np.ndarray, cells: int) -> np.ndarray:
    height, width = picture.shape
    return picture.reshape(cells, height // cells, cells, width // cells).mean(axis=(1, 3))
