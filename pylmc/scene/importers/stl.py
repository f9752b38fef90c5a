"""STL files: triangles and nothing else, so that camera and light have to be asked for."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import trimesh

from ...errors import PylmcError
from ..materials import Diffuse
from ..shape import Shape
from .importer import Content, Importer

HEADER, FACET = 84, 50  # bytes of the binary form: 80 of text and the count; a triangle


class Stl(Importer):
    """STL, binary or text: one grey, faceted shape, as the format has neither materials nor shared normals."""

    suffixes = (".stl",)

    def read(self, path: Path) -> Content:
        try:
            content = path.read_bytes()
            if _is_binary(content):
                mesh: Any = trimesh.load(io.BytesIO(content[: _binary_size(content)]), file_type="stl", process=False)
            else:  # names may be in any encoding, and are not read
                text = io.BytesIO(content.decode("ascii", "replace").replace("\ufffd", "?").encode())
                mesh = trimesh.load(text, file_type="stl_ascii", force="mesh", process=False)
            vertices, faces = mesh.vertices, mesh.faces
        except (OSError, PylmcError):
            raise
        except Exception as error:  # trimesh raises what its parser happens to meet
            raise PylmcError(f"malformed STL ({type(error).__name__}: {error}); export the file again") from None
        if not _is_binary(content) and (b"endsolid" not in content or content.count(b"vertex") != 3 * len(faces)):
            raise PylmcError("malformed STL (it ends within a solid); export the file again")
        return Content([Shape((vertices, faces), Diffuse(), name=path.stem)] if len(faces) else [])


def _is_binary(content: bytes) -> bool:
    """Whether a file is of the binary form. Raises PylmcError where it is neither that nor text, or cut off."""
    if len(content) >= HEADER:
        expected = _binary_size(content)
        if len(content) == expected or (len(content) > expected > HEADER and not content.lstrip().startswith(b"solid")):
            return True
    if content.lstrip().startswith(b"solid"):
        return False
    if len(content) < HEADER:
        raise PylmcError(f"malformed STL (its {len(content)} bytes are fewer than a header's); export the file again")
    sizes = f"its triangle count asks for {_binary_size(content)} bytes, and it has {len(content)}"
    raise PylmcError(f"malformed STL ({sizes}); export the file again")


def _binary_size(content: bytes) -> int:
    """How many bytes a binary file has by its own count of triangles."""
    return HEADER + FACET * int.from_bytes(content[HEADER - 4 : HEADER], "little")
