"""STL files: triangles and nothing else, so that camera and light have to be asked for."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import trimesh

from ...errors import PylmcError
from ..materials import Diffuse
from ..shape import Shape
from .importer import Content, Importer


class Stl(Importer):
    """STL, binary or text: one grey, faceted shape, as the format has neither materials nor shared normals."""

    suffixes = (".stl",)

    def read(self, path: Path) -> Content:
        try:
            with path.open("rb") as file:
                mesh: Any = trimesh.load(file, file_type="stl", force="mesh", process=False)
            vertices, faces = mesh.vertices, mesh.faces
        except OSError:
            raise
        except Exception as error:  # trimesh raises what its parser happens to meet
            raise PylmcError(f"malformed STL ({type(error).__name__}: {error}); export the file again") from None
        return Content([Shape((vertices, faces), Diffuse(), name=path.stem)] if len(faces) else [])
