"""Readers of scene files that others wrote: a file per format, found because it is in this folder."""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules

from .importer import Content, Importer

__all__ = ["Content", "Importer", "importers"]


def importers() -> dict[str, Importer]:
    """Who reads files of each suffix (".glb")."""
    for module in iter_modules(__path__):
        import_module(f".{module.name}", __name__)
    kinds: tuple[type[Importer], ...] = Importer.kinds
    return {suffix: kind() for kind in kinds for suffix in kind.suffixes}
