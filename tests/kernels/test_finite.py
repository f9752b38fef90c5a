"""What is no number is told with every setting of `math` (cl_kernels/number/finite.cl), and never reaches the film."""

from __future__ import annotations

import numpy as np
import pytest
from studies.probes import build_probe

import pylmc
from pylmc.device import survey
from pylmc.device.device_scene import DeviceScene
from pylmc.sampling.compiled import compile_scene
from pylmc.settings import Settings

SOURCE = """
#include "number/finite.cl"
#include "path/film.cl"

__kernel void probe_classes(__global const float *a, __global const float *b, __global int *out) {
    int i = get_global_id(0);
    real x = (real)a[i] * (real)b[i];
    out[i] = isnan(x) | isinf(x) << 1 | isfinite(x) << 2 | is_positive(x) << 3 | is_minus_infinity(x) << 4;
}

__kernel void probe_film(__global const float *a, __global const float *b, __global volatile uint *film) {
    int i = get_global_id(0);
    film_add(film, i, (real3)((real)a[i] * (real)b[i], 0.0, 1.0));
}
"""
NAN, INF, FINITE, POSITIVE, MINUS_INF = 1, 2, 4, 8, 16
CASES = [  # two factors, what the product is
    (0, np.inf, NAN),
    (np.nan, 1, NAN),
    (np.inf, 2, INF | POSITIVE),
    (np.inf, -2, INF | MINUS_INF),
    (0, 1, FINITE),
    (-0.0, 1, FINITE),
    (3, 2, FINITE | POSITIVE),
    (-3, 2, FINITE),
    (1e-37, 2, FINITE | POSITIVE),
    (3e38, 1, FINITE | POSITIVE),
]
KINDS = [  # every math with every number type that takes it
    *((math, "single") for math in ("exact", "relaxed", "fast", "native")),
    *((math, "mixed") for math in ("exact", "fast")),
    ("exact", "float-float"),
]


@pytest.mark.parametrize(("math", "precision"), KINDS)
@pytest.mark.parametrize("spec", [str(index) for index in range(len(survey.usable()))])
def test_numbers_are_told_from_what_is_none(spec: str, math: str, precision: str) -> None:
    """Products that the compiler cannot know."""
    compiled = compile_scene(pylmc.load("box").with_size(8, 8))
    device = DeviceScene(compiled, Settings(max_depth=2, math=math), spec, precision)
    a, b, kinds = (np.array(column) for column in zip(*CASES, strict=True))
    arguments = [device.upload(column.astype(np.float32)) for column in (a, b)]
    out, film = device.zeros(4 * len(kinds)), device.zeros(24 * len(kinds))
    build_probe(device, SOURCE, "probe_classes")(device.queue, kinds.shape, None, *arguments, out)
    np.testing.assert_array_equal(device.read(out, np.int32, kinds.shape), kinds)
    build_probe(device, SOURCE, "probe_film")(device.queue, kinds.shape, None, *arguments, film)
    words = device.read(film, np.uint64, (len(kinds), 3))
    np.testing.assert_array_equal(words[:, 0] > 0, (kinds & POSITIVE > 0) & (a != 1e-37))
    assert np.all(words[:, 2] == 1 << 24)
