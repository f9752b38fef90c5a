"""Linear pictures of any scale, brought to what a screen shows."""

from __future__ import annotations

import numpy as np

from ..colour import LUMINANCE, srgb_encode

MIDDLE_GREY = 0.18


def exposure(image: np.ndarray) -> tuple[float, float]:
    """The factor that brings ``image`` (height, width, 3) to middle grey, and the exposed value that shall be white.

    Grey is the logarithmic mean of the lit pixels' luminance, raised where the brightest hundredth lies far above, so
    that a small beam in a dark room is not burnt out; single fireflies are among that hundredth and decide nothing.
    """
    pixels = np.where(np.isfinite(image), image, 0).astype(np.float64)
    luminance = pixels.clip(min=0) @ LUMINANCE
    lit = luminance[luminance > 0]
    if lit.size == 0:
        return 1.0, 1.0
    bright = float(np.percentile(lit, 99))
    typical = float(np.exp(np.log(lit[(lit >= 1e-6 * bright) & (lit <= bright)]).mean()))
    scale = MIDDLE_GREY / max(typical, bright / 32)
    return scale, max(1.0, bright * scale)


def tonemap(image: np.ndarray, exposed: tuple[float, float] | None = None) -> np.ndarray:
    """``image`` (height, width, 3), linear and of any scale, as sRGB uint8 for a screen.

    After `exposure` (or ``exposed``, to show several pictures alike) Reinhard's extended curve rolls the highlights
    off to white. Negative and NaN values become black, infinite ones white.
    """
    scale, white = exposure(image) if exposed is None else exposed
    pixels = np.nan_to_num(np.asarray(image, dtype=np.float64), nan=0.0, posinf=np.inf, neginf=0.0)
    pixels = np.minimum(pixels.clip(min=0) * scale, white)
    curved = pixels * (1 + pixels / white**2) / (1 + pixels)
    return np.rint(srgb_encode(curved) * 255).astype(np.uint8)
