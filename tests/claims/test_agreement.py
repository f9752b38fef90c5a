"""lmc draws the same picture as its independent sampler alone, per pixel and path length (and bdpt the same as path: see
kernels/test_independent.py). Small steps do most of the work here, so a wrong proposal density would show."""

from __future__ import annotations

import numpy as np
import pytest
from studies.agreement import ALPHA, bdpt_batches, same_means, scene_of, sidak

from pylmc.colour import LUMINANCE
from pylmc.device.tables import ENDINGS
from pylmc.sampling.sampler import Sampler

SCENES = ("box", "keyhole", "caustic", "glints")


def lmc_runs(name: str, runs: int, depth: int) -> dict[tuple[int, int], np.ndarray]:
    """Luminance films (runs, height, width) of each (length, ending), a run a seed."""
    out: dict[tuple[int, int], list[np.ndarray]] = {}
    sampler = Sampler(scene_of(name), max_depth=depth, large_steps=0.1)
    for seed in range(runs):
        sampler.init(seed=500 + seed, chains=2048, candidates=1 << 15)
        sampler.step(192)
        sampler.counters()
        for slot, group in enumerate(sampler.groups):
            share = group.b * sampler.film_pixels / (group.steps * group.chains)
            out.setdefault((group.length, group.ending), []).append(sampler.film.read(slot) @ LUMINANCE * share)
    return {key: np.stack(films) for key, films in out.items()}


@pytest.mark.parametrize("name", SCENES)
def test_lmc_and_bdpt_agree(name: str) -> None:
    depth = 4
    chains, independent = lmc_runs(name, 12, depth), bdpt_batches(name, seeds=2, launches=8, depth=depth)
    assert set(chains) <= set(independent)
    tests = sum(film[0].size for film in chains.values())
    for key, film in chains.items():
        pixels = same_means(film, independent[key])
        label = f"{key[0]} {ENDINGS[key[1]]}"
        assert pixels.min() > sidak(ALPHA, tests), (label, pixels.min(), int(pixels.argmin()))
