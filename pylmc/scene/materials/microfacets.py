"""What materials with microfacets have in common: their parameters, checked."""

from __future__ import annotations

from typing import Any

from ...errors import PylmcError

MAX_IOR = 100.0  # of any pair of media, with room to spare: beyond it nothing is let through that float32 could tell from zero


def check_alpha(alpha: Any, what: str) -> float:
    try:
        alpha = float(alpha)
    except (TypeError, ValueError):
        raise PylmcError(f"{what}: roughness {alpha!r} is not a number") from None
    if not 0 < alpha <= 1:
        raise PylmcError(f"{what}: roughness alpha={alpha:g} must lie in (0, 1]; for a near-mirror try 1e-3")
    return alpha


def check_masking(masking: Any, what: str) -> None:
    if masking not in ("height-correlated", "separable"):
        raise PylmcError(f"{what}: masking {masking!r} is unknown; use 'height-correlated' or 'separable'")


def check_ior(ior: Any, what: str) -> float:
    """``ior`` as a float; what else is asked of it, the material says."""
    try:
        ior = float(ior)
    except (TypeError, ValueError):
        raise PylmcError(f"{what}: ior {ior!r} is not a number") from None
    return ior
