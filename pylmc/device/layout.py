"""The structs that host and device share, each defined once, here, as a numpy dtype (see pylmc.device.structs).

A float64 field stands for a ``real``: :func:`pylmc.device.precision.real_fields` puts the run's number type in its place.
"""

from __future__ import annotations

from typing import Any

import numpy as np

_F3 = (np.float64, (3,))

CAMERA: list[Any] = [
    ("origin", *_F3),
    ("right", *_F3),
    ("up", *_F3),
    ("forward", *_F3),
    ("tan_x", np.float64),
    ("tan_y", np.float64),
    ("bound", np.float64),
    ("width", np.int32),
    ("height", np.int32),
]
TRIANGLE_INFO: list[Any] = [
    ("normal", *_F3),
    ("material", np.int32),
    ("object", np.int32),
    ("emitter", np.int32),
    ("smooth", np.int32),
]
MATERIAL: list[Any] = [
    ("diffuse", *_F3),
    ("specular", *_F3),
    ("specular_tinted", *_F3),
    ("alpha", np.float64),
    ("ior", np.float64),
    ("choose_diffuse", np.float64),
    ("texture", np.int32),
    ("schlick", np.int32),
    ("separable", np.int32),
    ("narrow", np.int32),
]
TEXTURE_INFO: list[Any] = [("offset", np.int32), ("width", np.int32), ("height", np.int32)]
SCENE_OBJECT: list[Any] = [("axes", np.float64, (9,)), ("inverse_half", *_F3), ("small", np.int32)]
EMITTER: list[Any] = [("radiance", *_F3), ("density", np.float64)]
POINT_LIGHT: list[Any] = [("position", *_F3), ("intensity", *_F3), ("cumulative", np.float64)]
PORTAL: list[Any] = [("centre", *_F3), ("normal", *_F3), ("axis", *_F3), ("half_size", np.float64, (2,))]
TARGET: list[Any] = [*PORTAL, ("sphere", np.int32)]
CHAIN_START: list[Any] = [
    ("group", np.uint32),
    ("number", np.uint32),
    ("length", np.int32),
    ("ending", np.int32),
    ("slot", np.int32),
    ("scale", np.float64),
]
CHAIN_VERTEX: list[Any] = [
    ("v", *_F3),
    ("t", np.float64),
    ("bu", np.float64),
    ("bv", np.float64),
    ("triangle", np.int32),
    ("lobe", np.int32),
]

SCENE_STRUCTS = {
    "Camera": CAMERA,
    "TriangleInfo": TRIANGLE_INFO,
    "Material": MATERIAL,
    "TextureInfo": TEXTURE_INFO,
    "SceneObject": SCENE_OBJECT,
    "Emitter": EMITTER,
    "PointLight": POINT_LIGHT,
    "Portal": PORTAL,
    "Target": TARGET,
}


def chain_state(max_depth: int, vertex: np.dtype) -> list[Any]:
    """A chain between launches; ``vertex`` is the declared dtype of CHAIN_VERTEX."""
    return [
        ("length", np.int32),
        ("ending", np.int32),
        ("light", np.int32),
        ("slot", np.int32),
        ("log_i", np.float64),
        ("log_p", np.float64),
        ("colour", *_F3),
        ("vertex", vertex, (max_depth,)),
    ]


def chain_counters(max_depth: int) -> list[Any]:
    """What a chain counts: entry 0 of ``proposed`` and ``acceptance`` is the large step, entry m the block of m.

    ``trace`` is the film position where a launch left it.
    """
    return [
        ("proposed", np.uint32, (max_depth + 1,)),
        ("acceptance", np.float64, (max_depth + 1,)),
        ("not_finite", np.uint32),
        ("rays", np.uint32),
        ("weight_sum", np.float64),
        ("weight_square_sum", np.float64),
        ("trace", np.float64, (2,)),
    ]
