"""Pictures in and out."""

import numpy as np
import pytest
from PIL import Image

from pylmc.colour import srgb_decode
from pylmc.errors import PylmcError
from pylmc.picture.image import read_exr, write_exr, write_png

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
