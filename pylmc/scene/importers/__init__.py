"""Readers of scene files that others wrote."""

from .gltf import load_gltf

__all__ = ["load_gltf"]
