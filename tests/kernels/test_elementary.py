"""log, exp, sin and cos of floats (cl_kernels/number/elementary.cl) against float64: errors over all floats, and edges."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from studies.devices import alike
from studies.probes import build_probe

import pylmc
from pylmc.device import survey
from pylmc.device.device_scene import DeviceScene
from pylmc.sampling.compiled import compile_scene
from pylmc.settings import Settings

FUNCTIONS = {"log": np.log, "exp": np.exp, "sin": np.sin, "cos": np.cos}
# Kernels that go through floats by their bits: first, first + stride, ...
SOURCE = '#include "number/real.cl"\n' + "".join(
    f"""__kernel void probe_{name}(uint first, uint stride, __global float *out) {{
    uint i = get_global_id(0);
    out[i] = {name}(as_float(first + stride * i));
}}
"""
    for name in FUNCTIONS
)
BLOCK = 1 << 22
LIMIT = np.float32(3000)  # CIRCULAR_LIMIT
# Greatest error in ulps, as elementary.cl states it for math="exact"; a compiler that may contract and reorder gets room.
BOUNDS = {"exact": {"log": 0.85, "exp": 1.02, "sin": 1.5, "cos": 2.21}, "relaxed": dict.fromkeys(FUNCTIONS, 4.0)}
ABSOLUTE = {"exact": 1.32 * 2.0**-24, "relaxed": 3 * 2.0**-24}  # of sin and cos of greater angles

Evaluate = Callable[[str, int, int], np.ndarray]


def bits(value: float) -> int:
    return int(np.float32(value).view(np.uint32))


def floats(first: int, stride: int = 1) -> np.ndarray:
    with np.errstate(over="ignore"):
        return (np.uint32(first) + np.uint32(stride) * np.arange(BLOCK, dtype=np.uint32)).view(np.float32)


def evaluator(math: str, spec: str) -> Evaluate:
    """The functions on that device: (name, first, stride) to the values at BLOCK floats."""
    device = DeviceScene(compile_scene(pylmc.load("box").with_size(8, 8)), Settings(max_depth=2, math=math), spec)
    kernels = {name: build_probe(device, SOURCE, f"probe_{name}") for name in FUNCTIONS}
    buffer = device.zeros(4 * BLOCK)

    def evaluate(name: str, first: int, stride: int = 1) -> np.ndarray:
        kernels[name](device.queue, (BLOCK,), None, np.uint32(first), np.uint32(stride), buffer)
        return device.read(buffer, np.float32, BLOCK)

    return evaluate


@pytest.fixture(scope="module", params=[str(index) for index in range(len(survey.usable()))])
def spec(request: pytest.FixtureRequest) -> str:
    """Each usable device in turn."""
    return request.param


@pytest.fixture(scope="module")
def exact(spec: str) -> Evaluate:
    return evaluator("exact", spec)


def check(name: str, x: np.ndarray, got: np.ndarray, math: str = "exact") -> float:
    """The greatest error in ulps where that is bounded; a failure where a bound is passed."""
    with np.errstate(all="ignore"):
        true = FUNCTIONS[name](x.astype(np.float64))
        ulp = np.exp2(np.maximum(np.frexp(true)[1] - 1, -126) - 23.0)
        error = np.abs(got.astype(np.float64) - true)
        counts = np.isfinite(x) & np.isfinite(true) & (np.abs(true) < np.finfo(np.float32).max)
    if name in ("sin", "cos"):
        counts &= np.abs(x) <= LIMIT
        assert np.all(error[counts] <= ABSOLUTE[math]), name
        counts &= np.abs(x) <= 8
    assert np.all(np.isfinite(got[counts]))
    worst = float(np.max((error / ulp)[counts], initial=0.0))
    assert worst <= BOUNDS[math][name], f"{name}({x[counts][np.argmax((error / ulp)[counts])]!r}): {worst} ulp"
    return worst


@pytest.mark.parametrize("name", FUNCTIONS)
def test_errors_are_as_stated(exact: Evaluate, name: str) -> None:
    """Every 1021st float of either sign, and every float of two binades in which the function is hardest."""
    hardest = {"log": 0.5, "exp": 64.0, "sin": 2.0, "cos": 4.0}[name]
    worst = check(name, floats(0, 1021), exact(name, 0, 1021))
    for first in range(bits(hardest), bits(4 * hardest), BLOCK):
        worst = max(worst, check(name, floats(first), exact(name, first)))
    print(f"{name}: {worst:.3f} ulp")


@pytest.mark.long
@pytest.mark.parametrize("name", FUNCTIONS)
def test_errors_are_as_stated_for_every_float(exact: Evaluate, name: str) -> None:
    """All 2^32 of them."""
    print(f"{name}: {max(check(name, floats(first), exact(name, first)) for first in range(0, 1 << 32, BLOCK)):.3f} ulp")


@pytest.mark.parametrize("name", FUNCTIONS)
def test_relaxed_math_loses_little(spec: str, name: str) -> None:
    """Contracted and reordered by the compiler, arguments are still reduced with all their digits."""
    relaxed = evaluator("relaxed", spec)
    worst = check(name, floats(0, 1021), relaxed(name, 0, 1021), "relaxed")
    for first in range(bits(1.0), bits(8.0), BLOCK):
        worst = max(worst, check(name, floats(first), relaxed(name, first), "relaxed"))
    print(f"{name}: {worst:.3f} ulp")


@pytest.mark.parametrize("math", ["exact", "fast"])
def test_edges(spec: str, math: str) -> None:
    """What has no ordinary result has the right one, where a compiler may forget NaN and infinities too."""
    evaluate = evaluator(math, spec)
    inf, nan, least = np.inf, np.nan, np.finfo(np.float32).smallest_subnormal
    expected = {
        "log": [
            (0, -inf),
            (-0.0, -inf),
            (inf, inf),
            (-inf, nan),
            (nan, nan),
            (-1, nan),
            (-least, nan),
            (1, 0),
            (least, -103.278929),
        ],
        "exp": [(0, 1), (-0.0, 1), (inf, inf), (-inf, 0), (nan, nan), (88.72284, inf), (-104, 0), (1e30, inf), (-1e30, 0)],
        "sin": [(0, 0), (inf, nan), (-inf, nan), (nan, nan), (3001, nan), (-1e30, nan), (least, least)],
        "cos": [(0, 1), (inf, nan), (-inf, nan), (nan, nan), (3001, nan), (-1e30, nan), (least, 1)],
    }
    for name, pairs in expected.items():
        for x, value in pairs:
            got = evaluate(name, bits(x))[0]
            np.testing.assert_array_equal(got, np.float32(value), err_msg=f"{name}({x})")


def test_devices_give_the_same_bits() -> None:
    """Of every 509th float."""
    first, *others = [evaluator("exact", device) for device in alike()]
    for name in FUNCTIONS:
        for start in (0, 1 << 31):
            reference = first(name, start, 509)
            for other in others:
                np.testing.assert_array_equal(other(name, start, 509), reference, err_msg=name)
