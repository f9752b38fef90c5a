"""A kind of thing, such as a material, that knows its classes: whoever subclasses it is registered by that."""

from __future__ import annotations

from typing import Any, ClassVar

from ..errors import PylmcError


class Kind:
    """Base of the base classes. A direct subclass is a kind; what is derived from it is registered in its ``kinds``."""

    kinds: ClassVar[tuple[type, ...]] = ()  # of this kind, in the order of their definition

    def __init_subclass__(cls, **keywords: Any) -> None:
        super().__init_subclass__(**keywords)
        if Kind in cls.__bases__:
            cls.kinds = ()
            return
        home = next(base for base in cls.__mro__ if issubclass(base, Kind) and Kind in base.__bases__)
        home.kinds = (*home.kinds, cls)

    @classmethod
    def names(cls) -> str:
        """The classes of this kind as an error message offers them: "Diffuse, RoughConductor or RoughDielectric"."""
        *most, last = sorted(kind.__name__ for kind in cls.kinds)
        return f"{', '.join(most)} or {last}" if most else last

    @classmethod
    def check(cls, value: Any, what: str) -> None:
        """Raise PylmcError, naming ``what`` and the classes there are, unless ``value`` is of this kind."""
        if not isinstance(value, cls):
            raise PylmcError(f"{what} is a {type(value).__name__}, not a {cls.__name__.lower()}; use {cls.names()}")
