"""Expressions: every operation on reals becomes a call, every conversion to or from a real is written out."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from pycparser import c_ast

from .declarations import Declarations
from .functions import call_with_reals, convert_vector, involves_reals, native_result, prefix
from .packing import split
from .types import (
    FLOAT,
    INT,
    REAL,
    REAL_WIDTHS,
    UNKNOWN,
    VOID,
    Function,
    Number,
    Pointer,
    Struct,
    Term,
    Type,
    common,
    is_real,
    is_vector,
)

ARITHMETIC = {"+": "add", "-": "sub", "*": "mul", "/": "div"}
COMPARISONS = {"<": "lt", ">": "gt", "<=": "le", ">=": "ge", "==": "eq", "!=": "ne"}
_COMPONENTS = {2: "xy", 3: "xyz"}


def float_literal(value: Any) -> str:
    """``value`` in OpenCL C, exactly."""
    return f"{np.format_float_scientific(value, unique=True, trim='0')}f"


def pair(digits: str) -> tuple[str, str]:
    """The literals (hi, lo) of the float64 that ``digits`` stand for where a real is a double.

    >>> pair("0.1")
    ('1.0e-01f', '-1.4901161e-09f')
    """
    hi, lo = split(float(digits))
    return float_literal(hi) if np.isfinite(hi) else "INFINITY", float_literal(lo)


class Expressions(Declarations):
    """Translates expressions."""

    def expression(self, node: Any) -> Term:
        """The translated expression with its type. Raises PylmcError for what is not understood."""
        method: Callable[[Any], Term] | None = getattr(self, f"_{type(node).__name__}", None)
        if method is None:
            self.fail(node, f"{type(node).__name__} in an expression is not understood")
        return method(node)

    def condition(self, node: Any) -> str:
        """The text of something that is true or false."""
        term = self.expression(node)
        if is_real(term.type):
            self.fail(node, "a real is no condition: compare it with 0.0")
        return term.text

    def convert(self, node: Any, term: Term, kind: Type) -> Term:
        """``term`` as C converts it to ``kind``, to which it is assigned, passed, added ..."""
        if not (is_real(kind) or is_real(term.type)) or term.type == kind:
            return term
        if not isinstance(kind, Number) or not isinstance(term.type, Number):
            self.fail(node, f"{term.text}: a real meets what is no number, or what is not declared here")
        if term.literal:
            if is_real(kind):
                scalar = Term(f"ff_make({', '.join(pair(term.literal))})", REAL, literal=term.literal)
            elif kind == FLOAT:
                scalar = Term(float_literal(np.float32(term.literal)), FLOAT)
            else:
                scalar = Term(f"({kind}){float_literal(np.float32(term.literal))}", kind, primary=False)
        else:
            converted = convert_vector(term, Number(kind.base, term.type.width))
            if converted is None or term.type.width not in (1, kind.width):
                self.fail(node, f"there is no conversion from {term.type} to {kind}")
            scalar = converted
        if kind.width == term.type.width or not is_real(kind):  # the compiler widens what is not real
            return scalar
        return Term(f"{prefix(kind.width)}_splat({scalar.text})", kind)

    def binary(self, node: Any, op: str, left: Term, right: Term) -> Term:
        """``left op right``."""
        kind = common(left.type, right.type)
        if not (is_real(left.type) or is_real(right.type)):
            text = f"{left.operand} {op} {right.operand}"
            if op in COMPARISONS or op in ("&&", "||"):
                kind = Number("int", kind.width) if is_vector(kind) else INT  # type: ignore[union-attr]
            elif op in ("<<", ">>"):
                kind = left.type
            elif op == "-" and isinstance(left.type, Pointer) and isinstance(right.type, Pointer):
                kind = Number("long")
            return Term(text, kind, primary=False, pure=left.pure and right.pure)
        if kind == UNKNOWN:
            kind = left.type if is_real(left.type) else right.type
        left, right = (self.convert(node, term, kind) for term in (left, right))
        width = kind.width if isinstance(kind, Number) else 0
        if op in ARITHMETIC and width in REAL_WIDTHS:
            return Term(f"{prefix(width)}_{ARITHMETIC[op]}({left.text}, {right.text})", kind)
        if op in COMPARISONS and width == 1:
            return Term(f"ff_{COMPARISONS[op]}({left.text}, {right.text})", INT)
        self.fail(node, f"'{op}' is not understood between {left.type} and {right.type}")

    # --- by kind of node ----------------------------------------------------------------------------------------------

    def _Constant(self, node: c_ast.Constant) -> Term:
        text: str = node.value
        if node.type in ("float", "double"):
            if text[-1] in "fF":
                return Term(text, FLOAT, pure=True)
            return Term(f"ff_make({', '.join(pair(text))})", REAL, pure=True, literal=text)
        digits = text.rstrip("uUlL")
        base = ("u" if "u" in text.lower() else "") + ("long" if "l" in text.lower() else "int")
        literal = digits if re.fullmatch(r"[1-9]\d*|0", digits) else ""
        return Term(text, Number(base), pure=True, literal=literal)

    def _ID(self, node: c_ast.ID) -> Term:
        kind = self.look_up(node.name)
        return Term(node.name, kind, pure=True, space=kind.space if isinstance(kind, Pointer) and kind.array else "private")

    def _ArrayRef(self, node: c_ast.ArrayRef) -> Term:
        base, index = self.expression(node.name), self.expression(node.subscript)
        kind = base.type.to if isinstance(base.type, Pointer) else UNKNOWN
        space = base.type.space if isinstance(base.type, Pointer) else "private"
        text = f"{base.operand}[{index.text}]"
        return replace(base, space=space).within(text, kind, pure=base.pure and index.pure)

    def _StructRef(self, node: c_ast.StructRef) -> Term:
        base, field = self.expression(node.name), node.field.name
        kind, access = base.type, node.type
        if access == "->":
            if not isinstance(kind, Pointer):
                return Term(f"{base.operand}->{field}", UNKNOWN, pure=base.pure)
            base, kind = replace(base, space=kind.space), kind.to
        if isinstance(kind, Struct):
            if field not in kind.members:
                self.fail(node, f"there is no member '{field}'")
            return base.within(f"{base.operand}{access}{field}", kind.members[field])
        if is_real(kind):
            vector = base.operand if access == "." else f"*{base.operand}"
            self._check_component(node, kind, field)
            return Term(f"{prefix(kind.width)}_{field}({vector})", REAL, pure=base.pure)  # type: ignore[union-attr]
        if isinstance(kind, Number):
            width = 1 if field[0] == "s" else len(field)
            return base.within(f"{base.operand}{access}{field}", Number(kind.base, width))
        return base.within(f"{base.operand}{access}{field}", UNKNOWN)

    def _check_component(self, node: Any, kind: Type, field: str) -> None:
        if not isinstance(kind, Number) or len(field) != 1 or field not in _COMPONENTS.get(kind.width, ""):
            self.fail(node, f"'.{field}' of {kind} is not understood")

    def _UnaryOp(self, node: c_ast.UnaryOp) -> Term:
        op = node.op
        if op == "sizeof":
            is_type = isinstance(node.expr, c_ast.Typename)
            inner = self.declaration(node.expr, "") if is_type else self.expression(node.expr).text
            return Term(f"sizeof({inner})", Number("ulong"), pure=True)
        term = self.expression(node.expr)
        if op == "*":
            kind = term.type.to if isinstance(term.type, Pointer) else UNKNOWN
            space = term.type.space if isinstance(term.type, Pointer) else "private"
            return replace(replace(term, space=space).within(f"*{term.operand}", kind), primary=False)
        if op == "&":
            if self._component(node.expr):
                self.fail(node, "a component of a vector has no address")
            return Term(f"&{term.operand}", Pointer(term.type, term.space), primary=False, pure=term.pure)
        if is_real(term.type):
            if op == "+":
                return term
            if op == "-" and term.literal and not term.literal.startswith("-"):
                return self.convert(node, Term("", INT, literal=f"-{term.literal}"), REAL)
            if op == "-":
                return Term(f"{prefix(term.type.width)}_neg({term.text})", term.type)  # type: ignore[union-attr]
            self.fail(node, f"'{op.strip('p')}' of a real is not understood")
        text = f"{term.operand}{op[1:]}" if op[0] == "p" else f"{op}{term.operand}"
        kind = INT if op == "!" and not is_vector(term.type) else term.type
        literal = f"-{term.literal}" if op == "-" and term.literal and not term.literal.startswith("-") else ""
        return Term(text, kind, primary=False, pure=term.pure and op in "+-!~", literal=literal)

    def _BinaryOp(self, node: c_ast.BinaryOp) -> Term:
        return self.binary(node, node.op, self.expression(node.left), self.expression(node.right))

    def _TernaryOp(self, node: c_ast.TernaryOp) -> Term:
        yes, no = self.expression(node.iftrue), self.expression(node.iffalse)
        kind = common(yes.type, no.type) if isinstance(yes.type, Number) or isinstance(no.type, Pointer) else yes.type
        if is_real(yes.type) or is_real(no.type):
            yes, no = self.convert(node, yes, kind), self.convert(node, no, kind)
        return Term(f"({self.condition(node.cond)} ? {yes.operand} : {no.operand})", kind)

    def _Cast(self, node: c_ast.Cast) -> Term:
        kind = self.type_of(node.to_type)
        if isinstance(node.expr, c_ast.ExprList) and isinstance(kind, Number):
            terms = [self.expression(part) for part in node.expr.exprs]
            if not is_real(kind):
                text = ", ".join(self.convert(node, term, Number(kind.base)).text for term in terms)
                return Term(f"({kind})({text})", kind, primary=False)
            if len(terms) != kind.width or kind.width not in _COMPONENTS or any(is_vector(term.type) for term in terms):
                self.fail(node, f"({kind})(...) is understood with as many scalars as it has components only")
            return Term(f"{prefix(kind.width)}_of({', '.join(self.convert(node, t, REAL).text for t in terms)})", kind)
        term = self.expression(node.expr)
        if is_real(kind) or is_real(term.type):
            return self.convert(node, term, kind)
        return Term(f"({self.declaration(node.to_type, '')}){term.operand}", kind, primary=False, pure=term.pure)

    def _FuncCall(self, node: c_ast.FuncCall) -> Term:
        if not isinstance(node.name, c_ast.ID):
            self.fail(node, "a call through a pointer is not understood")
        name: str = node.name.name
        arguments = [self.expression(argument) for argument in node.args.exprs] if node.args else []
        own = self.scopes[0].get(name)
        if isinstance(own, Function):
            if len(arguments) != len(own.parameters):
                self.fail(node, f"{name} takes {len(own.parameters)} argument(s), not {len(arguments)}")
            converted = [self.convert(node, a, kind) for a, kind in zip(arguments, own.parameters, strict=True)]
            return Term(f"{name}({', '.join(term.text for term in converted)})", own.result)
        if not involves_reals(name, arguments):
            return Term(f"{name}({', '.join(term.text for term in arguments)})", native_result(name, arguments))
        call = call_with_reals(name, arguments, lambda term, kind: self.convert(node, term, kind))
        if call is None:
            given = ", ".join(str(argument.type) for argument in arguments)
            self.fail(node, f"float_float.cl has no {name}({given})")
        return call

    def _Assignment(self, node: c_ast.Assignment) -> Term:
        value = self.expression(node.rvalue)
        component = self._component(node.lvalue)
        if component:
            return self._assign_component(node, *component, value)
        target = self.expression(node.lvalue)
        if node.op != "=" and (is_real(target.type) or is_real(value.type)):
            if not target.pure:
                self.fail(node, f"'{node.op}' needs a left side without side effects")
            value = self.binary(node, node.op[:-1], target, value)
            return Term(f"{target.text} = {self.convert(node, value, target.type).text}", target.type, primary=False)
        return Term(f"{target.text} {node.op} {self.convert(node, value, target.type).text}", target.type, primary=False)

    def _component(self, node: Any) -> tuple[Term, Type, str] | None:
        """(vector, its type, component) if ``node`` is a component of a vector of reals."""
        if not isinstance(node, c_ast.StructRef):
            return None
        vector = self.expression(node.name)
        if node.type == "->" and isinstance(vector.type, Pointer):
            vector = Term(f"*{vector.operand}", vector.type.to, primary=False, pure=vector.pure)
        return (vector, vector.type, node.field.name) if is_real(vector.type) else None

    def _assign_component(self, node: Any, vector: Term, kind: Type, field: str, value: Term) -> Term:
        self._check_component(node, kind, field)
        if not vector.pure:
            self.fail(node, "a component can be set only of a vector without side effects")
        name = prefix(kind.width)  # type: ignore[union-attr]
        if node.op != "=":
            value = self.binary(node, node.op[:-1], Term(f"{name}_{field}({vector.text})", REAL), value)
        text = f"{vector.text} = {name}_with_{field}({vector.text}, {self.convert(node, value, REAL).text})"
        return Term(text, VOID, primary=False)  # of the vector's type in the translated text, so it is no value

    def _ExprList(self, node: c_ast.ExprList) -> Term:
        terms = [self.expression(part) for part in node.exprs]
        return Term(f"({', '.join(term.text for term in terms)})", terms[-1].type)
