"""What a scene is found to have that shapes proposals: its constraints of every kind, and what paths are aimed at."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

from ..settings import Settings
from . import KINDS
from .constraint import Constraint, Found

AIM_RADIUS, MAX_AIMED_OBJECTS = 0.05, 8
C = TypeVar("C", bound=Constraint)


@dataclass(frozen=True)
class ConstraintPlan:
    """``constraints``: what there is of each kind. ``aimed_objects``: the objects that the independent sampler aims at.

    ``left_out`` says in words what was dropped and why.
    """

    constraints: tuple[Constraint, ...]
    aimed_objects: tuple[int, ...]
    left_out: tuple[str, ...]

    def of(self, kind: type[C]) -> C:
        """What there is of one kind."""
        return next(constraint for constraint in self.constraints if isinstance(constraint, kind))

    def names(self, settings: Settings) -> list[str]:
        """The kinds that the kernels are to have with these settings."""
        return [constraint.name for constraint in self.constraints if constraint.applies(settings)]


def plan_constraints(found: Found) -> ConstraintPlan:
    """Decide which constraints a scene has."""
    constraints = tuple(kind.find(found) for kind in KINDS)
    left_out = [reason for constraint in constraints for reason in constraint.left_out()]
    aimed = [
        index
        for index, item in enumerate(found.objects)
        if item.bounding_radius < AIM_RADIUS * found.radius and not found.scene.shapes[item.shape].emission
    ]
    if len(aimed) > MAX_AIMED_OBJECTS:
        left_out.append(f"aiming at {len(aimed)} small objects: more than {MAX_AIMED_OBJECTS}, none is special")
        aimed = []
    return ConstraintPlan(constraints, tuple(aimed), tuple(left_out))
