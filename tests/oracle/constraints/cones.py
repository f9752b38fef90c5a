"""The last segment stays in its spot light's cone: its direction's part across the axis is bounded by the cone's."""

from __future__ import annotations

import numpy as np

from pylmc.scene import Light, SpotLight

from ..charts import Charts
from ..paths import CONNECT
from ..tangents import Tangents
from ..vectors import any_tangent
from .rows import Rows

SPOT = sorted(kind.name for kind in Light.kinds).index(SpotLight.name)


def add(rows: Rows, charts: Charts, tangents: Tangents) -> None:
    base, lights = charts.base, charts.world.arrays["lights"]
    if base.ending != CONNECT or charts.m < base.length - 1:
        return
    turned = tangents.of(lambda moved: moved.paths.v)[:, -1]
    for index, light in enumerate(lights):
        if light["kind"] != SPOT or light["spread"] >= 1:
            continue
        axis, sine = light["direction"].astype(float), np.sqrt(1 - (1 - float(light["spread"])) ** 2)
        first = any_tangent(axis)
        for across in (first, np.cross(axis, first)):
            rows.add(("cones",), np.einsum("i,nik->nk", across, turned) / sine, base.light == index)
