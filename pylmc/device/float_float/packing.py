"""Pairs of floats on the host."""

from __future__ import annotations

from typing import Any

import numpy as np


def split(values: Any) -> tuple[np.ndarray, np.ndarray]:
    """(hi, lo) as float32 of float64 ``values``: hi is the nearest float, lo the nearest to the rest.

    Their sum is within 2^-48 of the value, relatively, from 2^-77 to float32's greatest number; beyond that hi is infinite.
    lo is 0 where hi is not finite.
    """
    values = np.asarray(values, np.float64)
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        hi = values.astype(np.float32)
        lo = np.where(np.isfinite(hi), values - hi, 0.0).astype(np.float32)
    return hi, lo


def pack(values: Any) -> np.ndarray:
    """float64 ``values`` of any shape as the bits of (hi, lo) pairs: uint64 of the same shape."""
    hi, lo = split(values)
    return np.stack([hi, lo], axis=-1).view(np.uint64)[..., 0]


def unpack(bits: np.ndarray) -> np.ndarray:
    """The inverse of :func:`pack`: float64 of the shape of ``bits`` (exact: hi + lo fits unless they are 2^29 apart)."""
    pairs = np.ascontiguousarray(bits)[..., None].view(np.float32).astype(np.float64)
    return pairs[..., 0] + pairs[..., 1]
