"""Declarations: the types that they declare, and their text.

pycparser knows C alone, so ``__global`` is parsed as the qualifier ``_Atomic``, which kernels have no other use for.
"""

from __future__ import annotations

import re
from typing import Any, NoReturn

from pycparser import c_ast

from ...errors import PylmcError
from .preprocessing import Prepared
from .types import FLOAT, INT, UNKNOWN, VOID, Function, Pointer, Struct, Term, Type, number

GLOBAL_AS = "_Atomic"
PREAMBLE = "<preamble>"
_VECTORS = [f"{base}{n}" for base in ("real", "float", "int", "uint", "uchar", "long", "ulong") for n in (2, 3, 4, 8)]
# What the untranslated text declares that kernels use: Random123's Philox, and float_float.cl.
_EXTERNAL = (
    " ".join(f"typedef int {name};" for name in ["real", "bool", "uchar", "ushort", "uint", "ulong", "size_t", *_VECTORS])
    + "typedef struct { uint v[4]; } philox4x32_ctr_t; typedef struct { uint v[2]; } philox4x32_key_t;"
    "philox4x32_ctr_t philox4x32_R(uint rounds, philox4x32_ctr_t counter, philox4x32_key_t key);"
    "real real8_at(const real8 *row, int k);"
)
# The compiler's own macros.
_CONSTANTS = {
    "INFINITY": FLOAT,
    "NAN": FLOAT,
    "FLT_MAX": FLOAT,
    "FLT_MIN": FLOAT,
    "FLT_EPSILON": FLOAT,
    "INT_MAX": INT,
    "true": INT,
    "false": INT,
}


def parse(prepared: Prepared) -> c_ast.FileAST:
    """The syntax tree of the expanded text, after the declarations in ``PREAMBLE``. Raises PylmcError with file and line."""
    from pycparser.c_parser import CParser, ParseError

    text = re.sub(r"\b__global\b", GLOBAL_AS, prepared.expanded)
    start = f'#line 1 "{PREAMBLE}"\n{_EXTERNAL}\n#line 1 "1"\n'
    try:
        return CParser().parse(start + text)
    except ParseError:
        pass
    # Some of its messages give the file and no line, so here every line is a file.
    try:
        return CParser().parse(start + _line_by_line(text))
    except ParseError as error:
        match = re.match(r"(\d+):(?:\d+:\d+:)?(.*)", str(error), re.DOTALL)
        file, line = prepared.place(int(match[1])) if match else ("<text>", 0)
        raise PylmcError(f"{file}:{line}: float-float: not understood: {match[2].strip() if match else error}") from None


def _line_by_line(text: str) -> str:
    out, number = [], 1
    for line in text.splitlines():
        match = re.match(r"#line (\d+)", line)
        if match:
            number = int(match[1])
        else:
            out += [f'#line {number} "{number}"', line]
            number += 1
    return "\n".join(out) + "\n"


class Declarations:
    """Names in scope and what they are."""

    def __init__(self, prepared: Prepared) -> None:
        self.prepared = prepared
        self.types: dict[str, Type] = {}
        self.structs: dict[str, Struct] = {}
        self.scopes: list[dict[str, Type]] = [dict(_CONSTANTS)]

    def fail(self, node: Any, message: str) -> NoReturn:
        """Raise PylmcError at the kernel's file and line."""
        file, line = self.prepared.place(node.coord.line) if node.coord else ("<text>", 0)
        raise PylmcError(f"{file}:{line}: float-float: {message}")

    def look_up(self, name: str) -> Type:
        """The type of a variable or function; UNKNOWN for what is not declared here."""
        return next((scope[name] for scope in reversed(self.scopes) if name in scope), UNKNOWN)

    def type_of(self, node: Any) -> Type:
        """The type that a declarator or type specifier stands for."""
        match node:
            case c_ast.Decl() | c_ast.Typedef() | c_ast.Typename() | c_ast.TypeDecl():
                return self.type_of(node.type)
            case c_ast.IdentifierType():
                name = " ".join(node.names)
                return number(name) or self.types.get(name, VOID if name == "void" else UNKNOWN)
            case c_ast.PtrDecl():
                space = "global" if GLOBAL_AS in getattr(node.type, "quals", ()) else "private"
                return Pointer(self.type_of(node.type), space)
            case c_ast.ArrayDecl():
                return Pointer(self.type_of(node.type), array=True)
            case c_ast.FuncDecl():
                parameters = [self.type_of(p) for p in node.args.params] if node.args else []
                return Function(self.type_of(node.type), tuple(kind for kind in parameters if kind != VOID))
            case c_ast.Struct():
                struct = self.structs.setdefault(node.name, Struct()) if node.name else Struct()
                for member in node.decls or ():
                    struct.members[member.name] = self.type_of(member)
                return struct
        self.fail(node, f"{type(node).__name__} in a declaration is not understood")

    def declaration(self, node: Any, name: str | None = None) -> str:
        """The text that declares ``node``: of a variable, parameter, member, function or type name, without initialiser."""
        prefix = " ".join([*getattr(node, "funcspec", ()), *getattr(node, "storage", ())])
        kind = node.type if isinstance(node, c_ast.Decl | c_ast.Typedef | c_ast.Typename) else node
        if isinstance(kind, c_ast.Struct):
            return self._specifier(kind)
        return f"{prefix} {self._declarator(kind, name if name is not None else node.name or '')}".strip()

    def _declarator(self, node: Any, inner: str) -> str:
        match node:
            case c_ast.PtrDecl():
                quals = "".join(f" {qualifier}" for qualifier in node.quals)
                return self._declarator(node.type, f"*{quals}{' ' if quals else ''}{inner}")
            case c_ast.ArrayDecl() if not inner.startswith("*"):
                dimension = self.expression(node.dim).text if node.dim else ""
                return self._declarator(node.type, f"{inner}[{dimension}]")
            case c_ast.FuncDecl() if not inner.startswith("*"):
                parameters = ", ".join(self.declaration(p) for p in node.args.params) if node.args else "void"
                return self._declarator(node.type, f"{inner}({parameters})")
            case c_ast.TypeDecl():
                names = ["__global" if qualifier == GLOBAL_AS else qualifier for qualifier in node.quals]
                return " ".join([*names, self._specifier(node.type), inner]).rstrip()
        self.fail(node, "a pointer to an array or function is not understood")

    def _specifier(self, node: Any) -> str:
        match node:
            case c_ast.IdentifierType():
                return " ".join(node.names)
            case c_ast.Struct():
                name = f"struct {node.name}" if node.name else "struct"
                if node.decls is None:
                    return name
                members = "".join(f"    {self.declaration(member)};\n" for member in node.decls)
                return f"{name} {{\n{members}}}"
        self.fail(node, f"{type(node).__name__} in a declaration is not understood")

    def expression(self, node: Any) -> Term:
        """See :class:`pylmc.device.float_float.expressions.Expressions`; array dimensions are expressions."""
        raise NotImplementedError
