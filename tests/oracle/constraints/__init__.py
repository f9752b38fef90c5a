"""Constraints and the preconditioner (theory.md, 5), a file for each kind.

A kind's file is called as the setting ``constraints`` calls it, and found by that. It has

    add(rows, charts, tangents)     its rows, by names that begin with the kind's
"""

from __future__ import annotations

from importlib import import_module

from pylmc.settings import CONSTRAINTS

from ..charts import Charts
from ..tangents import Tangents
from ..vectors import Array
from .bounds import add as add_bounds
from .rows import Rows


def constraint_rows(charts: Charts, tangents: Tangents) -> Rows:
    """Every constraint that the paths have, of the kinds that the settings keep."""
    rows = Rows()
    add_bounds(rows, charts)
    for kind in CONSTRAINTS:
        if kind in charts.settings.constraints:
            import_module(f".{kind}", __name__).add(rows, charts, tangents)
    return rows


def preconditioner(charts: Charts, tangents: Tangents | None = None) -> Array:
    """Q (n, 2m, 2m) of eq. (21)."""
    return constraint_rows(charts, tangents or Tangents(charts)).combined(charts.settings.rule)


def proposal_factor(charts: Charts, tangents: Tangents | None = None) -> Array:
    """L (n, 2m, 2m) with Q = L Lᵀ; T = L⁻ᵀ."""
    return constraint_rows(charts, tangents or Tangents(charts)).factor(charts.settings.rule)
