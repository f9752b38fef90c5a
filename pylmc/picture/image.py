"""Pictures in and out: linear float EXR with metadata, and a tone-mapped PNG for looking at."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio

from ..errors import PylmcError
from .replacement import Replacement

PREFIX = "pylmc:"
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # of linear sRGB primaries
MIDDLE_GREY = 0.18


def write_exr(
    path: str | Path, image: np.ndarray, metadata: Mapping[str, Any] | None = None, files: Replacement | None = None
) -> None:
    """Write ``image`` (height, width, 3), linear, as float32 EXR; ``metadata`` as strings named "pylmc:<key>".

    The file appears when it is whole, or with the others of ``files``. Raises PylmcError if it cannot be written.
    """
    pixels = np.ascontiguousarray(_as_rgb(image, path), dtype=np.float32)
    height, width, _ = pixels.shape
    spec = oiio.ImageSpec(width, height, 3, "float")
    spec.attribute("compression", "zip")
    for key, value in (metadata or {}).items():
        spec.attribute(key if key.startswith(PREFIX) else PREFIX + key, str(value))
    _write(path, "exr", spec, pixels, files)


def read_exr(path: str | Path) -> tuple[np.ndarray, dict[str, str]]:
    """A picture's pixels (height, width, 3), float32, and its "pylmc:" metadata without that prefix.

    Reads whatever OpenImageIO reads. 8- and 16-bit formats are taken as sRGB and returned linear; one channel is spread
    over three, a fourth dropped. Raises PylmcError for a missing file, or one that is no picture or is cut off.
    """
    if not Path(path).is_file():
        raise PylmcError(f"{path}: no such file; check the path")
    source = oiio.ImageInput.open(_utf8(path))
    if source is None:
        raise PylmcError(f"{path}: not a readable picture ({_reason(oiio.geterror())}); give an EXR file")
    try:
        spec = source.spec()
        pixels = source.read_image(oiio.FLOAT)
        if pixels is None:
            raise PylmcError(f"{path}: the picture is damaged ({_reason(source.geterror())}); render it again")
        attributes = {item.name: item.value for item in spec.extra_attribs}
        integer = spec.format.basetype in (oiio.UINT8, oiio.UINT16)
    finally:
        source.close()
    pixels = np.asarray(pixels, dtype=np.float32).reshape(spec.height, spec.width, spec.nchannels)
    pixels = pixels[:, :, :3] if spec.nchannels >= 3 else np.repeat(pixels[:, :, :1], 3, axis=2)
    if integer:
        pixels = srgb_decode(pixels).astype(np.float32)
    metadata = {name.removeprefix(PREFIX): str(v) for name, v in attributes.items() if name.startswith(PREFIX)}
    return np.ascontiguousarray(pixels), metadata


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


def srgb_encode(linear: np.ndarray) -> np.ndarray:
    """Linear values as sRGB, clipped to [0, 1]."""
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 0.0031308) ** (1 / 2.4) - 0.055)


def srgb_decode(encoded: np.ndarray) -> np.ndarray:
    """sRGB values in [0, 1] as linear ones."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((np.maximum(encoded, 0) + 0.055) / 1.055) ** 2.4)


def write_png(path: str | Path, image: np.ndarray, files: Replacement | None = None) -> None:
    """Write ``image`` (height, width, 3) as PNG: uint8 as it is, anything else tone-mapped first; ``files`` as above."""
    pixels = _as_rgb(image, path)
    pixels = np.ascontiguousarray(pixels if pixels.dtype == np.uint8 else tonemap(pixels))
    height, width, _ = pixels.shape
    _write(path, "png", oiio.ImageSpec(width, height, 3, "uint8"), pixels, files)


def _as_rgb(image: np.ndarray, path: str | Path) -> np.ndarray:
    pixels = np.asarray(image)
    if pixels.ndim != 3 or pixels.shape[2] != 3 or pixels.size == 0:
        raise PylmcError(f"{path}: a picture of shape {pixels.shape} cannot be written; expected (height, width, 3)")
    return pixels


def _write(path: str | Path, kind: str, spec: oiio.ImageSpec, pixels: np.ndarray, files: Replacement | None) -> None:
    """Write ``pixels`` in the format ``kind``, whatever the path's ending."""
    if not Path(path).parent.is_dir():
        raise PylmcError(f"{path}: the folder '{Path(path).parent}' does not exist; create it first")
    if Path(path).is_dir():
        raise PylmcError(f"{path}: is a folder; name a file in it")
    if files is None:
        with Replacement() as alone:
            return _write(path, kind, spec, pixels, alone)
    output = oiio.ImageOutput.create(kind)
    if output is None:
        raise PylmcError(f"{path}: OpenImageIO has no {kind.upper()} writer here; reinstall the package OpenImageIO")
    written = output.open(_utf8(files.path_for(path)), spec) and output.write_image(pixels)
    reason = "" if written else _reason(output.geterror())
    if not output.close() or not written:
        raise PylmcError(f"{path}: cannot be written ({reason or _reason(output.geterror())}); check folder and space")


def _utf8(path: str | Path) -> str:
    """A file's name as OpenImageIO takes it: its bytes are UTF-8 there, whatever the locale's encoding."""
    try:
        return os.fsencode(path).decode("utf-8")
    except UnicodeDecodeError:
        raise PylmcError(f"{path}: OpenImageIO takes UTF-8 names only; rename the file or its folder") from None


def _reason(message: str) -> str:
    """OpenImageIO's message on one line."""
    return " ".join(message.split()) or "no reason given"
