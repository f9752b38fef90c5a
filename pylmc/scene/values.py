"""Numbers that a person gives: points, colours, lists of things; each checked, or refused by name."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from ..errors import PylmcError
from .kinds import Kind

RGB = tuple[float, float, float]
BRIGHTEST = 1e36  # light in the scene's units; pictures are float32
MAX_COORDINATE = 1e15  # beyond it nothing is left of a scene after its centre is subtracted


def real_numbers(value: Any) -> np.ndarray:
    """A float64 copy of an array of real numbers. Raises TypeError or ValueError for all else, such as text."""
    given = np.asarray(value)
    if given.dtype.kind not in "biufO":
        raise TypeError(f"{given.dtype} is no type of real numbers")
    return np.array(given, dtype=np.float64)


def fixed(array: np.ndarray) -> np.ndarray:
    """The array, made unwritable: a scene's parts are values."""
    array.flags.writeable = False
    return array


def as_rows(value: Any, rows: int, columns: int, what: str) -> np.ndarray:
    """A float64 copy (rows, columns) of one row of real numbers per vertex, or a PylmcError naming ``what``."""
    try:
        array = real_numbers(value)
    except (TypeError, ValueError) as error:
        raise PylmcError(f"{what} must be an array of numbers ({rows}, {columns}): {error}") from None
    if array.shape != (rows, columns):
        raise PylmcError(f"{what} have shape {array.shape}; expected ({rows}, {columns}), a row for each vertex")
    return array


def as_point(value: Any, what: str) -> np.ndarray:
    """Three finite numbers as a float64 array, or a PylmcError naming ``what``."""
    try:
        point = real_numbers(value).reshape(-1)
    except (TypeError, ValueError):
        raise PylmcError(f"{what}: {value!r} is not a point; give three numbers") from None
    if point.shape != (3,) or not np.all(np.abs(point) <= MAX_COORDINATE):
        raise PylmcError(f"{what}: {value!r} is not a point; give three numbers, none beyond {MAX_COORDINATE:g}")
    return fixed(point)


def as_direction(value: Any, what: str) -> np.ndarray:
    """Three numbers, not all zero, as a unit vector; or a PylmcError naming ``what``."""
    vector = as_point(value, what)
    largest = np.abs(vector).max()
    if not largest > 0:
        raise PylmcError(f"{what} has length zero; give the vector of a direction")
    vector = vector / largest  # whose squares neither vanish nor overflow
    return fixed(vector / np.linalg.norm(vector))


def as_list(value: Any, what: str, kind: type) -> tuple[Any, ...]:
    """A sequence whose every element is a ``kind``, as a tuple; raises PylmcError naming ``what``."""
    if isinstance(value, str) or not isinstance(value, Iterable):
        raise PylmcError(f"{what} is a {type(value).__name__}; give a list of {kind.__name__}")
    items = tuple(value)
    for index, item in enumerate(items):
        if issubclass(kind, Kind):
            kind.check(item, f"{what}[{index}]")
        elif not isinstance(item, kind):
            raise PylmcError(f"{what}[{index}] is a {type(item).__name__}, not {kind.__name__}")
    return items


def as_rgb(value: Any, what: str, upper: float | None = None) -> RGB:
    """A grey level or three numbers as linear RGB; raises PylmcError naming ``what`` if that cannot be."""
    try:
        rgb = np.broadcast_to(real_numbers(value), 3)
    except (TypeError, ValueError):
        raise PylmcError(f"{what}: {value!r} is not a colour; give one number or three (linear RGB)") from None
    if not np.all((rgb >= 0) & (rgb <= BRIGHTEST)):
        raise PylmcError(f"{what}: {value!r} must lie between 0 and {BRIGHTEST:g}")
    if upper is not None and np.any(rgb > upper):
        raise PylmcError(f"{what}: {value!r} exceeds {upper:g}; a surface cannot reflect more light than it receives")
    return (float(rgb[0]), float(rgb[1]), float(rgb[2]))


def as_power(value: Any, what: str) -> RGB:
    """A light's RGB, not all zero; or a PylmcError naming ``what``."""
    rgb = as_rgb(value, what)
    if max(rgb) <= 0:
        raise PylmcError(f"{what} is zero: remove the light or give it power")
    return rgb
