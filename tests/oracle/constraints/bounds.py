"""The bounds of every direction's own two coordinates: one radian or chart unit; the film for the first."""

from __future__ import annotations

import numpy as np

from ..charts import NODE, Charts
from .rows import Rows


def add(rows: Rows, charts: Charts) -> None:
    for j in range(1, charts.m + 1):
        kinds = charts.kinds[:, j]
        distance = np.where(kinds >= NODE, np.linalg.norm(charts.anchor[:, j] - charts.base.x[:, j - 1], axis=-1), 1.0)
        bound = float(charts.world.camera["bound"]) if j == 1 else 1.0
        for k in (0, 1):
            column = np.zeros((len(kinds), 2 * charts.m))
            column[:, 2 * j - 2 + k] = 1
            rows.add(("bound", j), column / (distance * bound)[:, None], np.ones(len(kinds), bool))
