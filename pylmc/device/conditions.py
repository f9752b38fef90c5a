"""The conditions of kernel sources: a name in an ``#if`` that nobody defines counts as 0 in C, and is an error here."""

from __future__ import annotations

import re

from ..errors import PylmcError

_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
_DIRECTIVE = re.compile(r"^[ \t]*#[ \t]*(line|define|undef|ifdef|ifndef|if|elif|else|endif)\b((?:\\\n|[^\n])*)", re.MULTILINE)
_LINE = re.compile(r'\s*(\d+)\s+"([^"]*)"')
_DEFINITION = re.compile(r"\s*(\w+)(\([^)]*\))?\s*(.*)", re.DOTALL)
_DEFINED = re.compile(r"\bdefined\s*(?:\(\s*(\w+)\s*\)|(\w+))")
_NAME = re.compile(r"(?<![\w.])[A-Za-z_]\w*")
FOREIGN = "pyopencl-"  # files of others, by how their names begin: they test what compilers may or may not define


def check_conditions(text: str) -> None:
    """Every name in an ``#if`` or ``#elif`` of ``text``, and in what it stands for, is defined before it.

    ``text`` is a source with its includes in place and ``#line`` directives, after the host's ``#define`` lines. A name is
    free to be undefined where the same condition, or one around it, asks ``defined(NAME)``; names that begin with two
    underscores are the compiler's. Raises PylmcError with file and line.
    """
    text = _COMMENT.sub(lambda comment: "\n" * comment[0].count("\n") or " ", text)
    values: dict[str, str] = {}
    asked: list[set[str]] = []  # what the conditions around this line ask to be defined
    file, line, counted = "source", 1, 0
    for directive in _DIRECTIVE.finditer(text):
        word, rest = directive[1], directive[2]
        if word == "line" and (place := _LINE.match(rest)):
            file, line, counted = place[2], int(place[1]) - 1, directive.start()
        elif word == "define" and (definition := _DEFINITION.match(rest)):
            values[definition[1]] = "" if definition[2] else definition[3]  # what a macro with parameters gives is not known
        elif word == "undef":
            values.pop(rest.strip(), None)
        elif word in ("ifdef", "ifndef"):
            asked.append({rest.strip()})
        elif word == "endif":
            asked.pop()
        elif word in ("if", "elif"):
            tested = {name for pair in _DEFINED.findall(rest) for name in pair if name}
            if word == "if":
                asked.append(tested)
            else:
                asked[-1] = asked[-1] | tested
            if file.startswith(FOREIGN):
                continue
            for name in _NAME.findall(_DEFINED.sub(" ", rest)):
                missing = _missing(name, values, set().union(*asked))
                if missing:
                    at = line + text.count("\n", counted, directive.start())
                    raise PylmcError(
                        f"{file}:{at}: #{word} reads {missing}, which is not defined there and would count as 0: have the host "
                        f"define it (pylmc/device/tables.py), or ask defined({missing}) first"
                    )


def _missing(name: str, values: dict[str, str], asked: set[str], within: tuple[str, ...] = ()) -> str:
    """The name, or one in what it stands for, that is not defined; empty if all are."""
    if name in within or name in asked or name.startswith("__"):
        return ""
    if name not in values:
        return name
    found = (_missing(part, values, asked, (*within, name)) for part in _NAME.findall(values[name]))
    return next((part for part in found if part), "")
