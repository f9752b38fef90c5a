"""Calls of OpenCL's own functions: with reals among the arguments, those of float_float.cl; else as they are."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import reduce

from .types import INT, REAL, UNKNOWN, VOID, Number, Pointer, Term, Type, common, is_real, number

Convert = Callable[[Term, Type], Term]

# Functions of reals by components, with how many arguments, and what they are called in float_float.cl.
ELEMENTWISE = {
    "fabs": 1,
    "floor": 1,
    "trunc": 1,
    "sqrt": 1,
    "rsqrt": 1,
    "fmin": 2,
    "fmax": 2,
    "min": 2,
    "max": 2,
    "copysign": 2,
    "clamp": 3,
    "mix": 3,
}
NAMES = {"min": "fmin", "max": "fmax"}
SCALAR = {"exp": REAL, "log": REAL, "sin": REAL, "cos": REAL, "isnan": INT, "isinf": INT, "isfinite": INT}
GEOMETRIC = {"dot": (2, 3), "length": (3,), "distance": (3,), "normalize": (3,), "cross": (3,)}  # and for which widths
# Of floats and ints: those whose results are of their arguments' type, and those that say something of them.
SAME_TYPE = {*ELEMENTWISE, "abs", "ceil", "rint", "round", "exp", "log", "sin", "cos", "fma", "normalize", "cross", "step"}
RELATIONAL = {"isnan", "isinf", "isfinite", "isequal", "isless", "isgreater", "signbit"}
_MEMORY = re.compile(r"(vload|vstore)(2|3)")
_CONVERT = re.compile(r"convert_(\w+?)(_rt[ezpn])?")


def prefix(width: int) -> str:
    """What the names of float_float.cl's functions on that many reals begin with."""
    return "ff" if width == 1 else f"ff{width}"


def call_with_reals(name: str, arguments: Sequence[Term], convert: Convert) -> Term | None:
    """The call of built-in ``name``, of which an argument or the result is real; None if there is no such function."""
    match = _CONVERT.fullmatch(name)
    if match and len(arguments) == 1:
        return convert_vector(arguments[0], number(match[1]))
    match = _MEMORY.fullmatch(name)
    if match:
        return _memory(match[1], int(match[2]), arguments, convert)
    kind = reduce(common, (argument.type for argument in arguments))
    if not isinstance(kind, Number):
        return None
    if ELEMENTWISE.get(name) == len(arguments):
        text = ", ".join(convert(argument, kind).text for argument in arguments)
        return Term(f"{prefix(kind.width)}_{NAMES.get(name, name)}({text})", kind)
    if name in SCALAR and len(arguments) == 1 and kind.width == 1:
        return Term(f"ff_{name}({arguments[0].text})", SCALAR[name])
    if kind.width in GEOMETRIC.get(name, ()):
        text = ", ".join(convert(argument, kind).text for argument in arguments)
        return Term(f"{prefix(kind.width)}_{name}({text})", kind if name in ("normalize", "cross") else REAL)
    return None


def convert_vector(term: Term, kind: Number | None) -> Term | None:
    """``convert_<kind>(term)`` where either is real; None where float_float.cl has no such conversion."""
    if kind is None or not isinstance(term.type, Number) or kind.width != term.type.width:
        return None
    if kind == term.type:
        return term
    to, of, name = kind.base, term.type.base, prefix(kind.width)
    if to == "real" and (of in ("float", "int") or (of == "uint" and kind.width == 1)):
        return Term(f"{name}_from_{of}({term.text})", kind)
    if to == "real" and of in ("bool", "char", "uchar", "short", "ushort") and kind.width == 1:
        return Term(f"{name}_from_int({term.text})", kind)
    if of == "real" and to == "float":
        return term.within(f"{term.operand}.hi", kind)
    if of == "real" and (to == "int" or (to == "uint" and kind.width == 1)):
        return Term(f"{name}_to_{to}({term.text})", kind)
    return None


def _memory(name: str, width: int, arguments: Sequence[Term], convert: Convert) -> Term | None:
    pointer = arguments[-1].type
    if not isinstance(pointer, Pointer) or pointer.to != REAL or pointer.space not in ("global", "private"):
        return None
    kind = Number("real", width)
    if name == "vstore":
        arguments = [convert(arguments[0], kind), *arguments[1:]]
    text = ", ".join(argument.text for argument in arguments)
    return Term(f"{prefix(width)}_{name}_{pointer.space}({text})", kind if name == "vload" else VOID)


def involves_reals(name: str, arguments: Sequence[Term]) -> bool:
    """Whether the call of built-in ``name`` takes or gives reals, be it through a pointer."""
    kinds = [argument.type for argument in arguments]
    targets = [kind.to for kind in kinds if isinstance(kind, Pointer) and _MEMORY.fullmatch(name)]
    return any(is_real(kind) for kind in [*kinds, *targets]) or name.startswith("convert_real")


def native_result(name: str, arguments: Sequence[Term]) -> Type:
    """The type of a call of built-in ``name`` without reals, as far as it matters."""
    match = _CONVERT.fullmatch(name)
    if match:
        return number(match[1]) or UNKNOWN
    if name.startswith("get_"):
        return Number("ulong")
    pointers = [argument.type.to for argument in arguments if isinstance(argument.type, Pointer)]
    if name.startswith("atomic_") and pointers:
        return pointers[0]
    match = _MEMORY.fullmatch(name)
    if match:
        return Number(pointers[0].base, int(match[2])) if pointers and isinstance(pointers[0], Number) else UNKNOWN
    kinds = [argument.type for argument in arguments]
    kind = reduce(common, kinds) if kinds else UNKNOWN
    if not isinstance(kind, Number):
        return UNKNOWN
    if name in ("any", "all"):
        return INT
    if name in RELATIONAL:
        return Number("int", kind.width)
    if name in ("dot", "length", "distance"):
        return Number(kind.base)
    return kind if name in SAME_TYPE else UNKNOWN
