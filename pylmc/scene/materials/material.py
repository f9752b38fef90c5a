"""What all materials are."""

from __future__ import annotations

from ..kinds import Kind
from ..texture import Texture


class Material(Kind):
    """Base of all materials, which are frozen dataclasses that check their fields. A subclass is registered by itself."""

    def textures(self) -> tuple[Texture, ...]:
        """The textures among the fields: a shape with any needs texture coordinates."""
        return tuple(value for value in vars(self).values() if isinstance(value, Texture))
