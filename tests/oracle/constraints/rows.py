"""The rows of all constraints together, each the derivative of the function that it bounds, and Q (theory.md, 5)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pylmc.constraints.combination import combine

from ..vectors import Array


@dataclass
class Rows:
    """Rows (n, 2m) over their widths, and which constraint each belongs to: M of eq. (21) counts constraints, not rows.

    A constraint's name begins with its kind.
    """

    rows: list[Array] = field(default_factory=list)
    owners: list[Array] = field(default_factory=list)
    names: dict[Any, int] = field(default_factory=dict)

    def add(self, name: tuple[Any, ...], row: Array, present: Array) -> None:
        """A row of constraint ``name``, for the paths that have it."""
        self.rows.append(np.where(present[:, None], row, 0))
        self.owners.append(np.where(present, self.names.setdefault(name, len(self.names)), -1))

    def combined(self, rule: str) -> Array:
        """Q (n, 2m, 2m) of eq. (21) by the package's own float64 combination."""
        return combine(np.stack(self.rows, axis=1), np.stack(self.owners, axis=1), rule)

    def factor(self, rule: str) -> Array:
        """L, lower triangular, with Q = L Lᵀ, without Q: its condition number is the square of L's.

        By a QR factorisation of the rows: Q = w RᵀR.
        """
        rows, owners = np.stack(self.rows, axis=1), np.stack(self.owners, axis=1)
        upper = np.linalg.qr(rows, mode="r")
        upper = upper * np.where(np.einsum("nii->ni", upper) < 0, -1, 1)[..., None]
        present = np.where(np.any(rows != 0, axis=-1), owners, -1)
        count = np.array([len(np.unique(row[row >= 0])) for row in present])
        weight = {"sum": np.ones(len(count)), "mean": 1 / count, "rms": 1 / np.sqrt(count)}[rule]
        return np.swapaxes(upper, 1, 2) * np.sqrt(weight)[:, None, None]
