"""Normals: one keeps within a radian as its node moves on a curved face (theory.md, 5; eqs. (17), (19))."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

from ..settings import Settings
from .constraint import Constraint, Found


@dataclass(frozen=True)
class Normals(Constraint):
    """``curved``: how many shapes have smooth normals."""

    name: ClassVar[str] = "normals"

    curved: int

    @classmethod
    def find(cls, found: Found) -> Self:
        return cls(sum(bool(shape.smooth) for shape in found.scene.shapes))

    @property
    def present(self) -> bool:
        return self.curved > 0

    def applies(self, settings: Settings) -> bool:
        """Not where normals are taken as fixed."""
        return super().applies(settings) and settings.differentials == "full"

    def lines(self) -> list[str]:
        return [f"normals     {self.curved} shape(s) with smooth normals"] if self.curved else []

    def left_out(self) -> list[str]:
        return [] if self.curved else ["normal constraints: all faces are flat"]
