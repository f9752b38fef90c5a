"""Are two sets of independent pictures, or one set and a known answer, equal in the mean?

Every standard error comes from whole independent runs, each with its own seed and its own start, so the correlation of a
chain's samples, across pixels too, is in it. The test is Student's t (Welch's for two sets, with its degrees of freedom),
at three resolutions: pixels, tiles of ``TILE`` by ``TILE`` pixels, and the whole film, each of the three channels apart.
Coarser resolutions see small errors that are everywhere, pixels see errors that are somewhere.

Light is skewed: where a pixel's rare bright samples stayed away, its mean and its variance are too small together, and t
is too large. So a single pixel is given the variance of its ``NEIGHBOURHOOD`` where that is larger, which can only raise p.

The level is shared by Šidák's correction among the resolutions, among a resolution's tests, and among the ``comparisons``
that make up a family: a family in which nothing is wrong fails with probability ``ALPHA`` at most.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats
from scipy.ndimage import uniform_filter

ALPHA = 1e-4
TILE = 4  # pixels; a remainder at the film's right and lower edge takes part in pixels and film only
NEIGHBOURHOOD = 5  # pixels on a side
LEVELS = ("pixels", "tiles", "film")


def sidak(alpha: float, tests: int) -> float:
    """The level of each of ``tests`` tests that together fail with probability ``alpha``."""
    return float(-np.expm1(np.log1p(-alpha) / tests))


@dataclass(frozen=True, eq=False)
class Verdict:
    """What a comparison found; arrays are keyed by resolution, images are (height, width, 3)."""

    mean: np.ndarray  # of the tested runs, per pixel
    expected: np.ndarray  # mean of the reference's runs, or the known answer
    error: dict[str, np.ndarray]  # standard error of the difference
    t: dict[str, np.ndarray]  # difference over its standard error
    p: dict[str, np.ndarray]  # two-sided
    threshold: dict[str, float]
    alpha: float
    comparisons: int

    @property
    def passed(self) -> bool:
        return all(self.p[level].min() > self.threshold[level] for level in LEVELS)

    @property
    def ratio(self) -> float:
        """Mean of the tested pictures over the mean of the reference's."""
        return float(self.mean.mean() / self.expected.mean())

    @property
    def ratio_error(self) -> float:
        """Standard error of the ratio: that of the film's mean, all channels taken as one correlated whole (an upper bound)."""
        return float(self.error["film"].mean() / self.expected.mean())

    def summary(self) -> dict[str, object]:
        """Numbers for a table or a JSON file."""
        return {
            "passed": self.passed,
            "alpha": self.alpha,
            "comparisons": self.comparisons,
            "tests": {level: int(self.p[level].size) for level in LEVELS},
            "least_p": {level: float(self.p[level].min()) for level in LEVELS},
            "threshold": self.threshold,
            "ratio": self.ratio,
            "ratio_error": self.ratio_error,
            "largest_t": {level: float(np.abs(self.t[level]).max()) for level in LEVELS},
        }


def resolutions(runs: np.ndarray) -> dict[str, np.ndarray]:
    """Pictures (runs, height, width, 3) as they are, averaged over tiles, and averaged over the film."""
    height, width = (side // TILE * TILE for side in runs.shape[1:3])
    tiles = runs[:, :height, :width].reshape(len(runs), height // TILE, TILE, width // TILE, TILE, -1).mean(axis=(2, 4))
    return {"pixels": runs, "tiles": tiles, "film": runs.mean(axis=(1, 2))}


def _variance_of_mean(runs: np.ndarray, level: str) -> np.ndarray:
    variance = runs.var(axis=0, ddof=1) / len(runs)
    if level != "pixels":
        return variance
    return np.maximum(variance, uniform_filter(variance, (NEIGHBOURHOOD, NEIGHBOURHOOD, 1), mode="nearest"))


def _student(difference: np.ndarray, variance: np.ndarray, df: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
    """t and two-sided p. Where nothing varies, equal is equal and different is different."""
    error = np.sqrt(variance)
    t = np.divide(difference, error, where=error > 0, out=np.where(difference == 0, 0.0, np.copysign(np.inf, difference)))
    return t, 2 * stats.t.sf(np.abs(t), df)


def judge(runs: np.ndarray, reference: np.ndarray, comparisons: int = 1, alpha: float = ALPHA) -> Verdict:
    """Compare pictures (runs, height, width, 3) with a reference's (runs, height, width, 3) or a known (height, width, 3)."""
    known = reference.ndim == 3
    one, other = resolutions(runs), resolutions(reference[None] if known else reference)
    error, t, p, threshold = {}, {}, {}, {}
    for level in LEVELS:
        a, b = one[level], other[level]
        difference = a.mean(axis=0) - b.mean(axis=0)
        share_a = _variance_of_mean(a, level)
        if known:
            variance, df = share_a, np.full(share_a.shape, len(a) - 1.0)
        else:
            share_b = _variance_of_mean(b, level)
            variance = share_a + share_b
            pooled = share_a**2 / (len(a) - 1) + share_b**2 / (len(b) - 1)
            df = np.divide(variance**2, pooled, where=pooled > 0, out=np.ones_like(variance))  # Welch and Satterthwaite
        error[level] = np.sqrt(variance)
        t[level], p[level] = _student(difference, variance, df)
        threshold[level] = sidak(alpha, len(LEVELS) * comparisons * difference.size)
    return Verdict(runs.mean(axis=0), other["pixels"].mean(axis=0), error, t, p, threshold, alpha, comparisons)
