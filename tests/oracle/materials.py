"""A compiled scene's materials with the parameters of all their lobes side by side, for formulas that work on many nodes."""

from __future__ import annotations

import numpy as np

from pylmc.lobes import KINDS

from .vectors import Array


def side_by_side(materials: Array, lobes: Array) -> Array:
    """A record for each material: every parameter that a kind of lobe has, 0 where the material has no lobe with it.

    ``choice``, ``before`` and ``narrow`` have an entry for each kind: the probability with which the material chooses its
    lobe of that kind, the cumulative probability before it, and whether it is narrow. ``texture``: or -1.
    """
    parameters = {field[0]: field for kind in KINDS for field in kind.fields}
    each = (len(KINDS),)
    extra = [("choice", np.float64, each), ("before", np.float64, each), ("narrow", np.int32, each), ("texture", np.int32)]
    table = np.zeros(len(materials), [*parameters.values(), *extra])
    table["texture"] = materials["texture"]
    for record, material in zip(table, materials, strict=True):
        for lobe in lobes[material["first_lobe"] :][: material["lobes"]]:
            kind = lobe["kind"]
            assert record["choice"][kind] == 0, "two lobes of one kind"
            for field in KINDS[kind].fields:
                record[field[0]] = lobe[field[0]]
            record["choice"][kind] = lobe["choose"] - lobe["choose_before"]
            record["before"][kind] = lobe["choose_before"]
            record["narrow"][kind] = lobe["narrow"]
    return table
