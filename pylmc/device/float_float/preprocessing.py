"""Kernel text before it is parsed: macros expanded, what is not translated set aside, places remembered."""

from __future__ import annotations

import io
import re
from dataclasses import dataclass
from typing import Any

from ...errors import PylmcError

# Files that hold no reals of their own, or float_float.cl, which is what reals are made of.
UNTRANSLATED = ("pyopencl-", "number/float_float")
_LINE = re.compile(r'#line (\d+) "([^"]*)"')
_KERNEL = re.compile(r"__kernel\s+((?:__attribute__\s*\(\(.*?\)\)\s*)*)(?=void\s+(\w+))", re.DOTALL)


@dataclass(frozen=True)
class Prepared:
    """``untranslated``: the text set aside. ``expanded``: the rest without directives but ``#line``, whose numbers count the
    lines of the whole text; ``places``: file and line of each of those. ``kernels``: by kernel name, what precedes ``void``.
    """

    untranslated: str
    expanded: str
    places: list[tuple[str, int]]
    kernels: dict[str, str]

    def place(self, line: int) -> tuple[str, int]:
        """File and line of the kernel source that line ``line`` of the whole text came from."""
        return self.places[min(max(line, 1), len(self.places)) - 1]


def prepare(text: str) -> Prepared:
    """Split and expand ``text``, a kernel source with its includes in place (see :func:`pylmc.device.program.source`).

    Raises PylmcError, with file and line, for a directive that cannot be followed.
    """
    import pcpp

    untranslated: list[str] = []
    rest: list[str] = []
    places: list[tuple[str, int]] = []
    file, number = "<text>", 0
    for line in text.splitlines():
        number += 1
        places.append((file, number))
        match = _LINE.match(line)
        if match:
            file, number = match[2], int(match[1]) - 1
        aside = file.startswith(UNTRANSLATED)
        if aside:
            untranslated.append(line)
        rest.append("" if aside or match else line)

    class Preprocessor(pcpp.Preprocessor):
        def on_error(self, file: str, line: int, message: str) -> None:
            where, at = places[min(line, len(places)) - 1]
            raise PylmcError(f"{where}:{at}: {message}")

        def on_directive_handle(self, directive: Any, tokens: Any, passed: Any, before: Any) -> Any:
            if directive.value == "error":
                self.on_error("", directive.lineno, "".join(token.value for token in tokens).strip())
            return super().on_directive_handle(directive, tokens, passed, before)

    preprocessor = Preprocessor()
    preprocessor.parse("\n".join(rest) + "\n", "kernel")
    out = io.StringIO()
    preprocessor.write(out)
    kernels: dict[str, str] = {}

    def without(match: re.Match[str]) -> str:
        kernels[match[2]] = " ".join(match[0].split())
        return "\n" * match[0].count("\n")  # so that lines keep their numbers

    return Prepared("\n".join(untranslated), _KERNEL.sub(without, out.getvalue()), places, kernels)
