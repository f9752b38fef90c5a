"""Kernel text in ``real`` to OpenCL C in pairs of floats: statements and functions around the translated expressions."""

from __future__ import annotations

from typing import Any

from pycparser import c_ast

from .declarations import PREAMBLE, parse
from .expressions import Expressions
from .preprocessing import prepare
from .types import VOID, Pointer, Struct, Type


def translate(text: str) -> str:
    """``text``, a kernel source with its includes in place and float_float.cl first, with reals as pairs of floats.

    ``real``, ``real2``, ``real3`` and ``real8`` are numbers in ``text``, and floating literals without a suffix are reals.
    Macros are expanded, so what a build defines must be defined in ``text``; ``#line`` markers keep every statement's
    place for the compiler's messages. Raises PylmcError, with the kernel's file and line, for what is not understood.
    """
    prepared = prepare(text)
    return f"{prepared.untranslated}\n{Statements(prepared).file(parse(prepared))}"


class Statements(Expressions):
    """Translates statements and whole files."""

    result: Type = VOID  # of the function that is being translated

    def file(self, tree: c_ast.FileAST) -> str:
        """The text of everything but the preamble."""
        return "".join(text for node in tree.ext if (text := self._external(node)))

    def _external(self, node: Any) -> str:
        if isinstance(node, c_ast.Typedef):
            self.types[node.name] = self.type_of(node)
        elif isinstance(node, c_ast.FuncDef):
            return self._function(node)
        elif isinstance(node, c_ast.Decl) and node.name:
            self.scopes[0][node.name] = self.type_of(node)
        if node.coord is not None and node.coord.file == PREAMBLE:
            return ""
        if isinstance(node, c_ast.Typedef):
            return f"{self._line(node)}{self.declaration(node)};\n"
        return self.statement(node)

    def _function(self, node: c_ast.FuncDef) -> str:
        kind = self.type_of(node.decl)
        self.scopes[0][node.decl.name] = kind
        parameters = node.decl.type.args.params if node.decl.type.args else []
        self.scopes.append({p.name: self.type_of(p) for p in parameters if p.name})
        self.result = self.type_of(node.decl.type.type)
        kernel = self.prepared.kernels.get(node.decl.name, "")
        text = f"{self._line(node.decl)}{kernel} {self.declaration(node.decl)}\n{self.statement(node.body)}".lstrip(" ")
        self.scopes.pop()
        return text

    def _line(self, node: Any) -> str:
        if node.coord is None:
            return ""
        file, line = self.prepared.place(node.coord.line)
        return f'#line {line} "{file}"\n'

    def statement(self, node: Any) -> str:
        """The translated statement, on lines of its own. Raises PylmcError for what is not understood."""
        match node:
            case c_ast.Compound():
                self.scopes.append({})
                text = "".join(self.statement(item) for item in node.block_items or ())
                self.scopes.pop()
                return f"{{\n{text}}}\n"
            case c_ast.For():
                self.scopes.append({})
                text = self._line(node) + self._for(node)
                self.scopes.pop()
                return text
            case c_ast.If():
                text = f"{self._line(node)}if ({self.condition(node.cond)})\n{self.statement(node.iftrue)}"
                return f"{text}else\n{self.statement(node.iffalse)}" if node.iffalse else text
            case c_ast.While():
                return f"{self._line(node)}while ({self.condition(node.cond)})\n{self.statement(node.stmt)}"
            case c_ast.DoWhile():
                return f"{self._line(node)}do\n{self.statement(node.stmt)}while ({self.condition(node.cond)});\n"
            case c_ast.Return():
                value = f" {self.convert(node, self.expression(node.expr), self.result).text}" if node.expr else ""
                return f"{self._line(node)}return{value};\n"
            case c_ast.Break():
                return "break;\n"
            case c_ast.Continue():
                return "continue;\n"
            case c_ast.EmptyStatement():
                return ";\n"
            case c_ast.Pragma():
                return f"#pragma {node.string}\n"
            case c_ast.Decl():
                return f"{self._line(node)}{self._variable(node)};\n"
            case c_ast.Switch():
                return f"{self._line(node)}switch ({self.expression(node.cond).text})\n{self.statement(node.stmt)}"
            case c_ast.Case():
                return f"case {self.expression(node.expr).text}:\n" + "".join(map(self.statement, node.stmts or ()))
            case c_ast.Default():
                return "default:\n" + "".join(map(self.statement, node.stmts or ()))
            case c_ast.Label() | c_ast.Goto():
                self.fail(node, f"{type(node).__name__.lower()} is not understood")
        return f"{self._line(node)}{self.expression(node).text};\n"

    def _for(self, node: c_ast.For) -> str:
        if isinstance(node.init, c_ast.DeclList):
            first = node.init.decls[0]
            if any(isinstance(decl.type, c_ast.PtrDecl | c_ast.ArrayDecl) for decl in node.init.decls[1:]):
                self.fail(node, "a further pointer or array declared by a for is not understood")
            rest = [f", {decl.name}{self._initialiser(decl)}" for decl in node.init.decls[1:]]
            start = self._variable(first) + "".join(rest)
        else:
            start = self.expression(node.init).text if node.init else ""
        condition = self.condition(node.cond) if node.cond else ""
        step = self.expression(node.next).text if node.next else ""
        return f"for ({start}; {condition}; {step})\n{self.statement(node.stmt)}"

    def _variable(self, node: c_ast.Decl) -> str:
        return self.declaration(node) + self._initialiser(node)

    def _initialiser(self, node: c_ast.Decl) -> str:
        kind = self.type_of(node)
        if node.name:
            self.scopes[-1][node.name] = kind
        return f" = {self._value(node.init, kind)}" if node.init else ""

    def _value(self, node: Any, kind: Type) -> str:
        """What a variable of that type is initialised with: an expression, or a list in braces."""
        if not isinstance(node, c_ast.InitList):
            return self.convert(node, self.expression(node), kind).text
        if isinstance(kind, Struct):
            kinds = list(kind.members.values())
        elif isinstance(kind, Pointer) and kind.array:
            kinds = [kind.to] * len(node.exprs)
        else:
            self.fail(node, "braces are understood around structs' and arrays' values only")
        if len(node.exprs) > len(kinds) or any(isinstance(part, c_ast.NamedInitializer) for part in node.exprs):
            self.fail(node, "more values than members, or names before them, are not understood")
        return "{" + ", ".join(self._value(part, to) for part, to in zip(node.exprs, kinds, strict=False)) + "}"
