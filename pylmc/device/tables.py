"""What host and device share, each written once, here: structs, the scene's arrays, enumerations, lists for dispatch.

Structs are NumPy dtypes (see :mod:`pylmc.device.structs`); the rest becomes ``#define`` lines of every program. A float64
field stands for a ``real``: :func:`pylmc.device.precision.real_fields` puts the run's number type in its place.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..constraints import KINDS as CONSTRAINTS
from ..constraints.portals import Portals
from ..lobes import KINDS, REFERENCES, Lobe
from ..scene.lights import Light
from ..scene.lights.light import INFINITY, POINT

_F3 = (np.float64, (3,))
_KINDS_OF_LIGHTS: tuple[type[Light], ...] = Light.kinds
_LIGHTS = sorted(kind.name for kind in _KINDS_OF_LIGHTS)

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
MATERIAL: list[Any] = [("first_lobe", np.int32), ("lobes", np.int32), ("choices", np.int32), ("texture", np.int32)]
TEXTURE_INFO: list[Any] = [("offset", np.int32), ("width", np.int32), ("height", np.int32)]
EMITTER: list[Any] = [("radiance", *_F3), ("density", np.float64)]
TARGET: list[Any] = [*Portals.structs["Portal"], ("sphere", np.int32)]
CHAIN_START: list[Any] = [
    ("group", np.uint32),
    ("number", np.uint32),
    ("length", np.int32),
    ("ending", np.int32),
    ("slot", np.int32),
    ("scale", np.float64),
]
# Where a group's splats go: the film's slot and by what they are multiplied; and what its weights are counted in.
FILM_PLACE: list[Any] = [("slot", np.int32), ("scale", np.float64), ("log_unit", np.float64)]
CHAIN_VERTEX: list[Any] = [
    ("v", *_F3),
    ("t", np.float64),
    ("bu", np.float64),
    ("bv", np.float64),
    ("triangle", np.int32),
    ("lobe", np.int32),
]

# What every lobe's record begins with: see lobes.cl. The parameters of the scene's kinds of lobes follow.
LOBE: list[Any] = [
    ("choose", np.float64),
    ("choose_before", np.float64),
    ("kind", np.int32),
    ("signature", np.int32),
    ("reference", np.int32),
    ("pair", np.int32),
    ("narrow", np.int32),
]

# What every light's record begins with: see lights.cl. The parameters of the scene's kinds of lights follow.
LIGHT: list[Any] = [("intensity", *_F3), ("cumulative", np.float64), ("kind", np.int32)]

# The scene's arrays, in the order in which every kernel takes them: name and element type.
SCENE_ARRAYS: dict[str, str] = {
    "nodes": "BvhNode",
    "leaves": "BvhLeaf",
    "vertices": "real",
    "faces": "int",
    "normals": "real",
    "uvs": "real",
    "triangles": "TriangleInfo",
    "materials": "Material",
    "lobes": "Lobe",
    "textures": "TextureInfo",
    "texels": "float",
    "emitters": "Emitter",
    "emitter_cdf": "real",
    "emitter_triangles": "int",
    "lights": "Light",
    **{name: kind for constraint in CONSTRAINTS for name, kind in constraint.arrays.items()},
    "targets": "Target",
    "camera": "Camera",
    "evenness": "float",
    "ties": "int",
}
# Element types whose arrays keep the type they were made with: the tree's, and those that are single precision by nature.
FIXED_TYPES = ("BvhNode", "BvhLeaf", "float")

SCENE_STRUCTS = {
    "Camera": CAMERA,
    "TriangleInfo": TRIANGLE_INFO,
    "Material": MATERIAL,
    "TextureInfo": TEXTURE_INFO,
    "Emitter": EMITTER,
    **{name: fields for constraint in CONSTRAINTS for name, fields in constraint.structs.items()},
    "Target": TARGET,
}
ENDINGS = ("connect", "hit")  # how a path ends: joined to a light without area, or on an emitter
PLACES = ("surface", "pinhole", POINT, INFINITY)  # what a node is: met by rays, or a path's start or end that no ray can meet

PURPOSES = ("bootstrap", "chain", "bdpt", "path")  # what random numbers are for: streams of their own
CHART_KINDS = ("projection", "deviation", "node", "portal")  # and upwards: the last one's number + i is portal i
# What came of a step's proposal: it may be taken; it carries no light; a density is NaN or infinite: rejected, and counted.
OUTCOMES = ("ok", "no_path", "not_finite")
FILM_SCALE = 2.0**24  # of the film's fixed point to the unit: values near 1 keep all of a float's digits


def lobe_record(kinds: Iterable[type[Lobe]]) -> list[Any]:
    """The record of a lobe in a scene with these kinds: what all have, and each kind's parameters once."""
    fields = {field[0]: field for kind in kinds for field in kind.fields}
    return [*LOBE, *fields.values()]


def light_record(kinds: Iterable[type[Light]]) -> list[Any]:
    """The record of a light in a scene with these kinds."""
    fields = {field[0]: field for kind in kinds for field in kind.fields}
    return [*LIGHT, *fields.values()]


def light_number(kind: type[Light]) -> int:
    """LIGHT_<NAME> in the kernels."""
    return _LIGHTS.index(kind.name)


def scene_macros() -> dict[str, str]:
    """The bundle of the scene's arrays, as scene.cl takes it."""
    declared = [f"__global const {kind} *{name}" for name, kind in SCENE_ARRAYS.items()]
    return {
        "SCENE_MEMBERS": " ".join(f"{item};" for item in declared),
        "SCENE_PARAMETERS": ", ".join(declared),
        "SCENE_BUNDLE": "{" + ", ".join([*SCENE_ARRAYS, "0u"]) + "}",
    }


def enumerations() -> dict[str, int]:
    """Every number that has a name on both sides: NAME_OF_GROUP and NAME_OF_MEMBER in capitals."""
    lobes = [kind.name for kind in KINDS]
    groups = {
        "ENDING": ENDINGS,
        "PLACE": PLACES,
        "LOBE": lobes,
        "REFERENCE": REFERENCES,
        "LIGHT": _LIGHTS,
        "PURPOSE": PURPOSES,
        "KIND": CHART_KINDS,
        "STEP": OUTCOMES,
    }
    return {f"{group}_{name.upper()}": i for group, names in groups.items() for i, name in enumerate(names)}


def _references(kinds: Sequence[type[Lobe]]) -> list[str]:
    """The reference directions that these kinds of lobes have."""
    return [name for name in REFERENCES if any(kind.reference == name for kind in kinds)]


class Kinds(NamedTuple):
    """The kinds of things that a program is made for; of constraints their names."""

    lobes: Sequence[type[Lobe]]
    lights: Sequence[type[Light]]
    constraints: Sequence[str]


def dispatch(kinds: Kinds) -> dict[str, str]:
    """The lists that the kernels' dispatch is made of: F(NUMBER, name) for each kind in a switch, F(name) for a constraint."""
    return {
        "CONSTRAINTS(F)": " ".join(f"F({name})" for name in kinds.constraints),
        "LIGHTS(F)": " ".join(f"F(LIGHT_{kind.name.upper()}, {kind.name})" for kind in kinds.lights),
        "LOBES(F)": " ".join(f"F(LOBE_{kind.name.upper()}, {kind.name})" for kind in kinds.lobes),
        "REFERENCES(F)": " ".join(f"F(REFERENCE_{name.upper()}, {name})" for name in _references(kinds.lobes)),
    }


def files(kinds: Kinds) -> dict[str, list[str]]:
    """The kernel files behind those lists, by the word that stands for them in an ``#include``."""
    return {
        "CONSTRAINT_FILES": [f"constraints/{name}.cl" for name in kinds.constraints],
        "LIGHT_FILES": [f"lights/{kind.name}.cl" for kind in kinds.lights],
        "LOBE_FILES": [f"lobes/{kind.name}.cl" for kind in kinds.lobes],
        "REFERENCE_FILES": [f"references/{name}.cl" for name in _references(kinds.lobes)],
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


def chain_counters(columns: int) -> list[Any]:
    """What a chain, or a stream of independent paths, counts.

    ``proposed`` and ``acceptance`` have a column for each of the moves' (pylmc/moves); independent paths count in the first.
    ``weight_sum`` and ``weight_square_sum`` are of large steps, in units of the group's b; ``splatted`` is luminance on the
    film, ``trace`` the film position where a launch left the chain.
    """
    return [
        ("proposed", np.uint32, (columns,)),
        ("acceptance", np.float64, (columns,)),
        ("not_finite", np.uint32),
        ("rays", np.uint32),
        ("weight_sum", np.float64),
        ("weight_square_sum", np.float64),
        ("splatted", np.float64),
        ("trace", np.float64, (2,)),
    ]
