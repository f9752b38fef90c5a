"""The number types of a run: what rays are traced in, and what paths, integrand and densities are computed in.

=============  ==========================  =====================================================================
``single``     rays float32, paths float32  the fastest; details below about 1e-6 of the scene are lost
``mixed``      rays float32, paths float64  the hit triangle is solved again in float64; in pairs of floats where
                                            the device has no 64-bit floats
``float-float`` rays float32, paths pairs   what ``mixed`` falls back to, by name
``double``     rays float64, paths float64  needs a device with 64-bit floats
=============  ==========================  =====================================================================

Kernels are written once, in a type ``real`` (``cl_kernels/number/real.cl``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..checks import check_choice
from ..errors import PylmcError
from ..settings import PRECISIONS

REALS = ("float", "double", "pair")
NAME_OF_REAL = {"float": "float32", "double": "float64", "pair": "pairs of float32"}


@dataclass(frozen=True)
class Precision:
    """``real``: type of paths, integrand and densities (one of REALS); ``trace``: of rays and the tree (float or double)."""

    name: str
    real: str
    trace: str = "float"

    @property
    def host(self) -> np.dtype:
        """What a ``real`` is in NumPy arrays on the host: float32, or float64 for both longer types."""
        return np.dtype(np.float32 if self.real == "float" else np.float64)

    @property
    def device(self) -> np.dtype:
        """What a ``real`` is in device buffers: a pair of floats travels as 64 bits."""
        return np.dtype(np.uint64) if self.real == "pair" else self.host

    @property
    def trace_dtype(self) -> np.dtype:
        """The tree's number type."""
        return np.dtype(np.float64 if self.trace == "double" else np.float32)

    @property
    def epsilon(self) -> float:
        """The relative rounding error of one operation on ``real``, about."""
        return {"float": 2.0**-24, "double": 2.0**-53, "pair": 2.0**-44}[self.real]

    def to_device(self, array: np.ndarray) -> np.ndarray:
        """An array of reals (or of structs whose reals are float64, see pylmc.device.tables) as device buffers hold it."""
        return _convert(array, self.device, _pack if self.real == "pair" else None)

    def to_host(self, array: np.ndarray) -> np.ndarray:
        """The inverse: reals as ``host`` type."""
        return _convert(array, self.host, _unpack if self.real == "pair" else None)


def real_fields(dtype: Any, real: np.dtype) -> np.dtype:
    """A struct's dtype with every float64 or pair of floats (both mean ``real``) replaced by ``real``; nested ones too."""
    dtype = np.dtype(dtype)
    if dtype.subdtype is not None:
        base, shape = dtype.subdtype
        return np.dtype((real_fields(base, real), shape))
    if dtype.names is None:
        return real if dtype in (np.float64, np.uint64, np.float32) else dtype
    return np.dtype([(name, real_fields(dtype.fields[name][0], real)) for name in dtype.names])


def _convert(array: np.ndarray, real: np.dtype, code: Any) -> np.ndarray:
    if array.dtype.names is None:
        if array.dtype not in (np.float64, np.float32, np.uint64):
            return array
        return code(array) if code is not None else array.astype(real, copy=False)
    out = np.zeros(array.shape, real_fields(array.dtype, real))
    for name in array.dtype.names:
        out[name] = _convert(array[name], real, code)
    return out


def _pack(array: np.ndarray) -> np.ndarray:
    from .float_float import pack

    return pack(array.astype(np.float64, copy=False))


def _unpack(array: np.ndarray) -> np.ndarray:
    from .float_float import unpack

    return unpack(array)


def nominal(name: str) -> Precision:
    """The precision of that name on a device with 64-bit floats. Raises PylmcError for an unknown name."""
    check_choice("precision", name, PRECISIONS)
    real = {"single": "float", "mixed": "double", "double": "double", "float-float": "pair"}[name]
    return Precision(name, real, "double" if name == "double" else "float")


def on_device(name: str, device: Any) -> Precision:
    """The same on ``device`` (a ``pyopencl.Device``): ``mixed`` turns to pairs of floats where it has no 64-bit floats.

    Raises PylmcError for an unknown name, and for ``double`` on such a device.
    """
    precision = nominal(name)
    if precision.real != "double" or "cl_khr_fp64" in device.extensions:
        return precision
    if name == "double":
        raise PylmcError(
            f"{device.name.strip()} has no 64-bit floats (cl_khr_fp64), which precision 'double' needs: use "
            "'mixed' (paths in pairs of floats there), or another device (pylmc devices lists them)"
        )
    return Precision(name, "pair")
