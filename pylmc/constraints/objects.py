"""Objects: a node stays on its small object, and a path's end on its emitter (theory.md, 5; eqs. (12), (17), (19))."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from ..geometry.objects import SceneObject
from ..scene.lights.light import Placement
from .constraint import Constraint, Found

SMALL = 0.1  # an object is small, in units of the scene's radius, if two of its half-extents are below this
FLAT = 1e-4  # half-extents below this part of the largest are no extent at all: the node is on the surface anyway


@dataclass(frozen=True, eq=False)
class Objects(Constraint):
    """``objects``: all of the scene's; ``weights`` (objects, 3): inverse half-extents along each one's axes, in inverse scene
    units, 0 where the constraint is infinite.

    Those of the ``small`` objects are not zero, and of the ``emitters``, on which paths that hit must land and which count
    as small at any size. Both are numbers of objects.
    """

    name: ClassVar[str] = "objects"
    structs: ClassVar[dict[str, list[Any]]] = {
        "SceneObject": [("axes", np.float64, (9,)), ("inverse_half", np.float64, (3,)), ("small", np.int32)]
    }
    arrays: ClassVar[dict[str, str]] = {"objects": "SceneObject"}

    objects: tuple[SceneObject, ...]
    weights: np.ndarray
    small: tuple[int, ...]
    emitters: tuple[int, ...]

    @classmethod
    def find(cls, found: Found) -> Self:
        emitting = {i for i, shape in enumerate(found.scene.shapes) if shape.emission}
        weights = np.zeros((len(found.objects), 3))
        small, emitters = [], []
        for index, item in enumerate(found.objects):
            half = np.asarray(item.half_extents)
            extended = half > FLAT * half.max()
            if item.shape in emitting:
                weights[index, extended] = 1 / half[extended]
                emitters.append(index)
            elif np.sort(half)[1] < SMALL * found.radius:
                bounded = extended & (half < SMALL * found.radius)
                weights[index, bounded] = 1 / half[bounded]
                small.append(index)
        return cls(tuple(found.objects), weights, tuple(small), tuple(emitters))

    @property
    def present(self) -> bool:
        return bool(self.small or self.emitters)

    def features(self) -> dict[str, Any]:
        """Without small objects, only a path's last node may be on one."""
        return {"HAS_SMALL_OBJECTS": bool(self.small)}

    def records(self, placement: Placement) -> dict[str, np.ndarray]:
        records = np.zeros(len(self.objects), self.structs["SceneObject"])
        for record, item, weights in zip(records, self.objects, self.weights, strict=True):
            record["axes"] = np.asarray(item.axes).ravel()
            record["inverse_half"] = weights * placement.scale
            record["small"] = bool(np.any(weights > 0))
        return {"objects": records}

    def lines(self) -> list[str]:
        """How many, and sizes of the small ones."""
        lines = []
        if self.small:
            halves = [self.objects[index].half_extents for index in self.small[:6]]
            sizes = ", ".join("x".join(f"{2 * h:.2g}" for h in half) for half in halves)
            lines.append(
                f"objects     {len(self.small)} small object(s), sizes {sizes}{', ...' if len(self.small) > 6 else ''}"
            )
        if self.emitters:
            lines.append(f"emitters    {len(self.emitters)} emitting object(s), for paths that end on one")
        return lines

    def left_out(self) -> list[str]:
        """The large ones."""
        large = len(self.objects) - len(self.small) - len(self.emitters)
        reasons = [f"{large} object(s) that are not small (two half-extents below {SMALL:g} scene radii)"] if large else []
        return reasons if self.small else [*reasons, "object constraints: no object is small"]
