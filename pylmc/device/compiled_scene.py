"""What the device takes of a scene; pylmc.sampling.compiled makes it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..constraints.plan import ConstraintPlan
from ..geometry.mesh import Mesh
from ..geometry.objects import SceneObject
from ..lobes import Lobe
from ..scene import Light, Portal


@dataclass(frozen=True, eq=False)
class CompiledScene:
    """What is found in a scene, its arrays for the device, kernel constants, and what undoes the scaling.

    ``mesh``, ``portals`` (given or found) and ``objects`` are in scene units; ``plan`` lists the constraints that they make.
    ``arrays`` by name (see ``SCENE_ARRAYS`` in pylmc/device/tables.py) are scaled; ``features`` are the kernel constants,
    ``lobe_kinds`` and ``light_kinds`` the kinds of lobes and of lights without area; ``endings`` which of connect (0) and hit
    (1) the scene has. ``radiance_scale``: multiply a rendered radiance by this to return to the scene's units.
    """

    mesh: Mesh
    portals: tuple[Portal, ...]
    objects: tuple[SceneObject, ...]
    plan: ConstraintPlan
    arrays: dict[str, np.ndarray]
    features: dict[str, Any]
    lobe_kinds: tuple[type[Lobe], ...]
    light_kinds: tuple[type[Light], ...]
    endings: tuple[int, ...]
    centre: np.ndarray
    scale: float
    radiance_scale: float
