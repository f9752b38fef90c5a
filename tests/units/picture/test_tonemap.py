"""What a screen shows of a linear picture."""

import numpy as np
import pytest

from pylmc.picture.tonemap import tonemap

RNG = np.random.default_rng(5)


@pytest.mark.parametrize("scale", [1e-30, 1e-6, 1.0, 1e6, 1e30])
def test_tonemap_does_not_depend_on_scale(scale):
    image = RNG.lognormal(0, 1, (32, 32, 3))
    np.testing.assert_allclose(tonemap(image * scale).astype(int), tonemap(image).astype(int), atol=1)
    assert 60 < tonemap(image * scale).mean() < 200


def test_tonemap_of_black_flat_and_broken_pictures():
    assert tonemap(np.zeros((4, 4, 3))).max() == 0
    grey = tonemap(np.full((4, 4, 3), 123.0))
    assert grey.min() == grey.max() and 100 < grey.max() < 140
    image = np.ones((4, 4, 3))
    image[0, 0], image[0, 1], image[0, 2] = np.nan, np.inf, -1
    shown = tonemap(image)
    assert shown[0, 0].max() == 0 and shown[0, 1].min() == 255 and shown[0, 2].max() == 0
    assert 100 < shown[3, 3].min() < 140


def test_outliers_do_not_darken_the_rest():
    image = RNG.uniform(0.2, 0.8, (64, 64, 3))
    spoiled = image.copy()
    spoiled[3, 5] = 1e20
    np.testing.assert_allclose(tonemap(spoiled)[10:].astype(int), tonemap(image)[10:].astype(int), atol=3)


def test_a_small_beam_in_a_dark_room_keeps_its_shape():
    image = RNG.uniform(1e-3, 2e-3, (64, 64, 3))
    image[20:30, 20:30] = np.linspace(5, 10, 10)[:, None, None]
    beam = tonemap(image)[20:30, 25, 0].astype(int)
    assert beam.max() - beam.min() > 12
    assert tonemap(image)[0].max() < 100
