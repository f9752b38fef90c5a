"""The independent sampler: its density and the integrand against float64, its normalisation, and the path tracer.

Families of tests are held together by Šidák's correction: ALPHA is the chance that a family of right results fails.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracle.chains import read_paths, world_of, write_paths
from oracle.independent import log_p as oracle_log_p
from oracle.integrand import film_weight_at
from oracle.integrand import log_pi as oracle_log_pi
from oracle.lobes import settled_lobe
from oracle.paths import CONNECT, Paths, paths_through, surface
from oracle.scene import World
from oracle.vectors import dot
from scipy import stats
from studies.agreement import ALPHA, SCENES, bdpt_batches, path_batches, same_means, scene_of, sidak
from studies.probes import edited_source

import pylmc
from pylmc.device.tables import ENDINGS
from pylmc.sampling.sampler import Sampler


def arbitrary_paths(world: World, length: int, ending: int, n: int, rng: np.random.Generator) -> tuple[Paths, Any]:
    """Paths through uniform points of the surfaces, with lobes drawn from each material's: most carry no light."""
    triangle = rng.choice(len(world.areas), (n, length), p=world.areas / world.areas.sum())
    light = np.zeros(n, int)
    if ending == CONNECT:
        triangle[:, -1] = -1
        light = rng.integers(0, len(world.arrays["lights"]), n)
    else:
        shining = world.arrays["emitter_triangles"]
        triangle[:, -1] = rng.choice(shining, n)
    # float32 barycentrics, as a chain's state holds them
    root, share = np.sqrt(rng.random((n, length))), rng.random((n, length))
    u, v = (root * (1 - share)).astype(np.float32), (root * share).astype(np.float32)
    weights = np.stack([1 - u.astype(float) - v, u, v], axis=-1)
    material = world.materials[np.maximum(triangle, 0)]
    # any of its lobes, alike
    lobe = np.argmax((material["choice"] > 0) * rng.random(material["choice"].shape), axis=-1)
    paths = paths_through(world, length, ending, light, triangle, weights, lobe)
    for i in range(1, length):  # of a pair, the one that the directions say
        paths.lobe[:, i] = settled_lobe(surface(world, paths, i), paths.v[:, i], paths.v[:, i + 1])
    return paths, weights


def same_logs(kernel: np.ndarray, reference: np.ndarray, tolerance: float) -> np.ndarray:
    """Whether two arrays of logarithms agree, minus infinity included."""
    with np.errstate(invalid="ignore"):
        close = np.abs(kernel - reference) <= tolerance * (1 + 0.01 * np.abs(reference))
    return close | (np.isneginf(kernel) & np.isneginf(reference))


def least_cosine(paths: Paths) -> np.ndarray:
    """The most grazing angle at which a segment meets or leaves a node."""
    least = np.ones(len(paths.light))
    for i in range(1, paths.free + 1):
        for v in [paths.v[:, i]] + ([paths.v[:, i + 1]] if i < paths.length else []):
            least = np.minimum(least, np.abs(dot(paths.ng[:, i], v)))
    return least


@pytest.mark.parametrize("name", SCENES)
def test_densities_of_arbitrary_paths(name: str) -> None:
    """log π and log p_ind of unlikely, dark and impossible paths, from the kernels' float32 and from float64."""
    sampler = Sampler(scene_of(name), max_depth=5)
    sampler.init(0, chains=64, candidates=1 << 12)
    world, rng = world_of(sampler), np.random.default_rng(7)
    total = wrong = lit = 0
    for group in sampler.path_groups():
        paths, weights = arbitrary_paths(world, group.length, group.ending, 4000, rng)
        write_paths(sampler, paths, weights)
        states = sampler.states()
        assert not np.any(np.isnan(states.log_pi)) and not np.any(np.isposinf(states.log_pi))
        # two nodes of one plane may face each other edge-on: no density is asked of such a path
        proper = (least_cosine(paths) > 1e-3) & np.all(paths.t[:, 1:] > 1e-3, axis=1)
        assert not np.any(np.isnan(states.log_p[proper]))
        log_pi, log_p = oracle_log_pi(world, paths), oracle_log_p(world, paths)
        good = same_logs(states.log_pi, log_pi, 2e-3) & same_logs(states.log_p, log_p, 2e-3)
        total, wrong = total + int(proper.sum()), wrong + int((proper & ~good).sum())
        lit += int((proper & np.isfinite(log_pi)).sum())
    assert lit > 300
    # sides of surfaces, edges of portals and of the film are decided in float32: a few paths fall on the other one
    assert wrong <= 1e-3 * total, (wrong, total)


@pytest.mark.parametrize("name", SCENES)
def test_densities_of_likely_paths(name: str) -> None:
    """The same for paths drawn from the target, whose segments the brute-force caster must find free."""
    sampler = Sampler(scene_of(name), max_depth=5)
    sampler.init(1, chains=400, candidates=1 << 14)
    world, states = world_of(sampler), sampler.states()
    alpha = np.where(world.materials["alpha"] > 0, world.materials["alpha"], 1.0).min()
    blocked = seen = 0
    for which, paths in read_paths(sampler, world).values():
        # a node's rounding turns directions by 1e-7 / t, which a grazing angle or a narrow lobe makes worse: a hundred
        # of those; and the film weight's slope, ten over one of its 64 cells, times the rounding of the film position
        bound = 1e-4 + 1e-5 / (alpha * paths.t[:, 1:].min(axis=1) * least_cosine(paths))
        assert np.all(np.abs(states.log_pi[which] - oracle_log_pi(world, paths)) < bound)
        assert np.all(np.abs(states.log_p[which] - oracle_log_p(world, paths)) < bound)
        sample = slice(0, 25)
        for i in range(1, paths.length + 1):
            x, v = paths.x[sample, i - 1], paths.v[sample, i]
            t, hit = world.cast(x, v, paths.triangle[sample, i - 1])
            far = paths.t[sample, i]
            free = (hit == paths.triangle[sample, i]) | (t > far * (1 - 1e-4))
            blocked, seen = blocked + int((~free).sum()), seen + len(free)
    assert blocked <= 0.002 * seen  # rays through an edge


# --- normalisation -------------------------------------------------------------------------------------------------

DRAW = "return rng_index(rng, split_count(length, ending));"
SUM = "if (is_log_of_some(term)) {"
MEAN = "return log_sum - log((real)splits) + log_choices;"


@pytest.mark.parametrize("name", ["box", "keyhole", "textured"])
def test_b_does_not_depend_on_the_splits(name: str) -> None:
    """b from the first splits alone (most of the path from the light) or without them equals that from all."""
    results = {}
    for label, low, high in (("all", "0", "splits"), ("first two", "0", "min(2, splits)"), ("others", "1", "splits")):
        edits = {
            DRAW: f"int splits = split_count(length, ending); return {low} + rng_index(rng, {high} - {low});",
            SUM: f"if (is_log_of_some(term) && k >= {low} && k < {high}) {{",
            MEAN: f"return log_sum - log((float)({high} - {low})) + log_choices;",
        }
        # one-segment paths that end on the light have two splits: both parts keep at least one
        with edited_source(edits):
            results[label] = Sampler(scene_of(name), max_depth=4).weigh(1 << 17, seed=11)
    tests = 2 * len(results["all"])
    for label in ("first two", "others"):
        for whole, part in zip(results["all"], results[label], strict=True):
            assert (whole.b > 0) == (part.b > 0)  # the textured scene's panel shows the camera its back
            z = (whole.b - part.b) / max(np.hypot(whole.b_error, part.b_error), 1e-300)
            assert 2 * stats.norm.sf(abs(z)) > sidak(ALPHA, tests), (label, whole.name, z)


def test_b_of_an_evened_target_is_not_biased() -> None:
    """The weights over the film are fitted to a pilot's paths; b under them must be right all the same.

    Fitted to the very paths that b is then estimated from, they made it a tenth too small at this number of candidates.
    """
    scene = pylmc.load("caustic").with_size(24, 18)
    plain = Sampler(scene, max_depth=4, even=False)
    groups = [group for seed in (500, 501) for group in plain.weigh(1 << 18, seed)]
    positions = np.concatenate([group.positions for group in groups])
    weights = np.exp(np.concatenate([group.log_weights for group in groups])) / (2 << 18)
    found = weights > 0
    ratios = []
    for seed in range(12):
        sampler = Sampler(scene, max_depth=4)
        estimate = sum(group.b for group in sampler.init(seed, 64, 1 << 14))
        even = world_of(sampler).evenness
        assert even is not None and even.std() > 0
        ratios.append(estimate / (weights[found] * film_weight_at(even, positions[found])).sum())
    assert stats.ttest_1samp(ratios, 1.0).pvalue > ALPHA, np.mean(ratios)
    assert np.std(ratios) / np.sqrt(len(ratios)) < 0.02  # the bias above would show


# --- films by path length ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SCENES)
def test_bdpt_and_path_tracer_agree_by_path_length(name: str) -> None:
    """Each group's film, pixel by pixel and in total: two samplers that share only lobes and rays."""
    depth = 5
    groups = bdpt_batches(name, seeds=2, launches=8, depth=depth)
    by_path = {ending: path_batches(name, ending, 16, 96, depth) for ending in {e for _, e in groups}}
    tests = sum(film[0].size + 1 for film in groups.values())
    whole = sum(film.mean() for film in groups.values())
    for (length, ending), film in groups.items():
        other = by_path[ending][:, length - 1]
        label = f"{length} {ENDINGS[ending]}"
        pixels = same_means(film, other)
        total = same_means(film.mean(axis=(1, 2)), other.mean(axis=(1, 2)))
        assert pixels.min() > sidak(ALPHA, tests), (label, pixels.min(), int(pixels.argmin()))
        assert total > sidak(ALPHA, tests), (label, total, film.mean(), other.mean())
        if film.mean() > 0.02 * whole:
            # enough samples for the totals to mean something: an error of one part in five would stand out
            error = np.hypot(*(f.mean(axis=(1, 2)).std(ddof=1) / np.sqrt(len(f)) for f in (film, other)))
            assert error < 0.05 * film.mean(), (label, error, film.mean())
