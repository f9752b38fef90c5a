"""What can fill a film, registered by name: each is a file with a class (see pylmc/integrators/integrator.py) and a line here.

This list is all that the command line, the settings and :func:`pylmc.render` know of integrators. It loads none of them.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from ..sampling.sampler import Sampler
    from .integrator import Integrator


class Registered(NamedTuple):
    """The file and class of an integrator, and what it is in a few words."""

    file: str
    kind: str
    what: str


INTEGRATORS = {
    "lmc": Registered("lmc", "LangevinMonteCarlo", "Markov chains"),
    "bdpt": Registered("bdpt", "Bidirectional", "their independent bidirectional sampler alone"),
    "path": Registered("path", "PathTracer", "a unidirectional path tracer"),
}


def made(name: str, sampler: Sampler) -> Integrator:
    """The integrator of that name, for ``sampler``'s scene, settings and device."""
    registered = INTEGRATORS[name]
    new: Integrator = getattr(import_module(f".{registered.file}", __name__), registered.kind)(sampler)
    return new
