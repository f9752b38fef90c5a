"""Arithmetic in pairs of floats, for devices without 64-bit floats: the number type ``real`` as {hi, lo}.

:func:`translate` turns kernel text written in ``real`` into OpenCL C that calls ``cl_kernels/number/float_float.cl``;
:func:`pack` and :func:`unpack` are the same numbers on the host.
"""

from .packing import pack, unpack

__all__ = ["pack", "translate", "unpack"]


def translate(text: str) -> str:
    """See :func:`pylmc.device.float_float.translation.translate`; the parser is loaded by those who need it only."""
    from .translation import translate

    return translate(text)
