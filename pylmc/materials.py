"""Materials: what a surface does to light, as sums of lobes.

Diffuse and conductor surfaces scatter on both sides; a dielectric separates an inside (against the normal) from an
outside. Reflectances are linear RGB in [0, 1].
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .checks import check_number
from .errors import PylmcError

RGB = tuple[float, float, float]
BRIGHTEST = 1e36  # light in the scene's units; pictures are float32


def as_rgb(value: Any, what: str, upper: float | None = None) -> RGB:
    """A grey level or three numbers as linear RGB; raises PylmcError naming ``what`` if that cannot be."""
    try:
        rgb = np.broadcast_to(np.asarray(value, dtype=np.float64), 3)
    except (TypeError, ValueError):
        raise PylmcError(f"{what}: {value!r} is not a colour; give one number or three (linear RGB)") from None
    if not np.all((rgb >= 0) & (rgb <= BRIGHTEST)):
        raise PylmcError(f"{what}: {value!r} must lie between 0 and {BRIGHTEST:g}")
    if upper is not None and np.any(rgb > upper):
        raise PylmcError(f"{what}: {value!r} exceeds {upper:g}; a surface cannot reflect more light than it receives")
    return (float(rgb[0]), float(rgb[1]), float(rgb[2]))


def _check_alpha(alpha: Any, what: str) -> float:
    try:
        alpha = float(alpha)
    except (TypeError, ValueError):
        raise PylmcError(f"{what}: roughness {alpha!r} is not a number") from None
    if not 0 < alpha <= 1:
        raise PylmcError(f"{what}: roughness alpha={alpha:g} must lie in (0, 1]; for a near-mirror try 1e-3")
    return alpha


def _check_masking(masking: Any, what: str) -> None:
    if masking not in ("height-correlated", "separable"):
        raise PylmcError(f"{what}: masking {masking!r} is unknown; use 'height-correlated' or 'separable'")


@dataclass(frozen=True, eq=False)
class Texture:
    """An image looked up by a mesh's texture coordinates, repeated beyond [0, 1], bilinear.

    ``pixels`` is (height, width, 3) linear RGB, row 0 at the top (v = 1), as images are stored.
    """

    pixels: np.ndarray

    def __post_init__(self) -> None:
        try:
            pixels = np.ascontiguousarray(self.pixels, dtype=np.float32)
        except (TypeError, ValueError):
            raise PylmcError("Texture: pixels must be an array of numbers (height, width, 3), not a file name") from None
        if pixels.ndim != 3 or pixels.shape[2] != 3 or min(pixels.shape[:2]) < 1:
            raise PylmcError(f"Texture: pixels have shape {pixels.shape}; expected (height, width, 3)")
        if not np.all((pixels >= 0) & (pixels <= 1)):
            raise PylmcError("Texture: pixels must lie in [0, 1] (linear RGB); a surface cannot reflect more than it receives")
        object.__setattr__(self, "pixels", pixels)

    def mean(self) -> RGB:
        """The average colour, which stands for the texture where one colour is needed (lobe selection)."""
        m = self.pixels.reshape(-1, 3).mean(axis=0, dtype=np.float64)
        return (float(m[0]), float(m[1]), float(m[2]))


@dataclass(frozen=True)
class Diffuse:
    """Lambertian reflection on both sides: f = reflectance / pi. Its reference direction is the normal."""

    reflectance: Any = 0.5

    def __post_init__(self) -> None:
        if not isinstance(self.reflectance, Texture):
            object.__setattr__(self, "reflectance", as_rgb(self.reflectance, "Diffuse.reflectance", 1.0))


@dataclass(frozen=True)
class RoughConductor:
    """GGX reflection of roughness ``alpha`` with the Smith term, Fresnel factor ``reflectance``, on both sides.

    ``alpha`` is the microfacet slope width itself (not its square root). Its reference is the mirror direction.
    ``masking`` is Smith's term, ``height-correlated`` or ``separable`` (what Mitsuba 3 uses; they agree as alpha -> 0).
    """

    alpha: float = 0.1
    reflectance: Any = 1.0
    masking: str = "height-correlated"

    def __post_init__(self) -> None:
        object.__setattr__(self, "alpha", _check_alpha(self.alpha, "RoughConductor"))
        _check_masking(self.masking, "RoughConductor")
        object.__setattr__(self, "reflectance", as_rgb(self.reflectance, "RoughConductor.reflectance", 1.0))


@dataclass(frozen=True)
class RoughDielectric:
    """GGX interface (Walter et al. 2007) between outside and a medium of relative index ``ior`` inside.

    Reflects and refracts; radiance carries the 1/eta^2 of the solid-angle compression, as seen from the camera.
    ``masking`` as for RoughConductor.
    """

    alpha: float = 0.1
    ior: float = 1.5
    masking: str = "height-correlated"

    def __post_init__(self) -> None:
        object.__setattr__(self, "alpha", _check_alpha(self.alpha, "RoughDielectric"))
        _check_masking(self.masking, "RoughDielectric")
        try:
            ior = float(self.ior)
        except (TypeError, ValueError):
            raise PylmcError(f"RoughDielectric: ior {self.ior!r} is not a number") from None
        if not (np.isfinite(ior) and ior > 0 and abs(ior - 1) > 1e-3):
            raise PylmcError(f"RoughDielectric: ior={ior:g} must be positive and differ from 1 (glass: 1.5)")
        object.__setattr__(self, "ior", ior)


@dataclass(frozen=True)
class MetallicRoughness:
    """glTF's material: a diffuse and a GGX lobe, blended by ``metallic``; alpha = roughness squared.

    diffuse = 0.96 base_color (1 - metallic); specular F0 = mix(0.04, base_color, metallic) with Schlick's Fresnel.
    """

    base_color: Any = 1.0
    metallic: float = 0.0
    roughness: float = 0.5

    def __post_init__(self) -> None:
        if not isinstance(self.base_color, Texture):
            object.__setattr__(self, "base_color", as_rgb(self.base_color, "MetallicRoughness.base_color", 1.0))
        for name in ("metallic", "roughness"):
            object.__setattr__(self, name, check_number(f"MetallicRoughness.{name}", getattr(self, name), 0, 1))


Material = Diffuse | RoughConductor | RoughDielectric | MetallicRoughness
