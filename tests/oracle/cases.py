"""Which scenes, settings and number types the kernels are held against the oracle in, and the states they start from.

States are paths drawn from the target of every built-in scene and of the textured one, all lengths up to 8, both endings.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import pytest
from studies.probes import spotlit_scene, sunlit_scene, textured_scene, varnished_scene

import pylmc
from pylmc.sampling.sampler import Sampler
from pylmc.sampling.states import ChainArrays
from pylmc.scene import Scene

DEPTH, CHAINS = 8, 120
MADE = {
    "textured": textured_scene,
    "varnished": varnished_scene,
    "spotlit": spotlit_scene,
    "sunlit": sunlit_scene,
}
SCENES: dict[str, dict[str, float]] = {
    "keyhole": {"hole": 0.1, "alpha": 0.05},
    "glints": {"size": 0.1, "alpha": 0.1},
    "caustic": {"alpha": 0.1},
    "box": {},
    "textured": {},
    "varnished": {},
    "spotlit": {},
    "sunlit": {},
}
LOBES = {
    "keyhole": {"diffuse", "reflect"},
    "glints": {"diffuse", "reflect"},
    "caustic": {"diffuse", "dielectric_reflect", "dielectric_transmit"},
    "box": {"diffuse"},
    "textured": {"diffuse", "reflect"},
    "varnished": {"coat", "coated_diffuse", "diffuse"},
    "spotlit": {"diffuse", "reflect"},
    "sunlit": {"diffuse", "reflect"},
}
ENDS = {
    "keyhole": {0},
    "glints": {0},
    "caustic": {1},
    "box": {1},
    "textured": {0, 1},
    "varnished": {0, 1},
    "spotlit": {0, 1},
    "sunlit": {0},
}


class Case(NamedTuple):
    scene: str
    precision: str
    settings: dict[str, Any]

    def __str__(self) -> str:
        return "-".join([self.scene, self.precision, *map(str, self.settings.values())])


def case(scene: str, precision: str, **settings: Any) -> Any:
    return pytest.param(chosen := Case(scene, precision, settings), id=str(chosen))


DEVIATION, ORTHOGRAPHIC = {"coordinates": "deviation"}, {"chart": "orthographic"}
CASES = [
    case("keyhole", "double", rule="sum"),
    case("keyhole", "single", **DEVIATION, rule="mean", drift=True),
    case("keyhole", "mixed", **DEVIATION, **ORTHOGRAPHIC, rule="rms", projection="orthographic"),
    case("glints", "single", rule="rms", drift=True),
    case("glints", "double", **DEVIATION, chart="orthographic-unit", rule="mean"),
    case("caustic", "single", rule="mean"),
    case("caustic", "double", **DEVIATION, rule="sum", drift=True),
    case("caustic", "mixed", **ORTHOGRAPHIC, rule="rms", drift=True),
    case("box", "single", **DEVIATION, **ORTHOGRAPHIC, rule="sum"),
    case("textured", "single", rule="sum"),
    case("textured", "mixed", **DEVIATION, rule="rms", drift=True),
    case("varnished", "single", rule="sum"),
    case("varnished", "double", **DEVIATION, rule="rms", drift=True),
    case("spotlit", "single", rule="sum"),
    case("spotlit", "double", rule="mean"),
    case("sunlit", "single", rule="sum"),
    case("sunlit", "double", **DEVIATION, rule="rms", drift=True),
]
LONG = [
    case("keyhole", "double", constraints=("lobes", "objects"), rule="rms"),
    case("keyhole", "double", constraints=("portals",), blocks=False, aim="light"),
    case("textured", "double", constraints=(), drift=True),
    *[
        case(scene, precision, coordinates=coordinates, chart=chart, rule=rule, drift=drift)
        for scene in SCENES
        for precision in ("single", "mixed", "double", "float-float")
        for coordinates in ("target", "deviation")
        for chart, rule, drift in (("equal-area", "sum", True), ("orthographic", "mean", False), ("equal-area", "rms", False))
    ],
]


def scene_of(name: str) -> Scene:
    return MADE[name]() if name in MADE else pylmc.load(name, **SCENES[name]).with_size(24, 18)


@cache
def start_of(name: str) -> Sampler:
    """A sampler whose chains start in the target, at least eight to each path length and ending."""
    sampler = Sampler(scene_of(name), precision="double", max_depth=DEPTH, even=False)
    sampler.init(3, chains=CHAINS, candidates=1 << 14)
    return sampler


@cache
def states_of(name: str) -> ChainArrays:
    return start_of(name).state.arrays()


def only_long(cases: list[Any]) -> list[Any]:
    return [pytest.param(*case.values, id=f"long-{case.id}", marks=pytest.mark.long) for case in cases]
