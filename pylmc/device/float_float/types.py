"""Types of kernel expressions, as far as the translation has to know them."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace

# Rising: of two operands, C converts one to the type of the other that stands further to the right.
RANKS = ("bool", "char", "uchar", "short", "ushort", "int", "uint", "long", "ulong", "float", "real")
SYNONYMS = {"unsigned": "uint", "unsigned int": "uint", "unsigned long": "ulong", "size_t": "ulong"}
REAL_WIDTHS = (1, 2, 3, 8)  # those that float_float.cl has
_NUMBER = re.compile(rf"({'|'.join(RANKS)})(2|3|4|8|16)?")


@dataclass(frozen=True)
class Number:
    """A scalar (width 1) or an OpenCL vector."""

    base: str
    width: int = 1

    def __str__(self) -> str:
        return self.base if self.width == 1 else f"{self.base}{self.width}"


@dataclass(frozen=True)
class Pointer:
    """A pointer, or an array, and the address space of what it points to."""

    to: Type
    space: str = "private"
    array: bool = False


@dataclass(eq=False)
class Struct:
    """A struct and its members' types."""

    members: dict[str, Type] = field(default_factory=dict)


@dataclass(frozen=True)
class Function:
    """A function of the kernels' own."""

    result: Type
    parameters: tuple[Type, ...]


@dataclass(frozen=True)
class Other:
    """void, and whatever the translation does not know: that passes through, and must not meet a real."""

    name: str


Type = Number | Pointer | Struct | Function | Other
VOID, UNKNOWN = Other("void"), Other("unknown")
INT, FLOAT, REAL = Number("int"), Number("float"), Number("real")


@dataclass(frozen=True)
class Term:
    """A translated expression."""

    text: str
    type: Type
    primary: bool = True  # needs no parentheses beside an operator
    pure: bool = False  # may be evaluated twice
    space: str = "private"  # where it lies, if it has an address
    literal: str = ""  # the digits, if it is a literal

    @property
    def operand(self) -> str:
        """The text as it may stand beside any operator."""
        return self.text if self.primary else f"({self.text})"

    def within(self, text: str, kind: Type, **changes: bool) -> Term:
        """The term for a part of this one: as pure, and in the same address space, which its arrays are in as well."""
        if isinstance(kind, Pointer) and kind.array:
            kind = replace(kind, space=self.space)
        return Term(text, kind, pure=changes.get("pure", self.pure), space=self.space)


def number(name: str) -> Number | None:
    """The scalar or vector type of that name, or None."""
    match = _NUMBER.fullmatch(SYNONYMS.get(name, name))
    return Number(match[1], int(match[2] or 1)) if match else None


def is_real(kind: Type) -> bool:
    """Whether this is a real number or a vector of them."""
    return isinstance(kind, Number) and kind.base == "real"


def is_vector(kind: Type) -> bool:
    """Whether this is an OpenCL vector."""
    return isinstance(kind, Number) and kind.width > 1


def common(a: Type, b: Type) -> Type:
    """The type of ``a + b``."""
    if isinstance(a, Pointer) or isinstance(b, Pointer):
        return a if isinstance(a, Pointer) else b
    if not (isinstance(a, Number) and isinstance(b, Number)):
        return UNKNOWN
    if a.width != b.width:
        wide = a if a.width > b.width else b
        return Number("real", wide.width) if is_real(a) or is_real(b) else wide
    base = max(a.base, b.base, "int" if a.width == 1 else a.base, key=RANKS.index)
    return Number(base, a.width)
