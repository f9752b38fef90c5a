"""A node as a scatterer: what the formulas of all lobes read."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from pylmc.lobes import KINDS

from ..vectors import Array, dot

REFERENCE_OF = np.array([kind.reference for kind in KINDS])
PAIR_OF = np.array([kind.pair for kind in KINDS])


@dataclass(frozen=True)
class Surface:
    """Nodes' local properties, batched: geometric and shading normal, texture colour, material record, lobe.

    A lobe is its kind's number: no material of the tests has two of one kind.
    """

    x: Array
    ng: Array
    ns: Array
    tint: Array
    material: Array
    lobe: Array

    def take(self, which: Any) -> Surface:
        """A part of the nodes."""
        return Surface(*(getattr(self, field.name)[which] for field in fields(self)))

    @property
    def alpha(self) -> Array:
        """GGX roughness; of lobes without one, any positive number."""
        return np.maximum(self.material["alpha"].astype(float), 1e-9)

    def index_ratio(self, w: Array) -> Array:
        """Index of the far side over that of w's side."""
        ior = np.where(self.material["ior"] > 0, self.material["ior"], 1.0).astype(float)
        return np.where(dot(self.ns, w) > 0, ior, 1 / ior)

    def normal_towards(self, w: Array) -> Array:
        """The shading normal on w's side."""
        return np.where(dot(self.ns, w)[:, None] > 0, self.ns, -self.ns)

    def same_side(self, a: Array, b: Array) -> Array:
        """Whether two directions are on one side, by both normals."""
        return (dot(self.ns, a) * dot(self.ns, b) > 0) & (dot(self.ng, a) * dot(self.ng, b) > 0)

    def _of_lobe(self, name: str) -> Array:
        return np.take_along_axis(self.material[name], np.maximum(self.lobe, 0)[:, None], axis=1)[:, 0]

    @property
    def choice(self) -> Array:
        """The probability with which the material chooses the lobe; of a pair's two lobes, which are one choice, of both."""
        return self._of_lobe("choice").astype(float)

    @property
    def has_lobe(self) -> Array:
        """Whether the material has the lobe at all."""
        return self.choice > 0

    @property
    def narrow(self) -> Array:
        """Whether the node scatters as a near-mirror: a property of material and lobe alone."""
        return self._of_lobe("narrow") != 0

    def refers_to(self, reference: str) -> Array:
        """Whether the lobe's deviations are counted from this reference direction."""
        return REFERENCE_OF[self.lobe] == reference
