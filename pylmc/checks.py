"""Checks of single values that several places share."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from numbers import Real
from typing import Any

from .errors import PylmcError


def _number(value: Any) -> float | None:
    """A Python or NumPy number as a float; None for all else, truth values among it."""
    return float(value) if isinstance(value, Real) and not isinstance(value, bool) else None


def check_choice(name: str, value: Any, allowed: tuple[str, ...]) -> None:
    """Raise PylmcError unless ``value`` is one of ``allowed``."""
    if not isinstance(value, str) or value not in allowed:
        raise PylmcError(f"{name}={value!r} is unknown; choose from {', '.join(allowed)}")


def check_subset(name: str, values: Any, allowed: tuple[str, ...]) -> tuple[str, ...]:
    """``values``, a list of words, as a tuple in the order of ``allowed``; raises PylmcError for any other word."""
    if isinstance(values, str) or not isinstance(values, Iterable):
        raise PylmcError(f"{name}={values!r}: give a list of {', '.join(allowed)} (an empty one for none)")
    chosen = tuple(values)
    for value in chosen:
        check_choice(name, value, allowed)
    return tuple(value for value in allowed if value in chosen)


def check_integer(name: str, value: Any, least: int, greatest: int, of: str = "") -> int:
    """``value`` as an int; raises PylmcError unless it is a whole number (``of`` what) in [least, greatest]."""
    number = _number(value)
    if number is None or not least <= number <= greatest or number != int(number):
        raise PylmcError(f"{name}={value!r}: give a whole number{of and f' of {of}'} from {least} to {greatest}")
    return int(value)


def check_flag(name: str, value: Any) -> bool:
    """``value`` as a bool; raises PylmcError for anything else, such as the word 'no'."""
    if not isinstance(value, Hashable) or value not in (True, False):
        raise PylmcError(f"{name}={value!r}: give True or False")
    return bool(value)


def check_number(name: str, value: Any, least: float, greatest: float, noun: str = "number") -> float:
    """``value`` as a float; raises PylmcError unless it is a number (a ``noun`` in the message) in [least, greatest]."""
    number = _number(value)
    if number is None or not least <= number <= greatest:
        raise PylmcError(f"{name}={value!r}: give a {noun} from {least:g} to {greatest:g}")
    return number
