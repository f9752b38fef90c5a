"""The error of a picture's mean luminance that a run tells is the spread of runs."""

import numpy as np
import pytest
from scipy import stats

import pylmc
from pylmc import Sampler
from pylmc.colour import LUMINANCE
from pylmc.integrators import made

ALPHA = 1e-4
RUNS = 40
SCENES = {"box": {}, "keyhole": {"hole": 0.05, "alpha": 0.05}}
RUN = {  # integrator, settings, launches
    "chains": ("lmc", {}, 1),
    "long chains": ("lmc", {}, 12),
    "chains in luminance": ("lmc", {"even": False}, 4),
    "chains of few candidates": ("lmc", {"candidates": 128}, 4),
    "bdpt": ("bdpt", {}, 1),
    "path": ("path", {}, 4),
}


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("name", RUN)
def test_told_error_is_the_spread_of_runs(name: str, scene: str) -> None:
    integrator, settings, launches = RUN[name]
    settings = {"chains": 256, "candidates": 1 << 12, **settings}
    sampler = Sampler(pylmc.load(scene, width=16, height=16, **SCENES[scene]), max_depth=4, **settings)
    means, told = np.zeros(RUNS), np.zeros(RUNS)
    for seed in range(RUNS):
        worker = made(integrator, sampler)
        worker.prepare(seed, quick=True)
        for _ in range(launches):
            worker.advance()
        means[seed], told[seed] = (worker.image() @ LUMINANCE).mean(), worker.mean_error()
    ratio = means.var(ddof=1) / (told**2).mean()
    low, high = stats.chi2.ppf([ALPHA / 2, 1 - ALPHA / 2], RUNS - 1) / (RUNS - 1)
    print(f"{scene}, {name}: spread {means.std(ddof=1) / means.mean():.4f}, told {told.mean() / means.mean():.4f}")
    assert low < ratio < high
    if (name, scene) == ("chains", "box"):  # the normalisation's error alone would not do
        assert worker.diagnostics()["b_error"] / worker.diagnostics()["b"] < 0.1 * means.std(ddof=1) / means.mean()
