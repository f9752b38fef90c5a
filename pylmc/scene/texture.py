"""Textures: images on surfaces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import PylmcError
from .values import RGB, fixed, real_numbers


@dataclass(frozen=True, eq=False)
class Texture:
    """An image looked up by a mesh's texture coordinates, repeated beyond [0, 1], bilinear.

    ``pixels`` is (height, width, 3) linear RGB, row 0 at the top (v = 1), as images are stored; they are copied.
    Raises PylmcError for another shape and for values outside [0, 1], NaN among them.
    """

    pixels: np.ndarray

    def __post_init__(self) -> None:
        try:
            pixels = real_numbers(self.pixels).astype(np.float32)
        except (TypeError, ValueError):
            raise PylmcError("Texture: pixels must be an array of numbers (height, width, 3), not a file name") from None
        if pixels.ndim != 3 or pixels.shape[2] != 3 or min(pixels.shape[:2]) < 1:
            raise PylmcError(f"Texture: pixels have shape {pixels.shape}; expected (height, width, 3)")
        if not np.all((pixels >= 0) & (pixels <= 1)):
            raise PylmcError("Texture: pixels must lie in [0, 1] (linear RGB); a surface cannot reflect more than it receives")
        object.__setattr__(self, "pixels", fixed(pixels))

    def mean(self) -> RGB:
        """The average colour, which stands for the texture where one colour is needed (lobe selection)."""
        m = self.pixels.reshape(-1, 3).mean(axis=0, dtype=np.float64)
        return (float(m[0]), float(m[1]), float(m[2]))
