"""What all materials are."""

from __future__ import annotations

from ...lobes import Lobe
from ..kinds import Kind
from ..texture import Texture


class Material(Kind):
    """Base of all materials, which are frozen dataclasses that check their fields. A subclass is registered by itself."""

    def textures(self) -> tuple[Texture, ...]:
        """The textures among the fields: a shape with any needs texture coordinates."""
        return tuple(value for value in vars(self).values() if isinstance(value, Texture))

    @property
    def texture(self) -> Texture | None:
        """The texture that is looked up at a node, if any: it multiplies what the lobes say that it does."""
        return next(iter(self.textures()), None)

    def lobes(self) -> list[Lobe]:
        """What the material is a sum of; the two of a pair follow each other."""
        raise TypeError(f"{type(self).__name__} says of no lobes what it is a sum of")
