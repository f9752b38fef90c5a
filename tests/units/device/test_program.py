"""Assembling kernel sources, structs shared with the device, and what a failed build says."""

from __future__ import annotations

import uuid
import warnings
from pathlib import Path

import numpy as np
import pyopencl as cl
import pytest

from pylmc.device import program, structs
from pylmc.device.survey import select
from pylmc.errors import PylmcError


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A kernel folder, with a blank in its path, in place of pylmc's own."""
    path = tmp_path / "two words"
    path.mkdir()
    monkeypatch.setattr(program, "_kernel_folder", lambda: path)
    return path


@pytest.fixture(scope="module")
def context():
    return cl.Context([select(None)])


def test_includes_are_resolved_once_with_lines(folder):
    (folder / "a.cl").write_text('int before;\n#include "b.cl"\n  #  include "c.cl" // again\nint after;\n')
    (folder / "b.cl").write_text('#include "c.cl"\nint b;\n')
    (folder / "c.cl").write_text("int c;\n")
    lines = program.source("a.cl").splitlines()
    assert [line for line in lines if line.startswith("int")] == ["int before;", "int c;", "int b;", "int after;"]
    assert lines[-3:] == ['#line 3 "a.cl"', "", "int after;"]  # the repeated include leaves its line empty


def test_random123_is_resolved_without_include_paths(folder, context):
    (folder / "a.cl").write_text(
        "#include <pyopencl-random123/philox.cl>\n#include <pyopencl-random123/philox.cl>\n"
        "__kernel void known_answer(__global uint4 *out) {\n"
        "    const philox4x32_ctr_t counter = {{0, 0, 0, 0}};\n    const philox4x32_key_t key = {{0, 0}};\n"
        "    const philox4x32_ctr_t r = philox4x32(counter, key);\n"
        "    *out = (uint4)(r.v[0], r.v[1], r.v[2], r.v[3]);\n}\n"
    )
    built = program.build(context, "a.cl", defines={})
    queue, out = cl.CommandQueue(context), np.zeros(4, np.uint32)
    buffer = cl.Buffer(context, cl.mem_flags.WRITE_ONLY, out.nbytes)
    built.known_answer(queue, (1,), None, buffer)
    cl.enqueue_copy(queue, out, buffer)
    assert [f"{word:08x}" for word in out] == ["6627e8d5", "e169c58d", "bc57ac4c", "9b00dbd8"]


def test_missing_sources_are_named(folder):
    (folder / "a.cl").write_text('\n#include "absent.cl"\n')
    with pytest.raises(PylmcError, match=r'a\.cl:2: #include "absent\.cl"'):
        program.source("a.cl")
    with pytest.raises(PylmcError, match=r"no kernel source 'b\.cl'"):
        program.source("b.cl")


def test_a_failed_build_names_device_file_and_line(folder, context):
    (folder / "a.cl").write_text('#include "b.cl"\n__kernel void f(__global int *x) { *x = g(); }\n')
    (folder / "b.cl").write_text("int g(void) {\n    return\n        undeclared_thing;\n}\n")
    with pytest.raises(PylmcError) as caught:
        program.build(context, "a.cl", defines={"K": 3})
    first = str(caught.value).splitlines()[0]
    assert context.devices[0].name.strip() in first
    assert "b.cl:3: " in first and "undeclared_thing" in first


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (True, "1"),
        (7, "7"),
        (np.int32(-3), "-3"),
        ("chart_a", "chart_a"),
        (None, ""),
        (np.inf, "INFINITY"),
        (0.1, "(1.0e-01f)"),
        (1.0, "(1.0e+00f)"),
        (np.nan, "NAN"),
    ],
)
def test_literals(value, text):
    assert program.literal(value) == text


def test_a_compiler_that_warns_is_not_heard(folder, context, capfd):
    unseen = uuid.uuid4().hex  # by the compilers' caches
    (folder / "a.cl").write_text(f'#warning "{unseen}"\n__kernel void f(__global char *x) {{ *x = 1000; }}\n')
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        program.build(context, "a.cl", defines={})
    assert capfd.readouterr() == ("", "")


def test_float_defines_arrive_exactly(folder, context):
    values = np.float32([0.1, 1 / 3, -1e-30, 3e38, 16777217, -np.inf])
    defines = {f"V{i}": value for i, value in enumerate(values)}
    body = " ".join(f"out[{i}] = V{i};" for i in range(len(values)))
    (folder / "a.cl").write_text(f"__kernel void f(__global float *out) {{ {body} }}\n")
    queue, out = cl.CommandQueue(context), np.zeros_like(values)
    buffer = cl.Buffer(context, cl.mem_flags.WRITE_ONLY, out.nbytes)
    program.build(context, "a.cl", defines=defines).f(queue, (1,), None, buffer)
    cl.enqueue_copy(queue, out, buffer)
    np.testing.assert_array_equal(out, values)


def test_structs_agree_with_the_device(folder, context):
    device = context.devices[0]
    float3 = cl.cltypes.float3
    fields = np.dtype([("tag", np.int8), ("point", float3), ("weights", np.float32, (3,)), ("big", np.int64)])
    dtype, declaration = structs.declare(device, "TestRecord", fields)
    again, _ = structs.declare(device, "TestRecord", fields)
    assert again == dtype
    (folder / "a.cl").write_text(
        "__kernel void f(__global TestRecord *r) {\n"
        "    r->tag += 1; r->point.z *= 2.0f; r->weights[2] += 1.0f; r->big -= 1;\n}\n"
    )
    record = np.zeros(1, dtype)
    record["tag"], record["weights"], record["big"] = 4, 0.5, 1 << 40
    record["point"]["z"] = 3
    flags = cl.mem_flags.READ_WRITE | cl.mem_flags.COPY_HOST_PTR
    buffer, queue = cl.Buffer(context, flags, hostbuf=record), cl.CommandQueue(context)
    program.build(context, "a.cl", defines={}, structs=[declaration]).f(queue, (1,), None, buffer)
    cl.enqueue_copy(queue, record, buffer)
    assert record["tag"][0] == 5 and record["point"]["z"][0] == 6 and record["big"][0] == (1 << 40) - 1
    np.testing.assert_array_equal(record["weights"][0], np.float32([0.5, 0.5, 1.5]))


def test_structs_may_nest_and_change(context):
    device = context.devices[0]
    inner, _ = structs.declare(device, "TestNode", np.dtype([("x", np.float32), ("i", np.int32)]))
    outer, declaration = structs.declare(device, "TestPath", np.dtype([("nodes", inner, (4,)), ("n", np.int32)]))
    assert outer.itemsize == 36 and "TestNode nodes[4]" in declaration
    longer, _ = structs.declare(device, "TestPath", np.dtype([("nodes", inner, (5,)), ("n", np.int32)]))
    assert longer.itemsize == 44
    with pytest.raises(PylmcError, match="struct 'TestBad'"):
        structs.declare(device, "TestBad", np.dtype([("text", "U4")]))


def test_every_shipped_source_resolves():
    folder = Path(str(program._kernel_folder()))
    names = [str(path.relative_to(folder)) for path in folder.glob("**/*.cl")]
    assert "entry/raytracer.cl" in names
    for name in names:
        assert f'#line 1 "{name}"' in program.source(name)
