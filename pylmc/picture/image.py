"""Pictures in and out: linear float EXR with metadata, and a tone-mapped PNG for looking at."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio

from ..colour import srgb_decode
from ..errors import PylmcError
from .replacement import Replacement
from .tonemap import tonemap

PREFIX = "pylmc:"


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
