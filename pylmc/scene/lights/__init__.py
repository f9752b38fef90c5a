"""Lights that are no surfaces: a file each."""

from .point import PointLight

__all__ = ["PointLight"]
