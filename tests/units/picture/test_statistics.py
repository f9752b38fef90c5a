"""Batch means, and one relMSE wherever an error is told."""

import numpy as np
import pytest

from pylmc.colour import LUMINANCE
from pylmc.picture.metrics import metrics
from pylmc.picture.statistics import BatchMeans, relative_error, relative_square

RNG = np.random.default_rng(7)


def test_the_variance_of_a_mean_of_weighted_batches():
    batches, weights = RNG.normal(3, 1, (40, 5)), RNG.uniform(0.5, 2, 40)
    means = BatchMeans()
    assert means.variance_of_mean() is None
    for batch, weight in zip(batches, weights, strict=True):
        means.add(batch, weight)
    mean = np.average(batches, axis=0, weights=weights)
    expected = (weights[:, None] * (batches - mean) ** 2).sum(axis=0) / (weights.sum() * 39)
    np.testing.assert_allclose(means.variance_of_mean(), expected)


def test_a_render_and_a_comparison_tell_the_same_error():
    grey, shift = RNG.lognormal(0, 1, (16, 16, 1)), 0.1
    picture = np.repeat(grey, 3, axis=2)  # grey: luminance and channels agree
    told = metrics(picture + shift, picture)["relMSE"]
    assert told == pytest.approx(relative_square(np.full((16, 16), shift**2), grey[:, :, 0]).mean())
    assert relative_error(picture, np.full((16, 16), (shift * LUMINANCE.sum()) ** 2)) == pytest.approx(np.sqrt(told))


def test_no_error_of_a_black_picture_or_a_single_batch():
    assert relative_error(np.zeros((4, 4, 3)), np.ones((4, 4))) is None
    assert relative_error(np.ones((4, 4, 3)), None) is None
