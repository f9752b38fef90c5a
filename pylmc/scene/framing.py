"""A camera and lights for scenes that came without."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..errors import PylmcError
from . import Camera, Shape
from .materials import Diffuse

AZIMUTH, ELEVATION = math.radians(35.0), math.radians(22.0)  # three-quarter view, from +z towards +x
FOV = 35.0  # degrees, vertical
MARGIN = 1.08
MOST_HALVINGS = 60  # of a light that the camera sees; what is seen even then is where the camera is
KEY_SHARE = 0.65  # of the irradiance at the scene's middle; the fill light gives the rest


def frame(shapes: Sequence[Shape], width: int, height: int) -> Camera:
    """A camera that sees all of ``shapes`` from the front, to the right and above (y is up)."""
    points = np.concatenate([shape.vertices for shape in shapes])
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    back = np.array([math.sin(AZIMUTH) * math.cos(ELEVATION), math.sin(ELEVATION), math.cos(AZIMUTH) * math.cos(ELEVATION)])
    right, up, _ = Camera(middle + back, middle, fov=FOV, width=width, height=height).axes()
    local = points - middle
    towards = local @ back
    tangent = math.tan(math.radians(FOV) / 2)
    vertical = towards + np.abs(local @ up) * MARGIN / tangent
    horizontal = towards + np.abs(local @ right) * MARGIN / (tangent * width / height)
    distance = max(vertical.max(), horizontal.max())
    return Camera(middle + distance * back, middle, fov=FOV, width=width, height=height)


def light_quads(shapes: Sequence[Shape], camera: Camera) -> list[Shape]:
    """A key light above and to the left of the camera and a weaker, larger fill light behind it, both unseen by it.

    Together they give a surface of reflectance 0.5 in the scene's middle, facing them, a radiance of about 0.5. Where
    the camera stands within the scene, as in a room, both stay within the free space around it.
    """
    corners = np.concatenate([shape.bounds() for shape in shapes])
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle, radius = (low + high) / 2, float(np.linalg.norm(high - low)) / 2
    right, up, forward = camera.axes()
    if np.all(camera.origin > low) and np.all(camera.origin < high):
        key = _quad_in_room(shapes, camera, middle, radius, up - 0.6 * right - forward)
        fill = _quad_in_room(shapes, camera, middle, radius, -forward)
    else:
        away = float(np.linalg.norm(camera.origin - middle))
        size = max(away, 1.6 * radius)
        step = 0
        while True:
            # Ever further back, until none of it is in the picture: at the latest behind the camera.
            towards = up - 0.6 * right - (0.6 + 0.4 * step) * forward
            towards /= np.linalg.norm(towards)
            key = _quad(middle + size * (1.2 + 0.3 * step) * towards, middle, 0.4 * size)
            if _unseen(camera, key):
                break
            step += 1
        behind = 1.1 * max(size, float((camera.origin - middle) @ -forward), float(((key - middle) @ -forward).max()))
        fill = _quad(middle - behind * forward, middle, 0.8 * behind)
    return [
        _light(key, middle, KEY_SHARE, "auto-light key"),
        _light(fill, middle, 1 - KEY_SHARE, "auto-light fill"),
    ]


def _quad_in_room(
    shapes: Sequence[Shape], camera: Camera, middle: np.ndarray, radius: float, direction: np.ndarray
) -> np.ndarray:
    """A quad's corners (4, 3) on the way from the camera along ``direction``, before anything is in the way."""
    direction = direction / np.linalg.norm(direction)
    reach = min(_free_distance(shapes, camera.origin, direction), radius)
    centre = camera.origin + 0.6 * reach * direction
    target = middle if np.linalg.norm(middle - centre) > 0.1 * reach else camera.target
    half = 0.3 * reach
    for _ in range(MOST_HALVINGS):
        if _unseen(camera, _quad(centre, target, half)):
            return _quad(centre, target, half)
        half /= 2
    raise PylmcError("Camera: there is no room behind it for a light, as it stands on a surface; move it, or add a light")


def _quad(centre: np.ndarray, target: np.ndarray, half: float) -> np.ndarray:
    """The corners (4, 3) of a square of half-side ``half`` that faces ``target``, counter-clockwise from there."""
    normal = (target - centre) / np.linalg.norm(target - centre)
    side = np.cross(np.eye(3)[np.argmin(np.abs(normal))], normal)
    side /= np.linalg.norm(side)
    other = np.cross(normal, side)
    return np.array([centre + half * (a * side + b * other) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))])


def _unseen(camera: Camera, corners: np.ndarray) -> bool:
    """Whether the corners lie all behind the camera, or all beyond one side of its picture."""
    right, up, forward = camera.axes()
    local = corners - camera.origin
    x, y, z = local @ right, local @ up, local @ forward
    top = math.tan(math.radians(camera.fov) / 2)
    side = top * camera.width / camera.height
    return bool(np.all(z < 0) or np.all(y > top * z) or np.all(-y > top * z) or np.all(x > side * z) or np.all(-x > side * z))


def _light(corners: np.ndarray, middle: np.ndarray, share: float, name: str) -> Shape:
    """The quad with the radiance that gives ``middle``, facing it, ``share`` of the irradiance π."""
    half = float(np.linalg.norm(corners[1] - corners[0])) / 2
    distance = float(np.linalg.norm(corners.mean(axis=0) - middle))
    ratio = half / distance
    slant = math.sqrt(1 + ratio * ratio)
    form_factor = 4 / math.pi * ratio / slant * math.atan(ratio / slant)
    return Shape((corners, [[0, 1, 2], [0, 2, 3]]), Diffuse(0.0), share / form_factor, name)


def _free_distance(shapes: Sequence[Shape], origin: np.ndarray, direction: np.ndarray) -> float:
    """How far a ray gets before it meets a triangle; infinite if it never does (Möller and Trumbore's test)."""
    nearest = math.inf
    for shape in shapes:
        corners = shape.vertices[shape.faces]
        edge1, edge2, offset = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], origin - corners[:, 0]
        p = np.cross(direction, edge2)
        q = np.cross(offset, edge1)
        det = np.einsum("fi,fi->f", edge1, p)
        with np.errstate(divide="ignore", invalid="ignore"):
            u, v = np.einsum("fi,fi->f", offset, p) / det, q @ direction / det
            t = np.einsum("fi,fi->f", edge2, q) / det
            hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
        nearest = min(nearest, float(t[hit].min(initial=math.inf)))
    return nearest
