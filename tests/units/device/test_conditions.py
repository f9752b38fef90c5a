"""A name in an #if that nothing defines is an error with its place, and not a silent 0."""

from __future__ import annotations

import pyopencl as cl
import pytest

from pylmc.device import program
from pylmc.device.conditions import check_conditions
from pylmc.device.survey import select
from pylmc.errors import PylmcError

GOOD = [
    "#define A 1\n#if A && !(A > 0x1f)\n#endif",
    "#if defined(A) && A > 1\n#elif defined B || B\n#endif",
    "#ifdef A\n#if A\n#endif\n#endif",
    "#ifndef A\n#define A 2\n#endif\n#if A\n#endif",
    "#if defined( A )\n#if A == 1\n#endif\n#endif",
    "#define A B\n#define B 3ul\n#if A\n#endif",
    "#define A A\n#if A // of no use: C\n#endif",
    "#define F(x) (x + y)\n#if F(1)\n#endif",
    "#define A 1\n# if A && \\\n  /* C */ A\n# endif",
    "// #if C\n/* the rest\n#if C\n*/",
    "#if __OPENCL_VERSION__ >= 120\n#endif",
    '#line 1 "pyopencl-random123/philox.cl"\n#if C\n#endif',
]
BAD = [
    "#if C\n#endif",
    "#define A 1\n#if A\n#elif A + C\n#endif",
    "#if C\n#endif\n#define C 1",
    "#define C 1\n#undef C\n#if C\n#endif",
    "#ifdef C\n#endif\n#if C\n#endif",
    "#define A (C + 1)\n#if A\n#endif",
    "#define A 1\n#if A && \\\n  C\n#endif",
]


@pytest.mark.parametrize("text", GOOD)
def test_names_that_are_defined_or_asked_for_pass(text: str) -> None:
    check_conditions(text)


@pytest.mark.parametrize("text", BAD)
def test_a_name_that_nothing_defines_is_an_error(text: str) -> None:
    with pytest.raises(PylmcError, match=r"reads C, .* defined\(C\)"):
        check_conditions(text)


def test_the_error_names_the_place(tmp_path, monkeypatch) -> None:
    """A kernel with a typing error in its condition does not build."""
    monkeypatch.setattr(program, "_kernel_folder", lambda: tmp_path)
    (tmp_path / "a.cl").write_text(
        'int first;\n#include "b.cl"\n\n#if HAS_POINT\n#endif\n__kernel void f(__global int *x) {}\n'
    )
    (tmp_path / "b.cl").write_text("#if HAS_POINTS /* two\nlines */\n#endif\n")
    context = cl.Context([select(None)])
    with pytest.raises(PylmcError, match=r"^a\.cl:4: #if reads HAS_POINT,"):
        program.build(context, "a.cl", defines={"HAS_POINTS": True})
    with pytest.raises(PylmcError, match=r"^b\.cl:1: #if reads HAS_POINTS,"):
        program.build(context, "a.cl", defines={"HAS_POINT": True})
