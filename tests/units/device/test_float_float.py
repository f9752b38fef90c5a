"""Pairs of floats: each operation of cl_kernels/number/float_float.cl against long double, in kernels that are translated.

Bounds are those that the files state: proven ones for arithmetic (u = 2^-24), 2^-45 for functions, 2^-43 for either where
the device divides sloppily. Samples are fixed.
"""

from __future__ import annotations

import re

import numpy as np
import pyopencl as cl
import pytest

from pylmc.device import program
from pylmc.device.float_float import pack, translate, unpack
from pylmc.device.survey import context_and_queue, select

U2 = 2.0**-48
COUNT = 1 << 15
FUNCTIONS = ("sqrt(x)", "rsqrt(x)", "exp(x)", "log(x)", "sin(x)", "cos(x)", "floor(x)", "fabs(x)", "-x", "trunc(x)")
OPERATIONS = ("x + y", "x - y", "x * y", "x / y", "fmin(x, y)", "fmax(x, y)", "copysign(x, y)", "mix(x, y, 0.25)")
COMPARISONS = ("x < y", "x <= y", "x > y", "x >= y", "x == y", "x != y")


def kernel_text() -> str:
    """Kernels that evaluate each expression for every element: the result of expression e of element i is out[e][i]."""
    real = "".join(f"out[{e} * n + i] = {text};\n" for e, text in enumerate((*FUNCTIONS, *OPERATIONS)))
    integer = "".join(f"out[{e} * n + i] = {text};\n" for e, text in enumerate(COMPARISONS))
    parameters = "__global const real *xs, __global const real *ys"
    start = "int n = get_global_size(0), i = get_global_id(0);\nreal x = xs[i], y = ys[i];\n"
    return (
        f"__kernel void evaluate({parameters}, __global real *out) {{\n{start}{real}}}\n"
        f"__kernel void compare({parameters}, __global int *out) {{\n{start}{integer}}}\n"
    )


# Edits of the library, as pattern and replacement. "split": products' errors come from split factors. "sloppy": division,
# sqrt and rsqrt are 2.5 ulp off, which is about what OpenCL allows and this device does not make use of.
VARIANTS = {
    "fma": (),
    "split": ((r"defined\(FP_FAST_FMAF\) \|\| defined\(__FMA__\)", "0"),),
    "sloppy": (
        (r"/ (y\.hi|\(2\.0f \* (root|first)\))", r"* 1.0000003f / \1"),
        (r"\b(r?sqrt)\(x\.hi\)", r"(1.0000003f * \1(x.hi))"),
    ),
}


class Evaluator:
    """The kernels on the default device, with a variant of the library."""

    def __init__(self, variant: str) -> None:
        self.sloppy = variant == "sloppy"
        self.bound = 2.0**-43 if self.sloppy else 2.0**-45  # of functions, as stated
        self.context, self.queue = context_and_queue(select(None))
        library = program.source("number/float_float.cl")
        for pattern, replacement in VARIANTS[variant]:
            library, count = re.subn(pattern, replacement, library)
            assert count, pattern
        text = translate(f'{library}\n#line 1 "kernels.cl"\n{kernel_text()}')
        self.program = cl.Program(self.context, text).build()

    def run(self, kernel: str, x: np.ndarray, y: np.ndarray, rows: int, dtype: type) -> np.ndarray:
        flags = cl.mem_flags.READ_WRITE | cl.mem_flags.COPY_HOST_PTR
        buffers = [cl.Buffer(self.context, flags, hostbuf=pack(values)) for values in (x, y)]
        out = np.zeros((rows, len(x)), dtype)
        result = cl.Buffer(self.context, flags, hostbuf=out)
        cl.Kernel(self.program, kernel)(self.queue, (len(x),), None, *buffers, result)
        cl.enqueue_copy(self.queue, out, result)
        return out

    def evaluate(self, x: np.ndarray, y: np.ndarray | None = None) -> dict[str, np.ndarray]:
        """Float64 results by expression."""
        out = self.run("evaluate", x, x if y is None else y, len(FUNCTIONS) + len(OPERATIONS), np.uint64)
        return dict(zip((*FUNCTIONS, *OPERATIONS), unpack(out), strict=True))

    def compare(self, x: np.ndarray, y: np.ndarray) -> dict[str, np.ndarray]:
        out = self.run("compare", x, y, len(COMPARISONS), np.int32)
        return dict(zip(COMPARISONS, out.astype(bool), strict=True))


@pytest.fixture(scope="module", params=list(VARIANTS))
def device(request):
    return Evaluator(request.param)


def samples(seed: int, low: float, high: float) -> np.ndarray:
    """Pairs of either sign, with log2 uniform between the bounds: values that pack and unpack exactly."""
    rng = np.random.default_rng(seed)
    values = np.exp2(rng.uniform(low, high, COUNT)) * rng.choice([-1, 1], COUNT)
    values[:64] = np.float32(values[:64])  # no low word
    values[64:128] = np.exp2(np.rint(np.log2(np.abs(values[64:128]))))  # powers of two
    return unpack(pack(values))


def relative(got: np.ndarray, exact: np.ndarray) -> float:
    """The greatest relative error."""
    exact = exact.astype(np.longdouble)
    error = np.abs(got - exact)
    return float(np.max(np.where(error == 0, 0, error / np.where(exact == 0, 1, np.abs(exact)))))


def test_packing_keeps_48_bits_and_round_trips():
    values = samples(1, -70, 120)
    raw = np.random.default_rng(2).uniform(-1, 1, COUNT) * np.exp2(np.linspace(-70, 120, COUNT))
    assert relative(unpack(pack(raw)), raw) <= 2.0**-48
    np.testing.assert_array_equal(unpack(pack(values)), values)
    special = np.array([[0.0, -0.0, np.inf], [-np.inf, 1e300, 1e-300]])
    np.testing.assert_array_equal(unpack(pack(special)), [[0.0, -0.0, np.inf], [-np.inf, np.inf, 0.0]])
    assert np.isnan(unpack(pack(np.array([np.nan])))[0])
    assert pack(special).dtype == np.uint64 and pack(special).shape == (2, 3)
    hi, lo = np.array([pack(0.1)]).view(np.float32)
    assert hi == np.float32(0.1) and lo == np.float32(0.1 - float(hi))


def test_arithmetic_is_within_its_proven_bounds(device):
    x, y = samples(3, -30, 30), samples(4, -30, 30)
    near = unpack(pack(-x * (1 + np.exp2(np.random.default_rng(5).uniform(-50, -1, COUNT)))))  # sums that cancel
    bounds = {"x + y": 3.1 * U2, "x - y": 3.1 * U2, "x * y": 7 * U2, "x / y": 2.0**-43 if device.sloppy else 15.1 * U2}
    for second in (y, near):
        got, long_x, long_y = device.evaluate(x, second), x.astype(np.longdouble), second.astype(np.longdouble)
        exact = {"x + y": long_x + long_y, "x - y": long_x - long_y, "x * y": long_x * long_y, "x / y": long_x / long_y}
        for name, bound in bounds.items():
            error = relative(got[name], exact[name])
            print(f"{name}: 2^{np.log2(error):.2f}")
            assert error <= bound, name
        # exact ones, and mix, which is as good as its sum where that does not cancel
        for name, value in (
            ("fmin(x, y)", np.minimum(x, second)),
            ("fmax(x, y)", np.maximum(x, second)),
            ("copysign(x, y)", np.copysign(x, second)),
        ):
            np.testing.assert_array_equal(got[name], value, err_msg=name)
        scale = np.maximum(np.abs(x), np.abs(second))
        assert np.max(np.abs(got["mix(x, y, 0.25)"] - (x + (second - x) * 0.25)) / scale) <= 16 * U2


def test_functions_are_within_their_stated_bound(device):
    positive = np.abs(samples(6, -60, 60))
    positive[:200] = unpack(pack(1 + np.linspace(-1e-3, 1e-3, 200)))
    exponents = unpack(pack(np.random.default_rng(7).uniform(-60, 60, COUNT)))  # beyond -68 the low word fades
    angles = unpack(pack(np.random.default_rng(8).uniform(-7, 7, COUNT)))
    angles[:2000] = unpack(pack(np.random.default_rng(9).uniform(-1e6, 1e6, 2000)))
    angles[2000:2064] = unpack(pack(np.pi / 2 * np.arange(-32, 32)))
    got = device.evaluate(positive)
    errors = {
        "sqrt(x)": relative(got["sqrt(x)"], np.sqrt(positive.astype(np.longdouble))),
        "rsqrt(x)": relative(got["rsqrt(x)"], 1 / np.sqrt(positive.astype(np.longdouble))),
        "log(x)": relative(got["log(x)"], np.log(positive.astype(np.longdouble))),
        "exp(x)": relative(device.evaluate(exponents)["exp(x)"], np.exp(exponents.astype(np.longdouble))),
    }
    got = device.evaluate(angles)
    for name, function in (("sin(x)", np.sin), ("cos(x)", np.cos)):
        errors[name] = float(np.max(np.abs(got[name] - function(angles.astype(np.longdouble)))))
    print({name: f"2^{np.log2(error):.2f}" for name, error in errors.items()})
    assert errors["sqrt(x)"] <= (16 if device.sloppy else 4) * U2
    assert all(error <= device.bound for error in errors.values()), errors


def test_small_arguments_keep_relative_precision(device):
    x = samples(10, -40, -2)
    got = device.evaluate(x)
    assert relative(got["sin(x)"], np.sin(x.astype(np.longdouble))) <= device.bound
    near_one = unpack(pack(1 + np.abs(x)))
    assert relative(device.evaluate(near_one)["log(x)"], np.log(near_one.astype(np.longdouble))) <= device.bound


def test_rounding_to_integers_and_signs_is_exact(device):
    x = np.concatenate([samples(11, -4, 46), np.arange(-300, 300) / 2.0, [2.0**24 - 2.0**-20, 2.0**30 + 0.5, -0.0]])
    x = unpack(pack(np.concatenate([x, np.rint(x) - 2.0**-20])))
    got = device.evaluate(x)
    np.testing.assert_array_equal(got["floor(x)"], np.floor(x))
    np.testing.assert_array_equal(got["trunc(x)"], np.trunc(x))
    np.testing.assert_array_equal(got["fabs(x)"], np.abs(x))
    np.testing.assert_array_equal(got["-x"], -x)


def test_comparisons_see_the_low_word(device):
    x = samples(12, -20, 20)
    for y in (samples(13, -20, 20), x, unpack(pack(x * (1 + 2.0**-40))), np.full(COUNT, np.nan), np.full(COUNT, np.inf)):
        got = device.compare(x, y)
        for name, value in (
            ("x < y", x < y),
            ("x <= y", x <= y),
            ("x > y", x > y),
            ("x >= y", x >= y),
            ("x == y", x == y),
            ("x != y", x != y),
        ):
            np.testing.assert_array_equal(got[name], value, err_msg=name)


def test_infinities_zeros_and_nan_are_those_of_floats(device):
    special = np.array([0.0, -0.0, 1.5, -1.5, np.inf, -np.inf, np.nan, 3e38, -3e38, 1e-38, 100.0, -100.0, 200.0, -200.0])
    x, y = (grid.ravel() for grid in np.meshgrid(special, special))
    got = device.evaluate(x, y)
    with np.errstate(all="ignore"):
        single, other = x.astype(np.float32), y.astype(np.float32)
        exact = {
            "x + y": single + other,
            "x - y": single - other,
            "x * y": single * other,
            "x / y": single / other,
            "fmin(x, y)": np.fmin(single, other),
            "fmax(x, y)": np.fmax(single, other),
            "sqrt(x)": np.sqrt(single),
            "rsqrt(x)": 1 / np.sqrt(single),
            "exp(x)": np.exp(single),
            "log(x)": np.log(single),
            "floor(x)": np.floor(single),
            "fabs(x)": np.abs(single),
        }
    for name, value in exact.items():
        finite = np.isfinite(value)
        np.testing.assert_array_equal(np.isnan(got[name]), np.isnan(value), err_msg=name)
        np.testing.assert_array_equal(got[name][np.isinf(value)], value[np.isinf(value)], err_msg=name)
        assert np.all(np.isfinite(got[name][finite])), name
        np.testing.assert_allclose(got[name][finite], value[finite], rtol=3e-7, atol=2e-38, err_msg=name)
    for name in ("sin(x)", "cos(x)"):
        assert np.all(np.isnan(got[name][~np.isfinite(x)])) and np.all(np.abs(got[name][np.isfinite(x)]) <= 1), name
