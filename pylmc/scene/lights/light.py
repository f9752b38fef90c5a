"""What all lights are that are no surfaces."""

from __future__ import annotations

from ..kinds import Kind


class Light(Kind):
    """Base of all lights, which are frozen dataclasses that check their fields. A subclass is registered by itself."""
