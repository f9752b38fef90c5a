"""A compiled scene's materials with the parameters of all their lobes side by side, for formulas that work on many nodes."""

from __future__ import annotations

import numpy as np

from pylmc.lobes import KINDS, Diffuse

from .vectors import Array


def side_by_side(materials: Array, lobes: Array) -> Array:
    """A record for each material: every parameter that a kind of lobe has, 0 where the material has no lobe with it.

    ``choose_diffuse``: the probability of its diffuse lobe. ``narrow``: whether it has a narrow one. ``texture``: or -1.
    """
    parameters = {field[0]: field for kind in KINDS for field in kind.fields}
    extra = [("choose_diffuse", np.float64), ("texture", np.int32), ("narrow", np.int32)]
    table = np.zeros(len(materials), [*parameters.values(), *extra])
    table["texture"] = materials["texture"]
    for record, material in zip(table, materials, strict=True):
        for lobe in lobes[material["first_lobe"] :][: material["lobes"]]:
            kind = KINDS[lobe["kind"]]
            for field in kind.fields:
                record[field[0]] = lobe[field[0]]
            record["narrow"] |= lobe["narrow"]
            if kind is Diffuse:
                record["choose_diffuse"] = lobe["choose"] - lobe["choose_before"]
    return table
