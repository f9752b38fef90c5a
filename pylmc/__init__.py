"""pylmc: Markov-chain light transport on any OpenCL device, with constraint-preconditioned Langevin proposals.

Names are imported when they are first used, so that ``import pylmc`` costs next to nothing. No module may be called as
one of these names is: importing it would put the module in the name's place.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from . import caches

if TYPE_CHECKING:
    from .device.arrays import Film as Film
    from .device.arrays import FilmSlot as FilmSlot
    from .device.raytracer import RayTracer as RayTracer
    from .errors import PylmcError as PylmcError
    from .errors import PylmcWarning as PylmcWarning
    from .inspection import info as info
    from .lobes.base import Lobe as Lobe
    from .picture.estimators import Estimator as Estimator
    from .rendering import Render as Render
    from .rendering import render as render
    from .sampling.chains import State as State
    from .sampling.groups import Group as Group
    from .sampling.sampler import Sampler as Sampler
    from .sampling.states import ChainArrays as ChainArrays
    from .sampling.states import Counters as Counters
    from .sampling.states import States as States
    from .sampling.states import Trial as Trial
    from .scene import *  # noqa: F403
    from .scene.loading import load as load
    from .settings import Settings as Settings

    __version__: str
    __all__: list[str]

caches.mend()

_HOME = {
    "errors": ("PylmcError", "PylmcWarning"),
    "inspection": ("info",),
    "scene.loading": ("load",),
    "device.arrays": ("Film", "FilmSlot"),
    "device.raytracer": ("RayTracer",),
    "lobes.base": ("Lobe",),
    "picture.estimators": ("Estimator",),
    "rendering": ("Render", "render"),
    "sampling.chains": ("State",),
    "sampling.groups": ("Group",),
    "sampling.sampler": ("Sampler",),
    "sampling.states": ("ChainArrays", "Counters", "States", "Trial"),
    "settings": ("Settings",),
}
_MODULE_OF = {name: module for module, names in _HOME.items() for name in names}


def __getattr__(name: str) -> Any:
    if name == "__version__":
        value: Any = _version()
    elif name == "__all__":  # asked for by `from pylmc import *`
        value = sorted([*_MODULE_OF, *_scene().NAMES])
    elif name in _MODULE_OF:
        value = getattr(import_module(f".{_MODULE_OF[name]}", __name__), name)
    elif name[:1].isupper() and name in _scene().NAMES:  # only classes have such names, so that no other loads the scene
        value = getattr(_scene(), name)
    else:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__getattr__("__all__"), "__version__"})


def _scene() -> Any:
    """What describes a scene: it knows the materials and lights that it offers."""
    return import_module(".scene", __name__)


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("pylmc")
    except PackageNotFoundError:  # run from a checkout that is not installed
        return "0.0.0"
