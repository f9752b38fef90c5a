"""The camera."""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Real
from typing import Any

import numpy as np

from ..checks import check_integer
from ..errors import PylmcError
from .values import as_point

MAX_SIDE = 16384  # pixels along one side of the film


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole camera at ``origin`` looking at ``target``; ``fov`` is vertical, in degrees; size in pixels."""

    origin: Any
    target: Any
    up: Any = (0.0, 1.0, 0.0)
    fov: float = 45.0
    width: int = 256
    height: int = 256

    def __post_init__(self) -> None:
        for name in ("origin", "target", "up"):
            object.__setattr__(self, name, as_point(getattr(self, name), f"Camera.{name}"))
        if isinstance(self.fov, bool) or not isinstance(self.fov, Real) or not 0 < self.fov < 180:
            raise PylmcError(f"Camera.fov={self.fov!r}: the vertical field of view must lie between 0 and 180 degrees")
        for name in ("width", "height"):
            object.__setattr__(self, name, check_integer(f"Camera.{name}", getattr(self, name), 1, MAX_SIDE))
        forward = self.target - self.origin
        if not np.linalg.norm(forward) > 0:
            raise PylmcError("Camera: origin and target coincide; move the target to where the camera should look")
        if not np.linalg.norm(np.cross(forward, self.up)) > 1e-9 * np.linalg.norm(forward) * np.linalg.norm(self.up):
            raise PylmcError("Camera: up is parallel to the viewing direction; choose another up vector")

    def axes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Unit vectors (right, up, forward): the image's +x, its upward direction, and the optical axis."""
        forward = (self.target - self.origin) / np.linalg.norm(self.target - self.origin)
        right = np.cross(forward, self.up)
        right /= np.linalg.norm(right)
        return right, np.cross(right, forward), forward

    def resized(self, width: int, height: int) -> Camera:
        """The same view on another film (the vertical field of view is kept)."""
        return Camera(self.origin, self.target, self.up, self.fov, width, height)
