"""Which film a group's splats go to, in bounded memory: short paths have a film each, and the longest share one.

A film of its own is multiplied by its group's normalisation when it is looked at. In a shared one every splat is weighted by
what was known of its group's when it was made, whole launch by whole launch: groups keep their proportions, and what the
first launches knew less well counts the less the longer the run is.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..device import tables
from ..device.arrays import FILM_WORD, Film, Records
from ..device.device_scene import DeviceScene
from ..picture.estimators import Estimator
from .groups import Group

FILM_BYTES = 1 << 30  # on the device, of all films together


def film_for(device: DeviceScene, groups: int, height: int, width: int) -> Film:
    """An empty film: a slot a group, or fewer where they would need more than FILM_BYTES or the device allows.

    Raises PylmcError if not even one fits into the device's memory.
    """
    most = min(FILM_BYTES, device.device.max_mem_alloc_size) // (height * width * 3 * FILM_WORD.itemsize)
    return Film(device, max(min(groups, most), 1), height, width)


class Places(NamedTuple):
    """Where the groups' splats go in a film of ``slots`` slots: those of the longest paths share the last one.

    slot (groups,): each group's. light: the b of those that share, when the run began; chains: how many they have.
    """

    groups: tuple[Group, ...]
    slot: np.ndarray
    shared: np.ndarray
    light: float
    chains: int

    def worths(self, groups: Sequence[Group]) -> np.ndarray:
        """(groups,): by what splats are multiplied; ``groups`` are these, as they are now."""
        now = np.array([group.worth / max(group.chains, 1) for group in groups])
        return np.where(self.shared, now * self.chains / (self.light or 1.0), 1.0)

    def table(self, device: DeviceScene, groups: Sequence[Group]) -> Records:
        """For kernels: see film.cl."""
        table = np.zeros(len(self.groups), tables.FILM_PLACE)
        table["slot"], table["scale"] = self.slot, self.worths(groups)
        table["log_unit"] = np.log([group.unit for group in self.groups])
        return Records.of(device, "FilmPlace", table)

    def estimators(self, film: Film, groups: Sequence[Group], scale: float, steps: int) -> list[Estimator]:
        """The picture's parts, a slot each; ``groups``: as they are now.

        ``scale``: radiance that a splat of one is, by every chain in each of ``steps``, for a group whose b is one.
        """
        found = []
        for slot in range(film.slots):
            here = np.flatnonzero(self.slot == slot).tolist()
            name = " + ".join(groups[i].name for i in here)
            own = groups[here[0]]
            worth, chains = (self.light, self.chains) if self.shared[here].any() else (own.worth, own.chains)
            found.append(Estimator(name, film.slot(slot), worth * scale, steps * chains))
        return found

    def together(self, values: np.ndarray) -> np.ndarray:
        """Sums (slots,) of values (groups,)."""
        return np.bincount(self.slot, values)


def places(groups: Sequence[Group], slots: int) -> Places:
    """Those of a run's groups, as they are when it begins."""
    by_length = sorted(range(len(groups)), key=lambda i: (groups[i].length, groups[i].ending))
    slot = np.arange(len(groups))
    if len(groups) > slots:
        slot[by_length] = np.minimum(np.arange(len(groups)), slots - 1)
    shared = (slot == slots - 1) & (len(groups) > slots)
    theirs = [group for group, it_does in zip(groups, shared, strict=True) if it_does]
    return Places(
        tuple(groups), slot, shared, sum(group.b or group.unit for group in theirs), sum(group.chains for group in theirs)
    )
