"""Lobes: a direction stays in its node's lobe (theory.md, 5; eqs. (13) to (16))."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

from ..scene import Material
from .constraint import Constraint, Found

NARROW_ALPHA = 0.3  # lobes narrower than this leave by the deviation chart, wider ones by a target chart


def alpha_of(material: Material) -> float | None:
    """GGX alpha of a material's narrowest lobe, or None where all have a constant width."""
    return min((lobe.width for lobe in material.lobes() if lobe.width is not None), default=None)


@dataclass(frozen=True)
class Lobes(Constraint):
    """``narrow``: names of shapes whose material has a narrow lobe; ``wide``: of glossy ones, with their alpha."""

    name: ClassVar[str] = "lobes"

    narrow: tuple[str, ...]
    wide: tuple[tuple[str, float], ...]

    @classmethod
    def find(cls, found: Found) -> Self:
        """The materials of the scene, each by the last shape that it is on."""
        shapes = found.scene.shapes
        alphas = {id(s.material): (s.name or f"shape {i}", alpha_of(s.material)) for i, s in enumerate(shapes)}
        glossy = [(name, alpha) for name, alpha in alphas.values() if alpha is not None]
        narrow = tuple(name for name, alpha in glossy if alpha < NARROW_ALPHA)
        return cls(narrow, tuple((name, alpha) for name, alpha in glossy if alpha >= NARROW_ALPHA))

    @property
    def present(self) -> bool:
        """Always: lobes of constant width bound a dependent direction to one radian."""
        return True

    def lines(self) -> list[str]:
        """How many lobes are narrow, and whose."""
        if not self.narrow:
            return []
        names = ", ".join(self.narrow[:6]) + (", ..." if len(self.narrow) > 6 else "")
        return [f"lobes       {len(self.narrow)} narrow material(s), alpha < {NARROW_ALPHA:g}: {names}"]

    def left_out(self) -> list[str]:
        """The wide ones."""
        wide = [f"lobe of '{name}': alpha={alpha:g} is wide, its directions take target charts" for name, alpha in self.wide]
        return wide if self.narrow else [*wide, "lobe constraints: no lobe is narrow"]
