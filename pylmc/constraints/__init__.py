"""Which constraints a scene has, a file for each kind, and how they combine into the preconditioner.

A kind is added by its name in ``pylmc.settings.CONSTRAINTS``, which is also its module's and its kernel file's.
"""

from importlib import import_module

from ..settings import CONSTRAINTS
from .constraint import Constraint

for _name in CONSTRAINTS:
    import_module(f".{_name}", __name__)
KINDS: tuple[type[Constraint], ...] = tuple(sorted(Constraint.kinds, key=lambda kind: CONSTRAINTS.index(kind.name)))
