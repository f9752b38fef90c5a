"""What all kinds of constraints are: the host decides whether a scene has one and how wide it is, the kernels add its rows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np

from ..geometry.objects import SceneObject
from ..scene import Portal, Scene
from ..scene.lights.light import Placement
from ..settings import Settings


class Found(NamedTuple):
    """What constraints are decided by: the scene, and what was found in it. ``radius`` is its, in scene units."""

    scene: Scene
    objects: Sequence[SceneObject]
    portals: Sequence[Portal]
    radius: float


class Constraint:
    """Base of all kinds, which are frozen dataclasses of what a scene has of that kind. A subclass is registered by itself.

    Class attributes. ``name``: as the setting ``constraints`` has it, of the kernel file and of the function in it.
    ``structs`` and ``arrays``: what its kernels read beyond the scene, as pylmc/device/tables.py has them.
    """

    name: ClassVar[str] = ""
    structs: ClassVar[dict[str, list[Any]]] = {}
    arrays: ClassVar[dict[str, str]] = {}
    kinds: ClassVar[list[type[Constraint]]] = []

    def __init_subclass__(cls, **keywords: Any) -> None:
        super().__init_subclass__(**keywords)
        Constraint.kinds.append(cls)

    @classmethod
    def find(cls, found: Found) -> Self:
        """What there is of this kind in a scene; it may be nothing."""
        raise TypeError(f"{cls.__name__} finds nothing")

    @property
    def present(self) -> bool:
        """Whether the scene has any."""
        raise TypeError(f"{type(self).__name__} does not say whether it is there")

    def applies(self, settings: Settings) -> bool:
        """Whether the kernels add rows of this kind with these settings."""
        return self.present and self.name in settings.constraints

    def features(self) -> dict[str, Any]:
        """Constants that specialise the kernels."""
        return {}

    def records(self, placement: Placement) -> dict[str, np.ndarray]:
        """The content of ``arrays``, in the compiled scene's units."""
        return {}

    def lines(self) -> list[str]:
        """What `pylmc info` says of it."""
        return []

    def left_out(self) -> list[str]:
        """What does not constrain, and why."""
        return []
