"""What is inside a glTF 2.0 or GLB file: its JSON, buffers, accessors and images, each checked before use."""

from __future__ import annotations

import base64
import binascii
import errno
import io
import json
import os
import struct
from pathlib import Path
from typing import Any
from urllib.parse import unquote_to_bytes

import numpy as np
from PIL import Image

from ...errors import PylmcError

COMPONENT_TYPES = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
GLB_JSON, GLB_BIN = 0x4E4F534A, 0x004E4942
MAX_ELEMENTS = 1 << 28  # an accessor without data is all zeros, whatever its count says


class GltfData:
    """One file's document and data. Every method raises PylmcError, without the file's name, where the file is bad."""

    def __init__(self, path: Path) -> None:
        self.folder = path.parent
        content = _contents(path)
        if not content:
            raise PylmcError("the file is empty (zero bytes); export it again")
        self.binary: bytes | None = None
        if content[:4] == b"glTF":
            content, self.binary = _split_glb(content)
        try:
            document = json.loads(content.decode("utf-8-sig"))
        except RecursionError:
            raise PylmcError("its JSON is nested too deeply to be glTF; export or download it again") from None
        except ValueError as error:
            if self.binary is None and not content.lstrip().startswith(b"{"):
                raise PylmcError("this is neither glTF nor GLB; give a glTF 2.0 file (.gltf or .glb)") from None
            raise PylmcError(f"its JSON is damaged or cut off ({error}); export or download it again") from None
        if not isinstance(document, dict) or "asset" not in document:
            raise PylmcError("this JSON is not glTF (it has no 'asset'); give a glTF 2.0 file")
        version = str(document["asset"].get("version", "missing"))
        if not version.startswith("2"):
            raise PylmcError(f"glTF version {version} is not read; export as glTF 2.0")
        self.document: dict[str, Any] = document
        self._buffers: dict[int, bytes] = {}

    def items(self, key: str) -> list[Any]:
        """The document's list ``key``, empty where absent."""
        found = self.document.get(key, [])
        if not isinstance(found, list):
            raise PylmcError(f"'{key}' is not a list; export the file again")
        return found

    def item(self, key: str, index: Any) -> dict[str, Any]:
        """Entry ``index`` of the document's list ``key``."""
        found = self.items(key)
        if not isinstance(index, int) or not 0 <= index < len(found) or not isinstance(found[index], dict):
            raise PylmcError(f"'{key}' has no entry {index!r} (it has {len(found)}); export the file again")
        return found[index]

    def accessor(self, index: Any) -> np.ndarray:
        """An accessor's elements (count, width): float64 for floats and normalised integers, else int64."""
        accessor = self.item("accessors", index)
        count, width = accessor["count"], WIDTHS[accessor["type"]]
        kind = np.dtype(COMPONENT_TYPES[accessor["componentType"]]).newbyteorder("<")
        if not isinstance(count, int) or not 0 <= count <= MAX_ELEMENTS:
            raise PylmcError(f"accessor {index} claims {count!r} elements; export the file again")
        if "bufferView" in accessor:
            raw = self._strided(accessor["bufferView"], accessor.get("byteOffset", 0), count, width, kind).copy()
        else:
            raw = np.zeros((count, width), dtype=kind)
        if "sparse" in accessor:
            sparse = accessor["sparse"]
            at, values = sparse["indices"], sparse["values"]
            at_kind = np.dtype(COMPONENT_TYPES[at["componentType"]]).newbyteorder("<")
            where = self._strided(at["bufferView"], at.get("byteOffset", 0), sparse["count"], 1, at_kind)
            raw[where[:, 0].astype(np.int64)] = self._strided(
                values["bufferView"], values.get("byteOffset", 0), sparse["count"], width, kind
            )
        if kind.kind == "f":
            return raw.astype(np.float64)
        if accessor.get("normalized", False):
            return np.maximum(raw.astype(np.float64) / (2 ** (8 * kind.itemsize - (kind.kind == "i")) - 1), -1.0)
        return raw.astype(np.int64)

    def image(self, index: Any) -> np.ndarray:
        """An image's pixels (height, width, 3), uint8 as stored; alpha is dropped."""
        image = self.item("images", index)
        name = image.get("name") or f"image {index}"
        content = self._view(image["bufferView"]) if "bufferView" in image else self._resource(image["uri"], "texture")
        try:
            with Image.open(io.BytesIO(content)) as opened:
                return np.asarray(opened.convert("RGB"))
        except (OSError, ValueError, SyntaxError, Image.DecompressionBombError, struct.error) as error:
            raise PylmcError(f"texture '{name}' cannot be decoded ({error}); replace it by a PNG or JPEG") from None

    def _strided(self, view: Any, offset: Any, count: Any, width: int, kind: np.dtype) -> np.ndarray:
        """``count`` rows of ``width`` components from a buffer view, at ``offset`` bytes, honouring its stride."""
        content = self._view(view)
        row = width * kind.itemsize
        stride = self.item("bufferViews", view).get("byteStride") or row
        if min(offset, count) < 0 or stride < row or (count and offset + (count - 1) * stride + row > len(content)):
            raise PylmcError(f"buffer view {view} is too short for its accessor (truncated file?); export it again")
        return np.ndarray((count, width), kind, content, offset, (stride, kind.itemsize))

    def _view(self, index: Any) -> bytes:
        view = self.item("bufferViews", index)
        start, size = view.get("byteOffset", 0), view["byteLength"]
        content = self._buffer(view["buffer"])
        if min(start, size) < 0 or start + size > len(content):
            raise PylmcError(f"buffer view {index} reaches past its buffer; the file is truncated: export it again")
        return content[start : start + size]

    def _buffer(self, index: Any) -> bytes:
        if index not in self._buffers:
            buffer = self.item("buffers", index)
            if "uri" in buffer:
                content = self._resource(buffer["uri"], "buffer")
            elif index == 0 and self.binary is not None:
                content = self.binary
            else:
                raise PylmcError(f"buffer {index} has no data; export the file again")
            if len(content) < buffer["byteLength"]:
                raise PylmcError(
                    f"buffer {index} holds {len(content)} of {buffer['byteLength']} bytes; "
                    "it is truncated: export the file again"
                )
            self._buffers[index] = content
        return self._buffers[index]

    def _resource(self, uri: str, what: str) -> bytes:
        """The bytes behind a data URI or a file beside the scene."""
        if uri.startswith("data:"):
            try:
                return base64.b64decode(uri.partition(",")[2], validate=True)
            except (binascii.Error, ValueError):
                raise PylmcError(f"a {what} embedded as a data URI is damaged; export the file again") from None
        if "://" in uri:
            raise PylmcError(f"its {what} is at {uri}; nothing is fetched from the network: save it beside the file")
        try:
            return _contents(self.folder / os.fsdecode(unquote_to_bytes(uri)))  # UTF-8, whatever the locale's encoding
        except OSError as error:
            reason = error.strerror or type(error).__name__
            raise PylmcError(f"its {what} '{uri}' cannot be read ({reason}); put it beside the file") from None


def _contents(path: Path) -> bytes:
    """A file's bytes; raises OSError also for what is no file: a pipe or a device may never end."""
    if path.exists() and not path.is_file() and not path.is_dir():
        raise OSError(errno.EINVAL, "it is a pipe or a device, not a file")
    return path.read_bytes()


def _split_glb(content: bytes) -> tuple[bytes, bytes | None]:
    """A GLB container's JSON text and binary chunk."""
    if len(content) < 20:
        raise PylmcError(f"the GLB file ends after {len(content)} bytes; export it again")
    _, version, total = struct.unpack_from("<4sII", content)
    if version != 2:
        raise PylmcError(f"GLB version {version} is not read; export as glTF 2.0")
    if total > len(content):
        raise PylmcError(f"the GLB file is truncated ({len(content)} of {total} bytes); export or download it again")
    text, binary, at = None, None, 12
    while at + 8 <= total:
        size, kind = struct.unpack_from("<II", content, at)
        if at + 8 + size > total:
            raise PylmcError("a GLB chunk reaches past the end of the file; export it again")
        chunk = content[at + 8 : at + 8 + size]
        if kind == GLB_JSON and text is None:
            text = chunk
        elif kind == GLB_BIN and binary is None:
            binary = chunk
        at += 8 + size
    if text is None:
        raise PylmcError("the GLB file has no JSON chunk; export it again")
    return text, binary
