"""The scene's lights as arrays for the device: those without area, and the triangles that emit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..colour import LUMINANCE
from ..device import tables
from ..errors import PylmcError
from ..scene import Light, Scene
from ..scene.lights.light import Placement


@dataclass(frozen=True, eq=False)
class LightArrays:
    """``arrays`` by name, light scaled to a total of about one; ``radiance_scale`` undoes that.

    ``emitter_of_shape``: each shape's number among the emitters, or -1. ``kinds``: of lights without area.
    """

    arrays: dict[str, np.ndarray]
    emitter_of_shape: np.ndarray
    kinds: tuple[type[Light], ...]
    radiance_scale: float


def power_of_two(value: float) -> float:
    """The power of two nearest to a positive number, from below."""
    return float(2.0 ** np.floor(np.log2(value)))


def light_arrays(scene: Scene, areas: np.ndarray, shape_of: np.ndarray, placement: Placement) -> LightArrays:
    """The lights of ``scene``. ``areas`` and ``shape_of`` (F,): its triangles' areas when compiled, and their shapes.

    Raises PylmcError where none of them gives light.
    """
    areas = areas.astype(np.float64)
    radiances = np.array([shape.emission or (0.0, 0.0, 0.0) for shape in scene.shapes])
    strengths = np.array([light.strength(placement) for light in scene.lights]).reshape(-1, 3)
    light_power = strengths @ LUMINANCE
    triangle_power = areas * (radiances @ LUMINANCE)[shape_of]
    total = float(light_power.sum() + triangle_power.sum())
    if not total > 0:
        raise PylmcError("Scene: its lights have no power or no area; enlarge the emitting shapes or add a PointLight")
    exposure = 1 / power_of_two(total)

    kinds = tuple(kind for kind in Light.kinds if any(type(light) is kind for light in scene.lights))
    lights = np.zeros(len(scene.lights), tables.light_record(kinds))
    if len(lights):
        lights["intensity"] = strengths * exposure
        lights["cumulative"] = np.cumsum(_shares(light_power))
    for record, light in zip(lights, scene.lights, strict=True):
        record["kind"] = tables.light_number(type(light))
        for name, value in light.values(placement).items():
            record[name] = value
    emitting = np.flatnonzero(triangle_power > 0)
    emitter_of_shape = np.full(len(scene.shapes), -1)
    shining = np.unique(shape_of[emitting])
    emitter_of_shape[shining] = np.arange(len(shining))
    emitters = np.zeros(len(shining), tables.EMITTER)
    emitters["radiance"] = radiances[shining] * exposure
    # a shape by its share, a triangle of it by area: the density per area is the same all over a shape
    shape_areas = np.bincount(shape_of[emitting], weights=areas[emitting], minlength=len(scene.shapes))[shining]
    shape_power = np.bincount(shape_of[emitting], weights=triangle_power[emitting], minlength=len(scene.shapes))[shining]
    density = _shares(shape_power) / shape_areas
    emitters["density"] = density
    cdf = np.cumsum(areas[emitting] * density[emitter_of_shape[shape_of[emitting]]])
    arrays = {
        "lights": lights,
        "emitters": emitters,
        "emitter_cdf": cdf,
        "emitter_triangles": emitting.astype(np.int32),
    }
    return LightArrays(arrays, emitter_of_shape, kinds, 1 / exposure)


def _shares(power: np.ndarray) -> np.ndarray:
    """Each light's probability: half by power, half alike, for the brightest lamp may be one that nobody sees."""
    return (power / power.sum() + 1 / len(power)) / 2 if len(power) else power
