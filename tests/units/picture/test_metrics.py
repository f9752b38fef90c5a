"""Error figures between pictures."""

import numpy as np
import pytest
from PIL import Image

from pylmc.errors import PylmcError
from pylmc.picture.image import write_exr
from pylmc.picture.metrics import GAP, compare, flip_map, metrics

RNG = np.random.default_rng(9)
KEYS = {"relMSE", "relMSE_trimmed", "MSE", "MAE", "SMAPE", "FLIP"}


def test_equal_pictures_have_no_error():
    image = RNG.random((20, 30, 3))
    for reference in (image, np.zeros_like(image)):
        assert metrics(reference, reference) == dict.fromkeys(KEYS, 0.0)


def test_figures_against_their_definitions():
    b = RNG.random((20, 30, 3))
    a = b * 1.1
    found = metrics(a, b)
    assert set(found) == KEYS
    assert found["MSE"] == pytest.approx(np.mean((a - b) ** 2))
    assert found["MAE"] == pytest.approx(np.mean(a - b))
    assert found["SMAPE"] == pytest.approx(0.1 / 2.1)
    assert found["relMSE"] == pytest.approx(np.mean((a - b) ** 2 / (b**2 + 1e-2 * b.mean() ** 2)))
    assert found["relMSE_trimmed"] < found["relMSE"]
    assert 0 < found["FLIP"] < 0.5


@pytest.mark.parametrize("scale", [1e-30, 1e30])
def test_relative_figures_do_not_depend_on_scale(scale):
    b = RNG.random((20, 30, 3))
    a = b * RNG.uniform(0.8, 1.2, b.shape)
    plain, scaled = metrics(a, b), metrics(a * scale, b * scale)
    for key in ("relMSE", "relMSE_trimmed", "SMAPE"):
        assert scaled[key] == pytest.approx(plain[key], rel=1e-9)
    assert scaled["FLIP"] == pytest.approx(plain["FLIP"], rel=1e-2)
    assert scaled["MSE"] == pytest.approx(plain["MSE"] * scale**2)


def test_trimming_forgives_a_firefly():
    b = RNG.uniform(0.5, 1, (50, 50, 3))
    a = b.copy()
    a[7, 7] = 1e6
    found = metrics(a, b)
    assert found["relMSE"] > 1e6 and found["relMSE_trimmed"] == 0


def test_black_reference_and_negative_values():
    image = RNG.random((20, 30, 3))
    against_black = metrics(image, np.zeros_like(image))
    assert against_black["relMSE"] == np.inf and against_black["FLIP"] > 0.5 and against_black["SMAPE"] == 1
    assert all(np.isfinite(value) for value in metrics(-image, image).values())


def test_flip_map_shows_where():
    b = np.full((40, 40, 3), 0.5)
    a = b.copy()
    a[10:20, 10:20] = (2.0, 0.1, 0.1)
    error = flip_map(a, b)
    assert error.shape == (40, 40) and error[15, 15] > 0.3 and error[35, 35] < 0.01


def test_files_and_difference_picture(tmp_path):
    b = RNG.random((20, 30, 3)).astype(np.float32)
    write_exr(tmp_path / "a.exr", b * np.float32(1.2))
    write_exr(tmp_path / "b.exr", b)
    found = compare(tmp_path / "a.exr", tmp_path / "b.exr", tmp_path / "difference.png")
    assert found["SMAPE"] == pytest.approx(0.2 / 2.2, rel=1e-4)
    assert Image.open(tmp_path / "difference.png").size == (3 * 30 + 2 * GAP, 20)


def test_bad_input(tmp_path):
    write_exr(tmp_path / "a.exr", np.ones((4, 4, 3)))
    write_exr(tmp_path / "b.exr", np.ones((4, 5, 3)))
    broken = np.ones((4, 4, 3))
    broken[1, 2] = np.nan
    write_exr(tmp_path / "nan.exr", broken)
    with pytest.raises(PylmcError, match=r"4x4 and .*5x4"):
        compare(tmp_path / "a.exr", tmp_path / "b.exr")
    with pytest.raises(PylmcError, match=r"nan\.exr: 1 pixels are NaN"):
        compare(tmp_path / "a.exr", tmp_path / "nan.exr")
    with pytest.raises(PylmcError, match="no such file"):
        compare(tmp_path / "a.exr", tmp_path / "none.exr")
    with pytest.raises(PylmcError, match="both must be"):
        metrics(np.ones((2, 2, 3)), np.ones((2, 3, 3)))
