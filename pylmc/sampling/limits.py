"""Where a precision cannot be right about a scene, said before anything is rendered.

Each threshold is the last value at which ``python -m bench.extremes`` found nothing wrong; the comment beside it says where
it first did (docs/extremes.md has all figures). Lengths are in the scaled scene's units, the kernels' own, in which its radius
is between one and two.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..constraints.lobes import alpha_of
from ..constraints.objects import Objects
from ..constraints.portals import Portals
from ..device.precision import nominal
from ..scene import Scene
from ..scene.lights.light import POINT
from .compiled import CompiledScene


@dataclass(frozen=True)
class Thresholds:
    """What a number type holds; nothing is known to go wrong above.

    Half-sizes of ``portals``, ``objects`` and ``emitters``; heights of ``camera`` and ``light`` above a surface; the camera's
    ``view``, the tangent of half its field times that height (1 at most: rays along a surface move their node 1/height as
    far); roughness ``alpha``.
    """

    portals: float
    objects: float
    emitters: float
    camera: float
    light: float
    view: float
    alpha: float


SINGLE = Thresholds(
    portals=4.9e-5,  # at 5e-6 z = 3.7, acceptance 0.81 for 0.88; at 5e-7 small steps are out of balance, z = 31
    objects=4.9e-5,  # at 5e-6 acceptance is 0.72 for 0.85; at 5e-7 30 % of the light is lost
    emitters=9e-5,  # at 1e-5 small steps are out of balance, z = 13.7
    camera=4.9e-6,  # at 5e-7 no light is found
    light=4.9e-6,  # at 5e-7 no light is found
    view=1.2e-5,  # at 2.5e-6 small steps are out of balance, z = 6.4; at 1.3e-7 z = 13
    alpha=9e-7,  # at 1e-7 a caustic is 10 % too bright, at 1e-8 2.8 times; mirrors' small steps are out of balance, z = 9.5
)
FLOAT32_RAYS = Thresholds(
    portals=4.9e-6,  # at 5e-7 acceptance is 0.71 for 0.88; at 5e-9 the picture is 470 times too bright
    objects=4.9e-5,  # at 5e-6 acceptance is 0.77 for 0.85, z = 2.8; at 5e-7 29 % of the light is lost
    emitters=9e-7,  # nothing went wrong at 1e-6
    camera=4.9e-6,  # at 5e-7 no light is found
    light=4.9e-6,  # as for the camera
    view=0.0,  # nothing went wrong at 1e-6
    alpha=0.0,  # nothing went wrong at 1e-8
)
DOUBLE = Thresholds(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)  # nothing went wrong anywhere


ON_SURFACE = 1e-13  # in scene radii: of a position in float64, this is nothing


def thresholds(precision: str) -> Thresholds:
    """Those of a precision's number types. Raises PylmcError for an unknown name."""
    kind = nominal(precision)
    if kind.trace == "double":
        return DOUBLE
    return SINGLE if kind.real == "float" else FLOAT32_RAYS


def limits(scene: Scene, compiled: CompiledScene, precision: str) -> list[str]:
    """What ``precision`` cannot be right about: sentences that name the thing, the place and the remedy; none for none."""
    own, mixed = thresholds(precision), thresholds("mixed")
    found: list[str] = []

    def check(what: str, value: float, name: str) -> None:
        if value < getattr(own, name):
            remedy = "mixed" if precision == "single" and value >= getattr(mixed, name) else "double"
            good_to = f"precision '{precision}' is known to be good to {getattr(own, name):.2g}"
            found.append(f"{what}: {value:.2g}, where {good_to}; light may be wrong or missing: use precision '{remedy}'")

    scale, plan = compiled.scale, compiled.plan
    for i, hole in enumerate(plan.of(Portals).portals):
        check(f"portal {i} at {_place(hole.centre)} is very small", min(hole.half_size) / scale, "portals")
    for item, weights in zip(compiled.objects, plan.of(Objects).weights, strict=True):
        if np.any(weights > 0):
            shape = scene.shapes[item.shape]
            what = f"'{shape.name or f'shape {item.shape}'}' at {_place(item.centre)} is very small"
            check(what, 1 / (float(weights.max()) * scale), "emitters" if shape.emission else "objects")
    height, shape_below = _height(scene, compiled, scene.camera.origin)
    check(f"the camera is very close to '{shape_below}'", height, "camera")
    check("the camera's view is very narrow, or along what it sees", _half_field(scene) * min(height, 1.0), "view")
    for i, light in enumerate(scene.lights):
        if light.place == POINT:
            height, shape_below = _height(scene, compiled, getattr(light, "position"))  # noqa: B009
            if height < ON_SURFACE:
                found.append(
                    f"light {i} lies on '{shape_below}': which side it shines to is decided by rounding, and integrators may "
                    "differ; move it off the surface"
                )
            else:
                check(f"light {i} is very close to '{shape_below}'", height, "light")
    for i, shape in enumerate(scene.shapes):
        alpha = alpha_of(shape.material)
        if alpha is not None:
            check(f"the roughness of '{shape.name or f'shape {i}'}' is very small", alpha, "alpha")
    return _shortened(found)


def _half_field(scene: Scene) -> float:
    """Tangent of half the narrower field of view."""
    camera = scene.camera
    return float(np.tan(np.radians(camera.fov) / 2) * min(1.0, camera.width / camera.height))


def _place(point: np.ndarray) -> str:
    return "(" + ", ".join(f"{x:.3g}" for x in point) + ")"


def _shortened(found: list[str], most: int = 8) -> list[str]:
    """A model of many tiny parts needs no line for each."""
    return found if len(found) <= most else [*found[:most], f"and {len(found) - most} more of this kind"]


def _height(scene: Scene, compiled: CompiledScene, point: np.ndarray) -> tuple[float, str]:
    """The least height (scaled) of ``point`` above a triangle that lies straight below it, and the name of its shape."""
    mesh = compiled.mesh
    corners = (mesh.vertices[mesh.faces] - point) / compiled.scale
    a, e1, e2 = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(e1, e2)
    size2 = np.sum(normal**2, axis=1)
    sound = size2 > 0
    u, v = (np.sum(np.cross(x, y) * normal, axis=1)[sound] / size2[sound] for x, y in ((-a, e2), (e1, -a)))
    height = np.abs(np.sum(a * normal, axis=1)[sound]) / np.sqrt(size2[sound])
    below = (u >= 0) & (v >= 0) & (u + v <= 1)
    if not below.any():
        return np.inf, ""
    nearest = int(np.argmin(np.where(below, height, np.inf)))
    index = int(mesh.shape_of_face[sound][nearest])
    return float(height[nearest]), scene.shapes[index].name or f"shape {index}"
