"""glTF's materials and textures as pylmc's."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...colour import srgb_decode
from ...errors import PylmcError
from ..materials import Material, MetallicRoughness
from ..materials.metallic_roughness import SMOOTHEST
from ..texture import Texture
from ..values import RGB
from .gltf_data import GltfData

SMOOTHEST_ROUGHNESS = math.sqrt(SMOOTHEST)
LINEAR = srgb_decode(np.arange(256) / 255).astype(np.float32)  # of each 8-bit sRGB value


class GltfMaterials:
    """A document's materials, each read once, so that shapes share them and their textures."""

    def __init__(self, data: GltfData) -> None:
        self._data = data
        self._materials: dict[Any, tuple[Material, RGB, dict[str, Any] | None]] = {}
        self._textures: dict[tuple[int, RGB], Texture] = {}

    def read(self, index: Any) -> tuple[Material, RGB, dict[str, Any] | None]:
        """Material ``index`` (None: glTF's default), its emission, and the reference to its base colour texture."""
        if index not in self._materials:
            self._materials[index] = self._convert({} if index is None else self._data.item("materials", index))
        return self._materials[index]

    def _convert(self, description: dict[str, Any]) -> tuple[Material, RGB, dict[str, Any] | None]:
        pbr = description.get("pbrMetallicRoughness", {})
        tint = _rgb(np.clip(_colour(pbr.get("baseColorFactor", (1, 1, 1, 1))), 0, 1))
        lookup = pbr.get("baseColorTexture")
        metallic, roughness = float(pbr.get("metallicFactor", 1.0)), float(pbr.get("roughnessFactor", 1.0))
        if "metallicRoughnessTexture" in pbr:
            mean = self._pixels(pbr["metallicRoughnessTexture"]).reshape(-1, 3).mean(axis=0) / 255
            metallic, roughness = metallic * mean[2], roughness * mean[1]
        material = MetallicRoughness(
            tint if lookup is None else self._texture(lookup, tint),
            min(max(metallic, 0.0), 1.0),
            min(max(roughness, SMOOTHEST_ROUGHNESS), 1.0),
        )
        extension = description.get("extensions", {}).get("KHR_materials_emissive_strength", {})
        glow = _colour(description.get("emissiveFactor", (0, 0, 0))) * float(extension.get("emissiveStrength", 1.0))
        if "emissiveTexture" in description and np.any(glow > 0):
            glow = glow * LINEAR[self._pixels(description["emissiveTexture"])].reshape(-1, 3).mean(axis=0, dtype=float)
        return material, _rgb(glow), lookup

    def _texture(self, reference: dict[str, Any], tint: RGB) -> Texture:
        source = self._source(reference)
        if (source, tint) not in self._textures:
            pixels = LINEAR[self._data.image(source)] * np.asarray(tint, dtype=np.float32)
            self._textures[source, tint] = Texture(pixels)
        return self._textures[source, tint]

    def _pixels(self, reference: dict[str, Any]) -> np.ndarray:
        return self._data.image(self._source(reference))

    def _source(self, reference: dict[str, Any]) -> int:
        texture = self._data.item("textures", reference["index"])
        if "source" not in texture:
            raise PylmcError(f"texture {reference['index']} has no PNG or JPEG image; convert the file's textures")
        return texture["source"]


def _colour(value: Any) -> np.ndarray:
    """A glTF colour's first three components (3,)."""
    return np.asarray(value, dtype=np.float64)[:3]


def _rgb(value: np.ndarray) -> RGB:
    return (float(value[0]), float(value[1]), float(value[2]))
