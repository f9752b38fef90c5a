"""Kernel sources: found as package data, assembled in Python, built with readable errors.

Includes are resolved here because OpenCL's ``-I`` cannot carry paths with blanks, and constants are written as
``#define`` lines because pyopencl's cache and the compilers' own caches key on the source text.
"""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

import numpy as np
import pyopencl as cl

from ..colour import LUMINANCE
from ..errors import PylmcError
from .conditions import check_conditions
from .float_float import translate
from .precision import REALS

_INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
_INCLUDE_LIST = re.compile(r"^\s*#\s*include\s+([A-Z_]+)\s*$")
# "traverse.cl:12:5: error: ..." as clang, Intel and NVIDIA write it, or PoCL's "error: traverse.cl:12:5: ..."
_PLACE = r"([\w./-]+\.(?:cl|h)|<\w+>):(\d+)(?::\d+)?:"
_ERROR = re.compile(rf"{_PLACE} (?:fatal )?error:? (.*)|error: {_PLACE} (.*)")
_WORD = re.compile(r"[A-Za-z_]\w*")
# An unsuffixed floating literal, which the kernels write for numbers of type `real`.
_LITERAL = re.compile(r"(?<![\w.])(\d+\.\d*(?:e[-+]?\d+)?|\d+e[-+]?\d+)(?![\w.])")
# What the compiler may do to arithmetic; "exact" and "native" permit nothing.
MATH_OPTIONS = {
    "relaxed": ("-cl-unsafe-math-optimizations", "-cl-mad-enable", "-cl-no-signed-zeros"),
    "fast": ("-cl-fast-relaxed-math",),
}
_LOG_HEAD = 20  # lines of the compiler's log that an error message quotes


@cache
def _kernel_folder() -> Traversable:
    """Where the .cl files are: in the installed package, else beside the package in a checkout."""
    try:
        folder = resources.files("pylmc.cl_kernels")
        if folder.joinpath("entry").is_dir():
            return folder
    except (ModuleNotFoundError, FileNotFoundError):
        pass
    checkout = Path(__file__).resolve().parents[2] / "cl_kernels"
    if checkout.is_dir():
        return checkout
    raise PylmcError(f"the OpenCL kernels are missing: neither pylmc.cl_kernels nor {checkout} exists; reinstall pylmc")


@cache
def _pyopencl_folder() -> Traversable:
    """pyopencl's own include folder, which holds ``pyopencl-random123/philox.cl``."""
    return resources.files("pyopencl") / "cl"


def _read(folder: Traversable, name: str) -> str | None:
    path = folder
    for part in name.split("/"):  # the folder of an installed package without modules takes one at a time (Python 3.11)
        path = path.joinpath(part)
    return path.read_text(encoding="utf-8") if path.is_file() else None


def _find(name: str, includer: str, bracket: str) -> tuple[str, str] | None:
    """(key, text) of an include, the key being its path below its root; None for what the compiler must judge."""
    parent = includer.rpartition("/")[0]
    candidates = [f"{parent}/{name}"] if parent and bracket == '"' else []
    for key in [*candidates, name]:
        roots = (_pyopencl_folder(),) if key.startswith("pyopencl-") else (_kernel_folder(),)
        for root in roots:
            text = _read(root, key)
            if text is not None:
                return key, text
    return None


def _expand(key: str, text: str, seen: set[str], out: list[str], files: Mapping[str, Sequence[str]]) -> None:
    seen.add(key)
    out.append(f'#line 1 "{key}"')
    for number, line in enumerate(text.splitlines(), start=1):
        listed = _INCLUDE_LIST.match(line)
        if listed:
            for name in files.get(listed[1], ()):
                if name not in seen:
                    _expand(name, _source(name), seen, out, files)
            out.append(f'#line {number + 1} "{key}"')
            continue
        match = _INCLUDE.match(line)
        if match is None:
            out.append(line)
            continue
        bracket, name = match.groups()
        found = _find(name, key, bracket)
        if found is None:
            if bracket == '"':
                raise PylmcError(f'{key}:{number}: #include "{name}" names no kernel source')
            out.append(line)  # a system header behind an #ifdef, as in Random123's C++ part
            continue
        if found[0] in seen:
            out.append("")
            continue
        _expand(*found, seen, out, files)
        out.append(f'#line {number + 1} "{key}"')


def source(name: str, files: Mapping[str, Sequence[str]] | None = None) -> str:
    """The text of kernel source ``name`` (``"entry/raytracer.cl"``) with every include in place, each file once.

    ``#line`` directives keep the original file names and numbers in compiler messages. An include inside an ``#if`` is
    expanded where it first occurs. ``#include WORD`` stands for the ``files`` of that word, or for none. Raises
    PylmcError for a source or a quoted include that does not exist.
    """
    return assembled(name, _source(name), files)


def assembled(name: str, text: str, files: Mapping[str, Sequence[str]] | None = None) -> str:
    """``text``, called ``name`` in compiler messages, with every include in place, as :func:`source` does it."""
    out: list[str] = []
    _expand(name, text, set(), out, files or {})
    return "\n".join(out) + "\n"


def _source(name: str) -> str:
    text = _read(_kernel_folder(), name)
    if text is None:
        raise PylmcError(f"there is no kernel source '{name}' in {_kernel_folder()}")
    return text


def literal(value: object) -> str:
    """``value`` as OpenCL C: bool as 0 or 1, float as a single-precision literal that reads back exactly, str as is."""
    if isinstance(value, bool | np.bool_):
        return str(int(value))
    if isinstance(value, float | np.floating):
        single = np.float32(value)
        if np.isnan(single):
            return "NAN"
        if np.isinf(single):
            return "INFINITY" if single > 0 else "(-INFINITY)"
        return f"({np.format_float_scientific(single, unique=True, trim='0')}f)"
    return "" if value is None else str(value)


def build(
    context: cl.Context,
    main: str,
    *,
    defines: Mapping[str, object],
    files: Mapping[str, Sequence[str]] | None = None,
    structs: Sequence[str] = (),
    real: str | None = None,
    math: str = "exact",
) -> cl.Program:
    """Kernel source ``main`` compiled for the devices of ``context``.

    Those ``defines`` that the source mentions become ``#define`` lines, sorted, with values written by :func:`literal`;
    ``structs`` are C declarations (see :mod:`pylmc.device.structs`) placed before the source. ``real`` is the kernels'
    number type, "float", "double" or "pair" (see :mod:`pylmc.device.precision`), which literals without a suffix become
    as well; None for a source that has no reals. ``math`` is as in :class:`pylmc.settings.Settings`: with ``exact`` and
    ``native`` contraction of ``a * b + c`` is off, and with ``exact`` division and square root are rounded as IEEE 754
    has it where the devices can, so that single precision gives the same bits on all of these. Raises PylmcError with the
    device, the first error's file and line, and the log's head, and for a name in an ``#if`` that nothing defines.
    """
    constants: dict[str, object] = {**defines, "MATH_NATIVE": math == "native", "MATH_CONTRACT": math in MATH_OPTIONS}
    types = ""
    # without a suffix, as the kernels write their numbers: the number type's own rounding applies
    constants |= dict(zip(("LUMINANCE_RED", "LUMINANCE_GREEN", "LUMINANCE_BLUE"), map(repr, LUMINANCE.tolist()), strict=True))
    if real is not None:
        constants |= {f"REAL_{name.upper()}": i for i, name in enumerate(REALS)} | {"REAL": REALS.index(real)}
        types = source("number/float_float.cl" if real == "pair" else "number/real.cl")
    body = source(main, files)
    # a constant that a source does not read must not make it another text: compilers' caches know programs by their text
    read = set(_WORD.findall(types)) | set(_WORD.findall(body))
    for name, value in constants.items():
        if isinstance(value, str) and name.partition("(")[0] in read:
            read |= set(_WORD.findall(value))
    text = "\n".join(
        [
            f"#pragma OPENCL FP_CONTRACT {'ON' if math in MATH_OPTIONS else 'OFF'}",
            '#line 1 "<defines>"',
            *(f"#define {name} {literal(constants[name])}" for name in sorted(constants) if name.partition("(")[0] in read),
            types,
            '#line 1 "<structs>"',
            *(declaration.replace("ulong", "real") if real == "pair" else declaration for declaration in structs),
            body,
        ]
    )
    check_conditions(text)
    if real == "float":
        text = _LITERAL.sub(r"\1f", text)
    elif real == "pair":
        text = translate(text)
    with quiet():
        try:
            return cl.Program(context, text).build(options=[*_options(context, math), *_silence()])
        except cl.Error as error:
            raise PylmcError(_failure(context, main, str(error))) from error


def _options(context: cl.Context, math: str) -> list[str]:
    """What the compiler is told of ``math``."""
    rounds = cl.device_fp_config.CORRECTLY_ROUNDED_DIVIDE_SQRT
    if math == "exact" and all(device.single_fp_config & rounds for device in context.devices):
        return ["-cl-fp32-correctly-rounded-divide-sqrt"]
    return list(MATH_OPTIONS.get(math, ()))


def _silence() -> list[str]:
    """Without warnings, of whose number PoCL tells stderr; PYOPENCL_COMPILER_OUTPUT=1 leaves them in the log that it shows."""
    return [] if os.environ.get("PYOPENCL_COMPILER_OUTPUT") else ["-w"]


@contextmanager
def quiet() -> Iterator[None]:
    """Without pyopencl's hint at a non-empty log, as some compilers report success there.

    PYOPENCL_COMPILER_OUTPUT=1 still shows the log itself.
    """
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Non-empty compiler output")
        yield


def _failure(context: cl.Context, main: str, log: str) -> str:
    devices = ", ".join(device.name.strip() for device in context.devices)
    match = _ERROR.search(log)
    file, line, message = [group for group in match.groups() if group] if match else ("", "", "")
    where = f"{file}:{line}: {message}" if file else "the log names no line"
    log = log[max(log.find("Build on"), 0) :]  # pyopencl says first, and thrice, that the build failed
    head = "\n".join(log.strip().splitlines()[:_LOG_HEAD])
    return f"{main} does not build on {devices}: {where}\n{head}"
