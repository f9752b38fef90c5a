"""The comparison itself: its error rate, what it sees, what it leaves behind; and the closed forms where they are known."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy import stats
from studies.closed_forms import fresnel_reflectance, ggx_albedo, pixel_means
from studies.comparison import evidence
from studies.comparison.verdict import LEVELS, TILE, Verdict, judge, sidak

from pylmc.picture.image import read_exr
from pylmc.scene import Camera

SHAPE = (8, 9, 3)  # a column beside the tiles


def pictures(rng: np.random.Generator, runs: int, spread: float = 0.1) -> np.ndarray:
    """Runs about one and the same picture, their noise skewed and shared in part by all pixels of a run."""
    noise = rng.gamma(4.0, 0.25, (runs, *SHAPE)) - 1 + 0.1 * rng.normal(size=(runs, 1, 1, 3))
    return np.linspace(1, 2, SHAPE[1])[:, None] * (1 + spread * noise)


def test_level_is_kept() -> None:
    """Equal means are told apart no more often than alpha says, skewed noise, unequal numbers and spreads included."""
    rng, repetitions, alpha = np.random.default_rng(1), 400, 0.05
    failures = 0
    for _ in range(repetitions):
        verdict = judge(pictures(rng, 16), pictures(rng, 32, 0.03), alpha=alpha)
        failures += not verdict.passed
    assert stats.binomtest(failures, repetitions, alpha, alternative="greater").pvalue > 1e-3, failures
    assert failures > 0  # correlated tests make it less than alpha, but not nothing


def test_known_answer() -> None:
    """Against a known picture p is that of Student's test on the runs; a pixel's is that or larger."""
    runs = pictures(np.random.default_rng(2), 16)
    known = np.broadcast_to(np.linspace(1, 2, SHAPE[1])[:, None], SHAPE)
    verdict = judge(runs, known)
    assert verdict.passed
    plain = stats.ttest_1samp(runs, known).pvalue
    assert np.all(verdict.p["pixels"] >= plain - 1e-12) and np.isclose(verdict.p["pixels"], plain).mean() > 0.2
    assert np.allclose(verdict.p["film"], stats.ttest_1samp(runs.mean(axis=(1, 2)), known.mean(axis=(0, 1))).pvalue)
    assert verdict.p["tiles"].shape == (SHAPE[0] // TILE, SHAPE[1] // TILE, 3)


def test_welch() -> None:
    rng = np.random.default_rng(3)
    a, b = pictures(rng, 8), pictures(rng, 20, 0.5)
    verdict, plain = judge(a, b), stats.ttest_ind(a.mean(axis=(1, 2)), b.mean(axis=(1, 2)), equal_var=False)
    assert np.allclose(verdict.p["film"], plain.pvalue)


def test_sidak() -> None:
    assert 1 - (1 - sidak(0.01, 50)) ** 50 == pytest.approx(0.01)
    verdict = judge(pictures(np.random.default_rng(4), 8), pictures(np.random.default_rng(5), 8), comparisons=7, alpha=0.01)
    spent = sum(7 * verdict.p[level].size * np.log1p(-verdict.threshold[level]) for level in LEVELS)
    assert 1 - np.exp(spent) == pytest.approx(0.01)


def test_errors_somewhere_and_everywhere_are_seen() -> None:
    rng = np.random.default_rng(6)
    independent = 1 + 0.1 * rng.normal(size=(2, 16, *SHAPE))
    one, other = independent
    assert judge(one, other).passed
    spot = one.copy()
    spot[:, 3, 4, 1] += 0.5
    verdict = judge(spot, other)
    assert not verdict.passed and verdict.p["pixels"].argmin() == np.ravel_multi_index((3, 4, 1), SHAPE)
    everywhere = judge(1.02 * one, other)  # lost in the noise of a pixel
    assert not everywhere.passed and everywhere.p["pixels"].min() > everywhere.threshold["pixels"]


def test_missing_highlights_do_not_alarm() -> None:
    """A pixel that two runs in sixteen light up, here none of them, is not taken for certain: its neighbours vary."""
    rng = np.random.default_rng(9)
    rare = 1 + 10.0 * (rng.random((2, 16, *SHAPE)) < 0.1) + 1e-3 * rng.normal(size=(2, 16, *SHAPE))
    rare[0, :, 4, 4] = np.minimum(rare[0, :, 4, 4], 1)
    rare[1, :, 4, 4] = 3 + 1e-3 * rng.normal(size=(16, 3))
    assert stats.ttest_ind(rare[0, :, 4, 4], rare[1, :, 4, 4], equal_var=False).pvalue.min() < 1e-20
    assert judge(rare[0], rare[1]).passed


def test_what_does_not_vary() -> None:
    """Black is black; and any difference between two exact pictures counts."""
    zero = np.zeros((4, *SHAPE))
    assert judge(zero, zero).passed
    assert not judge(zero, zero + 1e-3).passed


@pytest.fixture
def failed() -> Verdict:
    rng = np.random.default_rng(7)
    return judge(pictures(rng, 12) + 1, pictures(rng, 12))


def test_failures_leave_evidence(failed: Verdict, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(evidence, "FOLDER", tmp_path / "out")
    with pytest.raises(AssertionError, match=r"scene/path: least p-values.*see .*scene"):
        evidence.confirm(failed, "scene/path")
    folder = tmp_path / "out" / "scene" / "path"
    files = {file.name for file in folder.iterdir()}
    assert files == {
        "tested.exr",
        "expected.exr",
        "difference.exr",
        "standard_errors.exr",
        "p_values.exr",
        "tested.png",
        "expected.png",
        "standard_errors.png",
        "verdict.json",
    }
    assert np.allclose(read_exr(folder / "difference.exr")[0], failed.mean - failed.expected, rtol=1e-6, atol=1e-6)
    assert np.allclose(read_exr(folder / "p_values.exr")[0], failed.p["pixels"], rtol=1e-6)
    numbers = json.loads((folder / "verdict.json").read_text())
    assert not numbers["passed"] and numbers["tests"]["pixels"] == np.prod(SHAPE)
    # once it passes nothing is left that could be taken for a failure
    right = pictures(np.random.default_rng(8), 12)
    evidence.confirm(judge(right, right), "scene/path")
    assert not folder.exists()


def test_colours_of_a_difference() -> None:
    colours = evidence.diverging(np.array([[-np.inf, -3.0, 0.0, 3.0, np.inf]]))[0]
    assert np.array_equal(colours, [[0, 0, 255], [128, 128, 255], [255, 255, 255], [255, 128, 128], [255, 0, 0]])


# --- closed forms -----------------------------------------------------------------------------------------------------


def test_fresnel() -> None:
    for eta in (1.5, 1 / 1.5):
        assert fresnel_reflectance(np.array([1.0]), eta) == pytest.approx(((eta - 1) / (eta + 1)) ** 2, rel=1e-4)
        brewster = np.cos(np.arctan(eta))
        # at Brewster's angle nothing of the parallel half is reflected, and angles add up to a right one
        half = np.sin(2 * np.arctan(eta) - np.pi / 2) ** 2 / 2
        assert fresnel_reflectance(np.array([brewster]), eta) == pytest.approx(half, rel=1e-6)
    assert fresnel_reflectance(np.array([0.5]), 1 / 1.5) == 1  # beyond the critical angle


@pytest.mark.parametrize("separable", [False, True])
@pytest.mark.parametrize("eta", [1.5, 1 / 1.5])
def test_albedo_of_nearly_flat_facets(eta: float, separable: bool) -> None:
    cosine = np.array([0.5, 0.9, 1.0])
    albedo = ggx_albedo(cosine, 1e-3, eta, separable)
    flat = fresnel_reflectance(cosine, eta)
    assert albedo.reflected == pytest.approx(flat, abs=1e-3) and albedo.refracted == pytest.approx(1 - flat, abs=1e-3)


def test_albedo_at_normal_incidence() -> None:
    """There Λ_i = 0, both masking terms agree, and one integral over the polar angle is left: by adaptive quadrature."""
    from scipy.integrate import quad

    alpha = 0.7

    def integrand(theta: float) -> float:
        # h at angle θ, the reflected direction at 2 θ: F = 1, G2 = G1(o), |i.h| / cos θ_i = cos θ
        d = 1 / (np.pi * alpha**2 * (np.cos(theta) ** 2 + np.sin(theta) ** 2 / alpha**2) ** 2)
        g1 = 2 / (1 + np.sqrt(1 + alpha**2 * np.tan(2 * theta) ** 2))
        return float(2 * np.pi * np.sin(theta) * d * g1 * np.cos(theta))

    known = quad(integrand, 0, np.pi / 4)[0]
    for separable in (False, True):
        assert ggx_albedo(np.array([1.0]), alpha, None, separable).reflected == pytest.approx(known, rel=1e-4)


def test_pixel_means() -> None:
    """A pixel is a mean over its area on the film, and row 0 is at the top."""
    camera = Camera((0, 0, 0), (0, 0, -1), fov=90, width=4, height=2)
    means = pixel_means(camera, lambda v: np.stack([v[:, 0] / -v[:, 2], v[:, 1] / -v[:, 2], np.ones(len(v))], axis=-1))
    assert np.allclose(means[..., 0], [[-1.5, -0.5, 0.5, 1.5]] * 2) and np.allclose(means[..., 1], [[0.5] * 4, [-0.5] * 4])
    assert np.allclose(means[..., 2], 1)
