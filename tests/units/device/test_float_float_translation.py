"""Translating kernels from ``real`` to pairs of floats: what constructs mean, what is refused, and what is left of fp64."""

from __future__ import annotations

import io
import re
import shutil
import subprocess
from unittest.mock import patch

import numpy as np
import pcpp
import pyopencl as cl
import pytest

from pylmc.device import program
from pylmc.device.device_scene import DeviceScene
from pylmc.device.float_float import translate
from pylmc.device.float_float.expressions import pair
from pylmc.device.precision import Precision
from pylmc.device.survey import context_and_queue, select
from pylmc.errors import PylmcError
from pylmc.sampling.compiled import compile_scene
from pylmc.scene.loading import load
from pylmc.settings import Settings

SLOTS = 64

# Everything that the kernels do with reals, and then some; each value lands in a slot of its own.
DIALECT = r"""
#define TWICE(x) (2 * (x))
#define KERNEL __kernel __attribute__((vec_type_hint(float8)))
#ifdef UNUSED
this is no C
#endif
typedef struct { real3 x; real t; int count; } Node;
typedef struct { Node nodes[2]; __global const real *values; uint rays; } Bundle;
typedef struct { real8 a, b; } Pair;

real square(real x) { return x * x; }
real3 flipped(real3 v, bool flip) { return flip ? -v : v; }
bool halve(real *x, real3 *v) {
    *x /= 2;
    *v *= 0.5;
    v->z = *x + 1;
    return *x > 0.0;
}
real switched(int kind, real x) {
    switch (kind) {
        case 1:
            return 2 * x;
        case 2:
            x += 0.5;
            break;
        default:
            x = -x;
    }
    return x - 1;
}
void put(__global real *out, int *slot, real value) { out[(*slot)++] = value; }
void put3(__global real *out, int *slot, real3 v) {
    vstore3(v, 0, out + *slot);
    *slot += 3;
}

KERNEL
void evaluate(__global const real *in, __global const float *floats, int three, __global real *out) {
    int slot = 0;
    Bundle bundle = {{{(real3)(in[0], in[1], in[2]), in[3], three}, {(real3)(1.0), 0.1, 4}}, in, 7u};
    Bundle *at = &bundle;
    __global const real *tail = in + 4;
    real a = in[0], b = tail[0], unset;
    real3 v = at->nodes[0].x, w = vload3(1, in);
    // arithmetic, precedence, mixed with int, float, literals
    put(out, &slot, a - b * v.x + 2 * a / 3 - (1 - a) * -b);
    put(out, &slot, TWICE(a + three) - 1 + .5 + 1e-3);
    put(out, &slot, floats[0] * a + floats[1]);
    put(out, &slot, 0.1 + 0.2 * (real)three + (real)at->rays);
    put3(out, &slot, v * w - a * v / b + 0.25);
    put3(out, &slot, 1.0 - v + (real3)(three, floats[0], a));
    // assignments, compound ones, components, chains
    unset = a += b;
    put(out, &slot, unset);
    v.x = a;
    v.y += 2;
    at->nodes[1].x.z *= b;
    at->nodes[1].x -= v;
    at->nodes[three - 2].t -= three;
    put3(out, &slot, v);
    put3(out, &slot, bundle.nodes[1].x);
    put(out, &slot, at->nodes[1].t);
    real list[3] = {a, 1, floats[2]}, more[2];
    for (int i = 0; i < 2; i++) more[i] = list[i + 1] * i;
    for (real step = 0.5, end = 2; step < end; step += step) more[0] += step;
    put(out, &slot, more[0] + more[1]);
    put(out, &slot, halve(&list[0], &v) ? list[0] + v.z : -1);
    put3(out, &slot, v);
    // conditions
    if (!(a >= b) && a != 0 || three == 4) put(out, &slot, 1);
    else put(out, &slot, 2.5);
    put(out, &slot, a < b ? 1 : b);
    put3(out, &slot, three > 2 ? w : (real3)(0.0));
    put3(out, &slot, flipped(w, true));
    // conversions
    put(out, &slot, (int)(a * 100) + (int)-2.75 + (uint)(b * b + 3.5));
    put(out, &slot, (float)a > 0.0f ? (float)w.y : 0.0f);
    float single = b, other = 0.125;
    put(out, &slot, single * 3 + other);
    int whole = 2.75 + three;
    put(out, &slot, whole);
    int2 cells = convert_int2((real2)(3.75, -1.25));
    put(out, &slot, cells.x + 10 * cells.y);
    put(out, &slot, convert_real2(cells).y);
    real8 lanes = convert_real8(-((int8)(0, 1, 2, 3, 4, 5, 6, 7) + 3 == (int8)(5)));
    Pair both = {lanes * a, lanes + a};
    both.b -= 3 * both.a;
    put(out, &slot, real8_at(&both.a, 2) + real8_at(&both.b, 2) * real8_at(&both.b, 7));
    // functions
    put(out, &slot, square(a) + sqrt(fmax(b, 0.0)) - rsqrt(4.0) + fabs(-a) + copysign(1.0, -b));
    put(out, &slot, dot(v, w) + length(v) + distance(v, w) + mix(a, b, 0.25) + clamp(a, 0.0, 0.5) + min(a, b) + max(a, b));
    put3(out, &slot, cross(v, normalize(w)) + mix(v, w, a) + floor(10 * w));
    put(out, &slot, log(2 + a) * exp(-b) + sin(a) * cos(b));
    put(out, &slot, isfinite(a / 0.0) + 2 * isnan(NAN) + 4 * isinf(log(0 * a)) + (a > -INFINITY));
    put(out, &slot, max(three, 2) + clamp(three, 0, 1));
    for (int i = 1; i < 4; i++) put(out, &slot, switched(i, a));
}
"""


def run(real: str, values: np.ndarray) -> np.ndarray:
    """The slots that the kernel fills with reals of that type, as float64."""
    precision = Precision("test", real)
    context, queue = context_and_queue(select(None))
    original = program.source
    sources = {"dialect.cl": f'#line 1 "dialect.cl"\n{DIALECT}'}
    with patch.object(program, "source", lambda name, files=None: sources.get(name) or original(name, files)):
        built = program.build(context, "dialect.cl", defines={}, real=real)
    flags = cl.mem_flags.READ_WRITE | cl.mem_flags.COPY_HOST_PTR
    floats = np.float32([0.7, -1.3, 2.2])
    out = precision.to_device(np.full(SLOTS, np.nan))
    buffers = [cl.Buffer(context, flags, hostbuf=array) for array in (precision.to_device(values), floats, out)]
    cl.Kernel(built, "evaluate")(queue, (1,), None, buffers[0], buffers[1], np.int32(3), buffers[2])
    cl.enqueue_copy(queue, out, buffers[2])
    return precision.to_host(out)


def test_the_dialect_means_the_same_in_pairs_as_in_double():
    if "cl_khr_fp64" not in select(None).extensions:
        pytest.skip("nothing to compare with: the device has no fp64")
    for seed in range(4):
        values = np.random.default_rng(seed).uniform(-1, 1, 8)
        values[0] += 2
        double, pairs = run("double", values), run("pair", values)
        filled = ~np.isnan(double)
        np.testing.assert_array_equal(~np.isnan(pairs), filled)
        assert 45 < filled.sum() < SLOTS
        # a few operations each, none of which loses more than two digits
        np.testing.assert_allclose(pairs[filled], double[filled], rtol=2.0**-40, atol=2.0**-40)


REFUSED = {
    "real f(real x) { return x % 2; }": "'%' is not understood",
    "real f(real x) { return x & 1; }": "'&' is not understood",
    "real f(real x) { if (x) return 1; return 0; }": "a real is no condition",
    "int f(real x) { return !x; }": "'!' of a real",
    "real f(real x) { x++; return x; }": r"'\+\+' of a real",
    "real f(real x) { return pow(x, 2.0); }": r"float_float.cl has no pow\(real, real\)",
    "real3 f(real3 v) { return exp(v); }": r"float_float.cl has no exp\(real3\)",
    "real2 f(real3 v) { return v.xy; }": "'.xy' of real3",
    "real f(real8 v) { return v.s0; }": "'.s0' of real8",
    "real *f(real3 *v) { return &v->x; }": "a component of a vector has no address",
    "real f(real3 a, real3 b) { return a < b; }": "'<' is not understood between real3",
    "real3 f(real2 a) { return (real3)(a, 1.0); }": "as many scalars",
    "real f(real3 a) { return a; }": "no conversion from real3 to real",
    "real f(real x) { return x + mystery; }": "mystery: a real meets",
    "real f(real x) { return mystery * x; }": "mystery: a real meets",
    "real f(real x) { return unknown(1) + x; }": r"unknown\(1\): a real meets",
    "real f(real x) { return f(x, x); }": r"f takes 1 argument\(s\), not 2",
    "real g(void); void f(real *x) { x[(int)g()] += 1; }": "without side effects",
    "real f(int i) { if (i) goto end; end: return 0; }": "goto is not understood",
    "real f(real x) { return x +; }": "not understood",
    "#if 1 +\nreal f(void);\n#endif": "Could not evaluate",
    "#error no such thing\n": "no such thing",
}


def test_compiler_options_that_would_undo_pairs_are_refused():
    with pytest.raises(PylmcError, match="math='relaxed' would let the compiler"):
        DeviceScene(compile_scene(load("box"), "float-float"), Settings(math="relaxed"), precision="float-float")


@pytest.mark.parametrize("text", REFUSED)
def test_what_is_not_understood_is_named_with_its_place(text):
    with pytest.raises(PylmcError, match=rf"^b\.cl:1[123]: .*{REFUSED[text]}"):
        translate(f'#line 1 "a.cl"\nint before;\n#line 11 "b.cl"\n{text}\n')


def test_compilers_name_the_kernels_lines_too():
    """Statements keep their places, also behind macros, includes and comments."""
    text = translate('#line 1 "a.cl"\n#define N 3\n/* two\nlines */\nreal f(real x) {\n\n    return x * N;\n}\n')
    where = re.search(r'#line (\d+) "a\.cl"\nreturn', text)
    assert where and int(where[1]) == 6


@pytest.mark.parametrize(
    "digits", ["0.1", "1.0", "3.141592653589793", "1e-30", "16777217.0", "2.220446049250313e-16", "1e39", ".5"]
)
def test_literals_are_split_exactly(digits):
    hi, lo = (np.float32(part.rstrip("f").replace("INFINITY", "inf")) for part in pair(digits))
    value = float(digits)
    if np.isinf(hi):
        assert value > float(np.finfo(np.float32).max) and lo == 0
    else:
        assert hi == np.float32(value) and lo == np.float32(value - float(hi))


def translated(source: str, scene: str, **settings: object) -> str:
    """The text that would be compiled of a kernel source for a built-in scene."""
    caught: list[str] = []

    class Caught(Exception):
        pass

    def catch(text: str) -> str:
        caught.append(translate(text))
        raise Caught

    device = DeviceScene(compile_scene(load(scene), "float-float"), Settings(**settings), precision="float-float")
    with patch.object(program, "translate", catch), pytest.raises(Caught):
        device.kernel(source, "any")
    return caught[0]


def fp64_left(text: str) -> list[str]:
    """Tokens that a device without fp64 could not compile, after preprocessing as there."""
    preprocessor = pcpp.Preprocessor()
    preprocessor.parse(text)
    out = io.StringIO()
    preprocessor.write(out)
    code = re.sub(r"^\s*#.*$", "", out.getvalue(), flags=re.MULTILINE)
    numbers = [n for n in re.findall(r"(?<![\w.])(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?\w*", code) if re.search(r"[.eE]", n)]
    wrong = [n for n in numbers if not n.endswith("f") and not n.startswith("0x")]
    return wrong + re.findall(r"\bdouble\w*", code)


def test_the_search_for_fp64_finds_it():
    assert fp64_left("double2 x = 1.0 + .5 + 1e3 + 2.5f + 0x1e3 + 10;") == ["1.0", ".5", "1e3", "double2"]


SOURCES = ("entry/chains.cl", "entry/bootstrap.cl", "entry/bdpt.cl", "entry/path_tracer.cl", "entry/inspect.cl")


@pytest.mark.parametrize(
    ("source", "scene", "settings"),
    [
        *((source, "caustic", {}) for source in SOURCES),
        ("entry/inspect.cl", "keyhole", {"drift": True, "chart": "orthographic", "rule": "rms"}),
        ("entry/chains.cl", "glints", {"coordinates": "deviation", "projection": "orthographic", "aim": "light"}),
        ("entry/chains.cl", "box", {"drift": True, "differentials": "reduced"}),
    ],
)
def test_kernels_translate_and_hold_no_fp64(source, scene, settings):
    """Without this a device that has no fp64 could not compile them."""
    text = translated(source, scene, **settings)
    assert "ff3_add(" in text and fp64_left(text) == []
    clang = next((path for name in ("clang", *(f"clang-{n}" for n in range(25, 12, -1))) if (path := shutil.which(name))), None)
    if clang:  # a compiler for a device without a single extension
        command = [clang, "-x", "cl", "-cl-std=CL1.2", "-target", "spir64", "-fsyntax-only", "-Werror=double-promotion"]
        command += [part for option in ("-finclude-default-header", "-cl-ext=-all") for part in ("-Xclang", option)]
        result = subprocess.run([*command, "-"], input=text, capture_output=True, text=True)
        assert result.returncode == 0 and "fp64" not in result.stderr, result.stderr
