"""One description of a struct for host and device: a NumPy dtype, laid out as the device's compiler does."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import numpy as np
import pyopencl as cl
from pyopencl.tools import get_or_register_dtype, match_dtype_to_c_struct

from ..errors import PylmcError
from .program import quiet


def declare(device: cl.Device, name: str, dtype: Any) -> tuple[np.dtype, str]:
    """(dtype, C declaration) of struct ``name`` with the fields of ``dtype``, padded as ``device`` pads them.

    Allocate host arrays with the returned dtype and pass the declaration to :func:`pylmc.device.program.build`. A struct
    nested in another must be declared first, and listed first there. May be called again, for other devices, and with
    other fields under the same name (a state that grows with the path length). Raises PylmcError where a field's type
    has no C counterpart or the device's compiler rejects the struct.
    """
    try:
        with quiet():
            matched, declaration = match_dtype_to_c_struct(device, name, np.dtype(dtype))
    except (ValueError, TypeError, NotImplementedError, RuntimeError, cl.Error) as error:
        raise PylmcError(f"struct '{name}' has no C layout on {device.name.strip()}: {error}") from error
    # Where the name already stands for other fields its first owner keeps it: pyopencl needs the registration only to
    # nest structs, and finds those by dtype.
    with suppress(RuntimeError):
        matched = get_or_register_dtype(name, matched)
    return matched, declaration
