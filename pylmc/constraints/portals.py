"""Portals: a segment stays in the hole that it passes (theory.md, 5; eqs. (11), (20))."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from ..scene import Portal
from ..scene.lights.light import Placement
from .constraint import Constraint, Found

WIDE_PORTAL = 0.5  # a hole wider than this part of the scene's radius constrains nothing
MAX_PORTALS = 16
_F3 = (np.float64, (3,))


@dataclass(frozen=True)
class Portals(Constraint):
    """``portals``: those that constrain; ``given``: how many there are; ``wide``: how many are too wide."""

    name: ClassVar[str] = "portals"
    structs: ClassVar[dict[str, list[Any]]] = {
        "Portal": [("centre", *_F3), ("normal", *_F3), ("axis", *_F3), ("half_size", np.float64, (2,))]
    }
    arrays: ClassVar[dict[str, str]] = {"portals": "Portal"}

    portals: tuple[Portal, ...]
    given: int
    wide: int

    @classmethod
    def find(cls, found: Found) -> Self:
        """The narrow ones; the smallest, if they are too many."""
        narrow = [portal for portal in found.portals if min(portal.half_size) <= WIDE_PORTAL * found.radius]
        wide = len(found.portals) - len(narrow)
        if len(narrow) > MAX_PORTALS:
            narrow = sorted(narrow, key=lambda a: a.half_size[0] * a.half_size[1])[:MAX_PORTALS]
        return cls(tuple(narrow), len(found.portals), wide)

    @property
    def present(self) -> bool:
        return bool(self.portals)

    def features(self) -> dict[str, Any]:
        """Portals serve as charts as well."""
        return {"NUM_PORTALS": len(self.portals)}

    def records(self, placement: Placement) -> dict[str, np.ndarray]:
        records = np.zeros(len(self.portals), self.structs["Portal"])
        for record, portal in zip(records, self.portals, strict=True):
            record["centre"] = placement.of(portal.centre)
            record["normal"], record["axis"] = portal.normal, portal.axis
            record["half_size"] = np.array(portal.half_size) / placement.scale
        return {"portals": records}

    def lines(self) -> list[str]:
        """How many, and their sizes."""
        if not self.portals:
            return []
        sizes = ", ".join("x".join(f"{2 * h:.3g}" for h in portal.half_size) for portal in self.portals[:6])
        return [f"portals     {len(self.portals)} portal(s) of at most {MAX_PORTALS}, sizes {sizes}"]

    def left_out(self) -> list[str]:
        """The wide ones and those beyond the limit."""
        if not self.given:
            return ["portal constraints: the scene has no portal (inner boundary loop of an open planar piece)"]
        reasons = [f"{self.wide} portal(s) wider than {WIDE_PORTAL:g} scene radii"] if self.wide else []
        more = self.given - self.wide - len(self.portals)
        return [*reasons, f"{more} portal(s) beyond the {MAX_PORTALS} smallest"] if more else reasons
