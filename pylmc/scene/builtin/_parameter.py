"""Parameters of the built-in scenes: annotations of ``build``, from which all that is said and checked of them is made."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ...errors import PylmcError


@dataclass(frozen=True)
class Parameter:
    """A positive number: what it is, and the greatest that makes sense."""

    help: str
    greatest: float

    def check(self, what: str, value: Any) -> float:
        """``value`` as a float; raises PylmcError, naming ``what``, for what is no number in range."""
        try:
            number = float(value)
        except (TypeError, ValueError):
            raise PylmcError(f"{what}={value!r} is not a number") from None
        if not 0 < number <= self.greatest:
            raise PylmcError(f"{what}={number:g} must be greater than 0 and at most {self.greatest:g}")
        return number
