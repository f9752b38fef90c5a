"""glTF 2.0 and GLB files as scenes.

Read: triangles with their node transforms, normals and texture coordinates, metallic-roughness materials with a base
colour texture, emission, the first perspective camera, lights. Each of the other textures is averaged to one
factor; alpha, vertex colours, normal maps, occlusion, skins and animations are ignored.
"""

from __future__ import annotations

import math
import struct
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import PylmcError
from ..camera import Camera
from ..shape import Shape, mean_normals
from .gltf_data import GltfData
from .gltf_lights import gltf_light
from .gltf_materials import GltfMaterials
from .importer import Content, Importer

KNOWN_EXTENSIONS = {
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
}
TRIANGLES, STRIP, FAN = 4, 5, 6


class Gltf(Importer):
    """glTF 2.0, as JSON with files beside it or as one binary file."""

    suffixes = (".gltf", ".glb")

    def read(self, path: Path) -> Content:
        try:
            with np.errstate(over="ignore", invalid="ignore"):  # what overflows is refused by name where it ends up
                return _Document(GltfData(path)).content()
        except (
            KeyError,
            IndexError,
            TypeError,
            ValueError,
            AttributeError,
            OverflowError,
            RecursionError,
            MemoryError,
            struct.error,
        ) as error:
            detail = f"{type(error).__name__}: {error}"
            raise PylmcError(f"malformed glTF ({detail}); validate or export the file again") from None


class _Document:
    """One document on its way to a scene."""

    def __init__(self, data: GltfData) -> None:
        self.data = data
        unknown = sorted(set(data.items("extensionsRequired")) - KNOWN_EXTENSIONS)
        if unknown:
            raise PylmcError(f"requires {', '.join(unknown)}, which is not supported; export the file without it")
        self.found = Content()
        self.cameras: list[tuple[dict[str, Any], np.ndarray]] = []
        self.materials = GltfMaterials(data)

    def content(self) -> Content:
        """All that the document's scene holds."""
        self._visit_all(self._roots())
        if self.found.shapes:  # a camera's target is set among them
            self.found.cameras = [self._camera(*camera) for camera in self.cameras[:1]]
        return self.found

    def _roots(self) -> list[Any]:
        scenes = self.data.items("scenes")
        if scenes:
            return list(self.data.item("scenes", self.data.document.get("scene", 0)).get("nodes", []))
        children = {child for node in self.data.items("nodes") for child in node.get("children", [])}
        return [index for index in range(len(self.data.items("nodes"))) if index not in children]

    def _visit_all(self, roots: list[Any]) -> None:
        """Everything at the roots and below, parents first; each node once, as glTF's nodes are trees of any depth."""
        waiting = [(index, np.eye(4)) for index in reversed(roots)]
        seen: set[int] = set()
        while waiting:
            index, parent = waiting.pop()
            node = self.data.item("nodes", index)
            if index in seen:
                raise PylmcError(
                    f"node {index} is listed twice, as a child or root, but nodes are trees; export the file again"
                )
            seen.add(index)
            transform = self._visit(index, node, parent)
            waiting += [(child, transform) for child in reversed(node.get("children", []))]

    def _visit(self, index: int, node: dict[str, Any], parent: np.ndarray) -> np.ndarray:
        """What is at a node; its transform."""
        transform = parent @ _local_transform(node)
        if not np.all(np.isfinite(transform)):
            raise PylmcError(f"node {index} has a transform with NaN or infinite values; export the file again")
        if "mesh" in node:
            mesh = self.data.item("meshes", node["mesh"])
            name = str(node.get("name") or mesh.get("name") or f"node {index}")
            for number, primitive in enumerate(mesh["primitives"]):
                self._primitive(primitive, transform, f"{name}/{number}")
        if "camera" in node:
            camera = self.data.item("cameras", node["camera"])
            if camera.get("type") == "perspective":
                self.cameras.append((camera["perspective"], transform))
        punctual = node.get("extensions", {}).get("KHR_lights_punctual")
        if punctual is not None:
            self._light(punctual["light"], transform)
        return transform

    def _camera(self, perspective: dict[str, Any], transform: np.ndarray) -> Camera:
        """glTF cameras look along their node's -z, with +y up."""
        origin, forward, up = transform[:3, 3], -transform[:3, 2], transform[:3, 1]
        forward = forward / max(float(np.linalg.norm(forward)), np.finfo(float).tiny)
        corners = np.concatenate([shape.bounds() for shape in self.found.shapes])
        low, high = corners.min(axis=0), corners.max(axis=0)
        reach = max(float(np.linalg.norm((low + high) / 2 - origin)), float(np.linalg.norm(high - low)), 1e-9)
        return Camera(origin, origin + reach * forward, up, math.degrees(perspective["yfov"]))

    def _light(self, index: Any, transform: np.ndarray) -> None:
        lights = self.data.document.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", [])
        if not isinstance(index, int) or not 0 <= index < len(lights):
            raise PylmcError(f"a node names light {index!r}, which is not there; export the file again")
        try:
            light = gltf_light(lights[index], transform)
        except PylmcError as error:
            raise PylmcError(f"light {index}: {error}") from None
        if light is not None:
            self.found.lights.append(light)

    def _primitive(self, primitive: dict[str, Any], transform: np.ndarray, name: str) -> None:
        attributes = primitive["attributes"]
        mode = primitive.get("mode", TRIANGLES)
        if mode not in (TRIANGLES, STRIP, FAN) or "POSITION" not in attributes:
            return  # points and lines reflect nothing
        vertices = self.data.accessor(attributes["POSITION"]).astype(np.float64)
        order = np.arange(len(vertices)) if (at := primitive.get("indices")) is None else self.data.accessor(at)[:, 0]
        if len(order) and not 0 <= order.min() <= order.max() < len(vertices):
            raise PylmcError(f"'{name}' indexes vertex {order.max()} of {len(vertices)}; export the file again")
        faces = _triangles(order, mode)

        linear = transform[:3, :3]
        cofactors = np.cross(linear[[1, 2, 0]], linear[[2, 0, 1]])
        mirrored = float(np.sum(linear[0] * cofactors[0])) < 0
        if mirrored:
            faces = faces[:, ::-1]
        vertices = vertices @ linear.T + transform[:3, 3]
        corners = vertices[faces]
        flat = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) == 0
        faces = faces[~flat]
        if len(faces) == 0:
            return
        normals = None
        if "NORMAL" in attributes:
            normals = self.data.accessor(attributes["NORMAL"]) @ (-cofactors if mirrored else cofactors).T
            normals = _repaired(normals, vertices, faces)

        material, emission, lookup = self.materials.read(primitive.get("material"))
        uv = None if lookup is None else self._texture_coordinates(attributes, lookup, len(vertices), name)
        self.found.shapes.append(Shape((vertices, faces), material, emission, name, normals=normals, uv=uv))

    def _texture_coordinates(self, attributes: dict, lookup: dict, count: int, name: str) -> np.ndarray:
        """Coordinates (vertices, 2) with v upwards; glTF counts it downwards."""
        transform = lookup.get("extensions", {}).get("KHR_texture_transform", {})
        key = f"TEXCOORD_{transform.get('texCoord', lookup.get('texCoord', 0))}"
        if key not in attributes:
            return np.zeros((count, 2))  # as glTF viewers do: the texture's first pixel
        uv = self.data.accessor(attributes[key]).astype(np.float64)
        if uv.shape != (count, 2):
            raise PylmcError(f"'{name}' has {len(uv)} texture coordinates for {count} vertices; export the file again")
        turn = float(transform.get("rotation", 0.0))
        uv = uv * np.asarray(transform.get("scale", (1, 1)), dtype=np.float64)
        uv = uv @ np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
        uv = uv + np.asarray(transform.get("offset", (0, 0)), dtype=np.float64)
        return np.column_stack([uv[:, 0], 1.0 - uv[:, 1]])


def _triangles(order: np.ndarray, mode: int) -> np.ndarray:
    """Vertex triples (faces, 3) of a list, strip or fan."""
    if mode == TRIANGLES:
        return order[: len(order) // 3 * 3].reshape(-1, 3)
    count = max(len(order) - 2, 0)
    k = np.arange(count)
    if mode == FAN:
        return np.column_stack([np.repeat(order[:1], count), order[k + 1], order[k + 2]])
    odd = k % 2
    return np.column_stack([order[k], order[k + 1 + odd], order[k + 2 - odd]])


def _repaired(normals: np.ndarray, vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Normals (vertices, 3) in which those without a length have become the mean of their faces'."""
    if normals.shape != vertices.shape:
        raise PylmcError(f"{len(normals)} normals for {len(vertices)} vertices; export the file again")
    bad = np.linalg.norm(normals, axis=1) == 0
    if bad.any():
        normals = np.where(bad[:, None], mean_normals(vertices, faces), normals)
        bad = np.linalg.norm(normals, axis=1) == 0
    return np.where(bad[:, None], (0.0, 0.0, 1.0), normals)


def _local_transform(node: dict[str, Any]) -> np.ndarray:
    """A node's matrix (4, 4), given whole (by columns) or as translation, rotation (x, y, z, w) and scale."""
    if "matrix" in node:
        return np.asarray(node["matrix"], dtype=np.float64).reshape(4, 4).T
    matrix = np.eye(4)
    x, y, z, w = np.asarray(node.get("rotation", (0, 0, 0, 1)), dtype=np.float64)
    norm = x * x + y * y + z * z + w * w
    s = 2 / norm if norm > 0 else 0.0
    matrix[:3, :3] = np.eye(3) + s * np.array(
        [
            [-(y * y + z * z), x * y - z * w, x * z + y * w],
            [x * y + z * w, -(x * x + z * z), y * z - x * w],
            [x * z - y * w, y * z + x * w, -(x * x + y * y)],
        ]
    )
    matrix[:3, :3] *= np.asarray(node.get("scale", (1, 1, 1)), dtype=np.float64)
    matrix[:3, 3] = np.asarray(node.get("translation", (0, 0, 0)), dtype=np.float64)
    return matrix
