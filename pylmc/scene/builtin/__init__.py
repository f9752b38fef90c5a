"""The built-in scenes: a file each, found because it is in this folder.

A scene's file has a docstring, whose first line says what is seen, and ``build``, whose arguments are the scene's parameters,
each annotated with a :class:`Parameter`. Files whose names begin with an underscore are shared by scenes.
"""

from __future__ import annotations

import inspect
from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType
from typing import Any, get_args, get_type_hints

from ...errors import PylmcError
from ..scene import Scene
from ._parameter import Parameter

NAMES = tuple(sorted(module.name for module in iter_modules(__path__) if not module.name.startswith("_")))

__all__ = ["NAMES", "Parameter", "build", "parameters", "summary"]


def _module(name: str) -> ModuleType:
    return import_module(f".{name}", __name__)


def summary(name: str) -> str:
    """What is seen in a scene, in a line."""
    return (inspect.getdoc(_module(name)) or "").partition("\n")[0]


def parameters(name: str) -> dict[str, tuple[float, Parameter]]:
    """A scene's parameters: their defaults, and what else there is to know of them."""
    function = _module(name).build
    hints = get_type_hints(function, include_extras=True)
    return {key: (item.default, get_args(hints[key])[1]) for key, item in inspect.signature(function).parameters.items()}


def build(name: str, values: dict[str, Any]) -> Scene:
    """A scene by name; raises PylmcError for a parameter that it lacks, and for a value out of range."""
    known = parameters(name)
    for key in values:
        if key not in known:
            raise PylmcError(f"scene '{name}' has no parameter '{key}'; it has {', '.join(known)}")
    checked = {key: known[key][1].check(f"scene '{name}': {key}", value) for key, value in values.items()}
    scene: Scene = _module(name).build(**checked)
    return scene
