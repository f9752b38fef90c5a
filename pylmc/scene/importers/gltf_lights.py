"""glTF's lights without area (KHR_lights_punctual): point, spot and directional."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...errors import PylmcError
from ..lights import DirectionalLight, Light, PointLight, SpotLight


def gltf_light(light: dict[str, Any], transform: np.ndarray) -> Light | None:
    """The light of a node that has this 4 by 4 transform, or None for one of no power.

    Spot and directional lights shine along the node's -z. Candela and lux count as watts. Raises PylmcError for a kind that
    the extension does not have.
    """
    kind = light["type"]
    if kind not in ("point", "spot", "directional"):
        raise PylmcError(f"a light is of type {kind!r}, not point, spot or directional; export the file again")
    colour = np.asarray(light.get("color", (1, 1, 1)), dtype=np.float64) * float(light.get("intensity", 1.0))
    position, along = transform[:3, 3], -transform[:3, 2]
    if not np.any(colour != 0):
        return None
    if kind == "directional":
        return DirectionalLight(along, colour)
    if kind == "spot":
        cone = light.get("spot", {})
        if not isinstance(cone, dict):
            raise PylmcError(f"'spot' is {cone!r}, not an object; export the file again")
        inner, outer = cone.get("innerConeAngle", 0.0), cone.get("outerConeAngle", math.pi / 4)
        if not all(isinstance(angle, int | float) for angle in (inner, outer)) or not 0 <= inner <= outer:
            raise PylmcError(
                f"innerConeAngle {inner!r} and outerConeAngle {outer!r} are no two angles in order; export it again"
            )
        return SpotLight(position, along, colour, math.degrees(inner), math.degrees(outer))
    return PointLight(position, colour)
