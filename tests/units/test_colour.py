"""Luminance, which host and kernels share, and sRGB's curve."""

import numpy as np
import pytest
from studies.probes import build_probe

import pylmc
from pylmc import Sampler
from pylmc.colour import LUMINANCE, srgb_decode, srgb_encode

SOURCE = """
#include "number/vectors.cl"
__kernel void probe(__global real *out) {
    out[0] = luminance((real3)(1.0, 0.0, 0.0));
    out[1] = luminance((real3)(0.0, 1.0, 0.0));
    out[2] = luminance((real3)(0.0, 0.0, 1.0));
}
"""


def test_srgb_inverts():
    values = np.linspace(0, 1, 101)
    np.testing.assert_allclose(srgb_decode(srgb_encode(values)), values, atol=1e-6)


@pytest.mark.parametrize("precision", ["single", "double", "float-float"])
def test_kernels_weigh_colours_by_the_same_numbers(precision):
    device = Sampler(pylmc.load("box", width=8, height=8), precision=precision).device_scene
    out = device.zero_reals(3)
    kernel = build_probe(device, SOURCE, "probe")
    kernel(device.queue, (1,), None, out)
    expected = LUMINANCE.astype(np.float32) if precision == "single" else LUMINANCE
    np.testing.assert_allclose(device.read_reals(out, 3), expected, rtol=1e-13)
    assert LUMINANCE.sum() == pytest.approx(1)
