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
        content = path.read_bytes()
        binary = _binary(content)
        try:
            # names in a text may be in any encoding, and are not read
            read = binary or content.decode("ascii", "replace").replace("\ufffd", "?").encode()
            mesh: Any = trimesh.load(io.BytesIO(read), file_type="stl" if binary else "stl_ascii", force="mesh", process=False)
            vertices, faces = mesh.vertices, mesh.faces
        except Exception as error:  # trimesh raises what its parser happens to meet
            raise PylmcError(f"malformed STL ({type(error).__name__}: {error}); export the file again") from None
        if not binary and (b"endsolid" not in content or content.count(b"vertex") != 3 * len(faces)):
            raise PylmcError("malformed STL (it ends within a solid); export the file again")
        return Content([Shape((vertices, faces), Diffuse(), name=path.stem)] if len(faces) else [])


def _binary(content: bytes) -> bytes:
    """The file up to its last triangle if it is of the binary form, nothing if it is text.

    Raises PylmcError where it is neither, or cut off.
    """
    text = content.lstrip().startswith(b"solid")
    size = HEADER + FACET * int.from_bytes(content[HEADER - 4 : HEADER], "little")
    if len(content) == size or (len(content) > size > HEADER and not text):
        return content[:size]
    if text:
        return b""
    if len(content) < HEADER:
        raise PylmcError(f"malformed STL (its {len(content)} bytes are fewer than a header's); export the file again")
    sizes = f"its triangle count asks for {size} bytes, and it has {len(content)}"
    raise PylmcError(f"malformed STL ({sizes}); export the file again")
