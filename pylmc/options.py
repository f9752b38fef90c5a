"""What a choice can be: kinds of values, each with its check, its reading from a command line, and its words.

`pylmc.settings` describes every choice by a dataclass field made here; the API's signatures, the command line and
docs/settings.md are made from those fields, so that a choice is described once.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import Field, field, fields
from typing import Any, Protocol

from .checks import check_choice, check_flag, check_integer, check_number, check_subset
from .errors import PylmcError


class Kind(Protocol):
    """A kind of value."""

    def check(self, name: str, value: Any) -> Any:
        """``value`` as a plain Python value, which JSON knows; raises PylmcError if it is none of this kind."""

    def read(self, text: str) -> Any:
        """The value that a command line's ``text`` means, not yet checked; raises ValueError where it means none."""

    def words(self) -> str:
        """What values there are, for a table."""


class Choice:
    """One of a few words."""

    def __init__(self, *allowed: str) -> None:
        self.allowed = allowed

    def check(self, name: str, value: Any) -> str:
        check_choice(name, value, self.allowed)
        return str(value)

    def read(self, text: str) -> str:
        return text

    def words(self) -> str:
        return ", ".join(f"`{word}`" for word in self.allowed)


class Flag:
    """Yes or no."""

    def check(self, name: str, value: Any) -> bool:
        return check_flag(name, value)

    def read(self, text: str) -> bool:
        return {"true": True, "false": False}[text.lower()]

    def words(self) -> str:
        return "`True`, `False`"


class Integer:
    """A whole number of things."""

    def __init__(self, least: int, greatest: int, of: str = "") -> None:
        self.least, self.greatest, self.of = least, greatest, of

    def check(self, name: str, value: Any) -> int:
        return check_integer(name, value, self.least, self.greatest, self.of)

    def read(self, text: str) -> int:
        return int(text)

    def words(self) -> str:
        return f"{self.least} to {self.greatest}{' ' * bool(self.of)}{self.of}"


class Number:
    """A number, called ``noun`` in messages."""

    def __init__(self, least: float, greatest: float, noun: str = "number") -> None:
        self.least, self.greatest, self.noun = least, greatest, noun

    def check(self, name: str, value: Any) -> float:
        return check_number(name, value, self.least, self.greatest, self.noun)

    def read(self, text: str) -> float:
        return float(text)

    def words(self) -> str:
        return f"{self.least:g} to {self.greatest:g}"


class Interval:
    """Two numbers, the least and the greatest of what is drawn."""

    def __init__(self, least: float, greatest: float) -> None:
        self.least, self.greatest = least, greatest

    def check(self, name: str, value: Any) -> tuple[float, float]:
        try:
            low, high = value
        except (TypeError, ValueError):
            raise PylmcError(f"{name}={value!r}: give two numbers, the least and the greatest, such as 0.01, 0.3") from None
        low = check_number(f"{name}[0]", low, self.least, self.greatest)
        return low, check_number(f"{name}[1]", high, low, self.greatest)

    def read(self, text: str) -> tuple[float, float]:
        low, high = text.split(",")
        return float(low), float(high)

    def words(self) -> str:
        return f"two numbers, {self.least:g} to {self.greatest:g}"


class Subset:
    """Some of a few words."""

    def __init__(self, *allowed: str) -> None:
        self.allowed = allowed

    def check(self, name: str, value: Any) -> tuple[str, ...]:
        return check_subset(name, value, self.allowed)

    def read(self, text: str) -> tuple[str, ...]:
        return () if text == "none" else tuple(text.split(","))

    def words(self) -> str:
        return f"some of {', '.join(f'`{word}`' for word in self.allowed)}; `none` on the command line"


class Anything:
    """What only its user can judge, such as a device."""

    def check(self, name: str, value: Any) -> Any:
        return value

    def read(self, text: str) -> str:
        return text

    def words(self) -> str:
        return ""


def option(
    default: Any, kind: Kind, help: str, *, metavar: str = "", unset: str = "", integrators: tuple[str, ...] = ()
) -> Any:
    """A dataclass field: its default, kind and help.

    ``metavar`` stands for the value in the command line's help. ``unset`` says what happens without a value where the
    default is None, which is then a value that passes. ``integrators`` are those that it concerns; none named: all.
    """
    metadata = {"kind": kind, "help": help, "metavar": metavar, "unset": unset, "integrators": integrators}
    return field(default=default, metadata=metadata)


def check_all(options: Any) -> None:
    """Check every field of a frozen dataclass of options, and put plain values in their place."""
    for item in fields(options):
        value = getattr(options, item.name)
        if value is not None or item.default is not None:
            object.__setattr__(options, item.name, item.metadata["kind"].check(item.name, value))


def check_names(given: Iterable[str], known: Iterable[str]) -> None:
    """Raise PylmcError for a name that is no setting, with the one that was probably meant."""
    allowed = list(known)
    for name in given:
        if name not in allowed:
            close = difflib.get_close_matches(name.replace("-", "_"), allowed, 1)
            meant = f"did you mean '{close[0]}'? The settings are" if close else "choose from"
            raise PylmcError(f"unknown setting '{name}'; {meant} {', '.join(allowed)}")


def default_words(item: Field[Any]) -> str:
    """A field's default as its help says it, on the command line's terms."""
    default = item.default
    if default is None:
        return str(item.metadata["unset"])
    if isinstance(default, bool):
        return f"--{'' if default else 'no-'}{flag(item.name)}"
    if isinstance(item.metadata["kind"], Subset) and default == item.metadata["kind"].allowed:
        return "all"
    if isinstance(default, tuple):
        return ",".join(f"{part:g}" if isinstance(part, float) else str(part) for part in default)
    return f"{default:g}" if isinstance(default, float) else str(default)


def flag(name: str) -> str:
    """A field's name as the command line spells it, without the dashes in front."""
    return name.replace("_", "-")
