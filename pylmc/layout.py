"""The structs that host and device share, each defined once, here, as a numpy dtype (see pylmc.structs)."""

from __future__ import annotations

from typing import Any

import numpy as np

_F3 = (np.float32, (3,))

CAMERA: list[Any] = [
    ("origin", *_F3), ("right", *_F3), ("up", *_F3), ("forward", *_F3), ("tan_x", np.float32), ("tan_y", np.float32),
    ("bound", np.float32), ("width", np.int32), ("height", np.int32),
]  # fmt: skip
TRIANGLE_INFO: list[Any] = [
    ("normal", *_F3), ("material", np.int32), ("object", np.int32), ("emitter", np.int32), ("smooth", np.int32),
]  # fmt: skip
MATERIAL: list[Any] = [
    ("diffuse", *_F3), ("specular", *_F3), ("specular_tinted", *_F3), ("alpha", np.float32), ("ior", np.float32),
    ("choose_diffuse", np.float32), ("texture", np.int32), ("schlick", np.int32), ("separable", np.int32),
    ("narrow", np.int32),
]  # fmt: skip
TEXTURE_INFO: list[Any] = [("offset", np.int32), ("width", np.int32), ("height", np.int32)]
SCENE_OBJECT: list[Any] = [("axes", np.float32, (9,)), ("inverse_half", *_F3), ("small", np.int32)]
EMITTER: list[Any] = [("radiance", *_F3), ("density", np.float32)]
POINT_LIGHT: list[Any] = [("position", *_F3), ("intensity", *_F3), ("cumulative", np.float32)]
APERTURE: list[Any] = [("centre", *_F3), ("normal", *_F3), ("axis", *_F3), ("half_size", np.float32, (2,))]
TARGET: list[Any] = [*APERTURE, ("sphere", np.int32)]
CHAIN_START: list[Any] = [
    ("group", np.uint32), ("number", np.uint32), ("length", np.int32), ("ending", np.int32), ("slot", np.int32),
    ("scale", np.float32),
]  # fmt: skip
CHAIN_VERTEX: list[Any] = [
    ("v", *_F3), ("t", np.float32), ("bu", np.float32), ("bv", np.float32), ("triangle", np.int32), ("lobe", np.int32),
]  # fmt: skip

SCENE_STRUCTS = {
    "Camera": CAMERA, "TriangleInfo": TRIANGLE_INFO, "Material": MATERIAL, "TextureInfo": TEXTURE_INFO,
    "SceneObject": SCENE_OBJECT, "Emitter": EMITTER, "PointLight": POINT_LIGHT, "Aperture": APERTURE, "Target": TARGET,
}  # fmt: skip


def chain_state(max_depth: int, vertex: np.dtype) -> list[Any]:
    """A chain between launches; ``vertex`` is the declared dtype of CHAIN_VERTEX."""
    return [
        ("length", np.int32), ("ending", np.int32), ("light", np.int32), ("slot", np.int32), ("log_i", np.float32),
        ("log_p", np.float32), ("colour", *_F3), ("vertex", vertex, (max_depth,)),
    ]  # fmt: skip


def chain_counters(max_depth: int) -> list[Any]:
    """What a chain counts: entry 0 of ``proposed`` and ``acceptance`` is the large step, entry m the block of m.

    ``trace`` is the film position where a launch left it.
    """
    return [
        ("proposed", np.uint32, (max_depth + 1,)), ("acceptance", np.float32, (max_depth + 1,)),
        ("not_finite", np.uint32), ("rays", np.uint32), ("weight_sum", np.float32), ("weight_square_sum", np.float32),
        ("trace", np.float32, (2,)),
    ]  # fmt: skip
