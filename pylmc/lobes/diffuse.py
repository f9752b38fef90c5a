"""Lambertian reflection: f = reflectance / pi, counted from the normal."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from .base import COLOUR, NORMAL, Lobe


@dataclass(frozen=True, kw_only=True)
class Diffuse(Lobe):
    """``diffuse``: the reflectance, linear RGB; the material's texture multiplies it."""

    name: ClassVar[str] = "diffuse"
    reference: ClassVar[str] = NORMAL
    fields: ClassVar[list[Any]] = [("diffuse", *COLOUR)]

    diffuse: Any
