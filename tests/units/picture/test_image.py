"""Pictures in and out."""

import numpy as np
import pytest
from PIL import Image

from pylmc.errors import PylmcError
from pylmc.picture.image import read_exr, srgb_decode, srgb_encode, tonemap, write_exr, write_png

RNG = np.random.default_rng(5)


def test_exr_round_trip_is_exact_and_keeps_metadata(tmp_path):
    image = (RNG.random((7, 11, 3)) * 10.0 ** RNG.integers(-30, 30, (7, 11, 3))).astype(np.float32)
    path = tmp_path / "a.exr"
    write_exr(path, image, {"seed": 7, "pylmc:device": "µ-core", "configuration": {"rule": "sum"}})
    back, metadata = read_exr(path)
    assert back.dtype == np.float32
    np.testing.assert_array_equal(back, image)
    assert metadata == {"seed": "7", "device": "µ-core", "configuration": "{'rule': 'sum'}"}


def test_rows_run_from_the_top(tmp_path):
    image = np.zeros((4, 3, 3))
    image[0] = 1
    write_png(tmp_path / "a.png", image)
    pixels = np.asarray(Image.open(tmp_path / "a.png"))
    assert pixels[0].min() > 0 and pixels[1:].max() == 0


def test_png_keeps_bytes_and_reads_back_linear(tmp_path):
    pixels = RNG.integers(0, 256, (5, 6, 3), dtype=np.uint8)
    write_png(tmp_path / "a.png", pixels)
    np.testing.assert_array_equal(np.asarray(Image.open(tmp_path / "a.png")), pixels)
    np.testing.assert_allclose(read_exr(tmp_path / "a.png")[0], srgb_decode(pixels / 255), atol=1e-6)


def test_srgb_inverts():
    values = np.linspace(0, 1, 101)
    np.testing.assert_allclose(srgb_decode(srgb_encode(values)), values, atol=1e-6)


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


@pytest.mark.parametrize("write", [write_exr, write_png])
def test_what_cannot_be_written(tmp_path, write):
    image = np.zeros((2, 2, 3))
    with pytest.raises(PylmcError, match=r"nowhere.*create it"):
        write(tmp_path / "nowhere" / "a.exr", image)
    with pytest.raises(PylmcError, match="is a folder"):
        write(tmp_path, image)
    with pytest.raises(PylmcError, match="cannot be written"):
        write("/proc/a.exr", image)
    with pytest.raises(PylmcError, match=r"\(2, 2\)"):
        write(tmp_path / "a.exr", image[:, :, 0])


def test_what_cannot_be_read(tmp_path):
    with pytest.raises(PylmcError, match="no such file"):
        read_exr(tmp_path / "none.exr")
    (tmp_path / "text.exr").write_text("not a picture")
    with pytest.raises(PylmcError, match="not a readable picture"):
        read_exr(tmp_path / "text.exr")
    (tmp_path / "empty.exr").write_bytes(b"")
    with pytest.raises(PylmcError, match="not a readable picture"):
        read_exr(tmp_path / "empty.exr")
    write_exr(tmp_path / "whole.exr", RNG.random((64, 64, 3)))
    whole = (tmp_path / "whole.exr").read_bytes()
    (tmp_path / "cut.exr").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(PylmcError, match="cut"):
        read_exr(tmp_path / "cut.exr")
