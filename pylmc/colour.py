"""Linear sRGB colours: their luminance, which host and kernels share, and the 8-bit form's curve."""

from __future__ import annotations

import numpy as np

LUMINANCE = np.array([0.212671, 0.715160, 0.072169])  # of the primaries: image @ LUMINANCE


def srgb_encode(linear: np.ndarray) -> np.ndarray:
    """Linear values as sRGB, clipped to [0, 1]."""
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 0.0031308) ** (1 / 2.4) - 0.055)


def srgb_decode(encoded: np.ndarray) -> np.ndarray:
    """sRGB values in [0, 1] as linear ones."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((np.maximum(encoded, 0) + 0.055) / 1.055) ** 2.4)
