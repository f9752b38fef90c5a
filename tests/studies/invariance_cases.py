"""What the tests of invariance run: scenes with their targets, ways of moving that must pass, and faults that must not."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from pylmc.sampling.evenness import GRID
from pylmc.scene import Camera, Diffuse, PointLight, RoughConductor, Scene, Shape
from pylmc.scene.loading import load
from pylmc.settings import CONSTRAINTS
from studies.invariance import Outcome, Start, move
from studies.probes import spotlit_scene, sunlit_scene, varnished_scene

ALPHA = 1e-4  # of a configuration, Šidák-corrected over its tests
FAULTY = 1e-9  # a negative control's smallest p-value must be below
FILM = 12  # pixels per side
STEPS = 40
MADE = {"varnished": varnished_scene, "spotlit": spotlit_scene, "sunlit": sunlit_scene}
LONG_STEPS = {"step_length": (0.2, 1.0)}  # of the chart's units: long enough to leave the start, and to notice curvature


def rectangle(*corner_and_edges: tuple[float, float, float]) -> tuple[np.ndarray, list[list[int]]]:
    c, a, b = (np.array(v, float) for v in corner_and_edges)
    return np.array([c, c + a, c + a + b, c + b]), [[0, 1, 2], [0, 2, 3]]


def both_endings(name: str) -> Scene:
    """A built-in scene, made easy enough for an exact start, with a point light and an emitter."""
    parameters = {
        "keyhole": {"hole": 0.3, "alpha": 0.2},
        "caustic": {"alpha": 0.25},
        "glints": {"size": 0.3, "alpha": 0.2},
    }
    scene = load(name, **parameters[name]).with_size(FILM, FILM)
    panel = Shape(
        rectangle(
            *{
                "keyhole": ((-0.9, 0.95, 0.3), (0.2, 0, 0), (0, 0, 0.3)),
                "glints": ((0.2, 1.6, 0.8), (0.25, 0, 0), (0, 0, 0.25)),
                "caustic": ((1.0, 2.5, 1.0), (0.3, 0, 0), (0, 0, 0.3)),
            }[name]
        ),
        Diffuse(0.0),
        emission=20.0,
    )
    lights = scene.lights or [PointLight((1.2, 2.2, 0.8), 6.0)]
    return Scene(scene.camera, [*scene.shapes, panel], lights, scene.portals)


def skewed() -> Scene:
    """A corner of rough conductors (GGX, roughness 0.3) with a panel above and a lamp to one side, low over the floor."""
    shapes = [
        Shape(rectangle((-1, 0, -1), (0, 0, 2), (2, 0, 0)), RoughConductor(0.3, (0.9, 0.8, 0.7)), name="floor"),
        Shape(rectangle((-1, 0, -1), (2, 0, 0), (0, 1.6, 0)), RoughConductor(0.3, (0.7, 0.8, 0.9)), name="back wall"),
        Shape(rectangle((-1, 1.6, -1), (2, 0, 0), (0, 0, 2)), Diffuse(0.0), emission=0.5, name="panel"),
    ]
    camera = Camera((0.4, 1.0, 2.6), (0, 0.2, -0.4), fov=40, width=FILM, height=FILM)
    return Scene(camera, shapes, [PointLight((-0.7, 0.35, -0.5), 0.5)])


@cache
def start(name: str, precision: str = "single", seed: int = 101) -> Start:
    """The two samples of a scene's target: luminance evened out over the film, luminance alone (glints), or skewed."""
    if name == "box":
        return Start(load("box").with_size(FILM, FILM), precision=precision, max_depth=4, candidates=1 << 18, seed=seed)
    if name in MADE:
        return Start(MADE[name]().with_size(FILM, FILM), precision=precision, max_depth=4, candidates=1 << 18, seed=seed)
    if name == "skewed":
        x, y = np.meshgrid(np.linspace(0, 1, GRID), np.linspace(0, 1, GRID))
        weights = np.exp(2.5 * (x + y)).astype(np.float32)  # 150 times as much at the lower right as at the upper left
        return Start(skewed(), weights, precision=precision, candidates=1 << 18, seed=seed)
    weights = np.ones((GRID, GRID), np.float32) if name == "glints" else None
    candidates = 1 << (19 if name == "keyhole" else 18)
    return Start(both_endings(name), weights, precision=precision, candidates=candidates, seed=seed)


@dataclass(frozen=True)
class Case:
    """A configuration: of which scene, in which precision, moved how and how often."""

    name: str
    scene: str
    settings: dict[str, Any]
    precision: str = "single"
    steps: int = STEPS

    def run(self, fault: str = "", seed: int = 101, **changes: Any) -> Outcome:
        """Move and compare; ``fault`` and ``changes`` make a negative control of it."""
        settings = {"large_steps": 0.0, **LONG_STEPS, **self.settings, **changes}
        return move(start(self.scene, self.precision, seed), self.steps, seed, fault, **settings)


@dataclass(frozen=True)
class Control:
    """A fault and the configuration in which it has power; the same without the fault must pass."""

    name: str
    twin: Case
    fault: str = ""
    changes: tuple[tuple[str, Any], ...] = ()

    def run(self, seed: int = 101) -> Outcome:
        return self.twin.run(self.fault, seed, **dict(self.changes))


FACTORS: dict[str, tuple[Any, ...]] = {
    "scene": ("keyhole", "caustic", "glints", "skewed"),
    "rule": ("sum", "mean", "rms"),
    "coordinates": ("target", "deviation"),
    "chart": ("equal-area", "orthographic"),
    "drift": (False, True),
    "projection": ("normalise", "orthographic"),
    "large_steps": (0.0, 0.3),
    "blocks": (True, False),
}


def pairs(row: dict[str, Any]) -> set[tuple[tuple[str, Any], tuple[str, Any]]]:
    """Every two choices that a row makes together."""
    return set(itertools.combinations(row.items(), 2))


def covering(factors: dict[str, tuple[Any, ...]]) -> list[dict[str, Any]]:
    """Rows such that every two choices of different factors occur together in one, picked greedily."""
    grid = [dict(zip(factors, choice, strict=True)) for choice in itertools.product(*factors.values())]
    wanted, rows = set().union(*map(pairs, grid)), []
    while wanted:
        rows.append(max(grid, key=lambda row: len(pairs(row) & wanted)))
        wanted -= pairs(rows[-1])
    return rows


def case(row: dict[str, Any]) -> Case:
    settings = {name: choice for name, choice in row.items() if name != "scene"}
    marks = [row[k] for k in ("rule", "coordinates", "chart")] + [k for k in ("drift", "blocks") if row[k]]
    if row["coordinates"] == "deviation":
        marks.append(f"{row['projection']} projection")
    if row["large_steps"]:
        marks.append("mixture")
    return Case(", ".join(marks), row["scene"], settings)


PAIRWISE = [case(row) for row in covering(FACTORS)]
GRID_FACTORS = {name: FACTORS[name] for name in ("scene", "coordinates", "chart", "rule", "drift")}
FULL = [Case("pairs of floats", "glints", {}, "float-float")]
FULL += [
    case({**dict(zip(GRID_FACTORS, choice, strict=True)), "projection": "normalise", "large_steps": 0.0, "blocks": True})
    for choice in itertools.product(*GRID_FACTORS.values())
]

OTHERS = [
    Case("large steps alone", "keyhole", {"large_steps": 1.0}),
    Case("isotropic steps", "glints", {"constraints": ()}),
    *(
        Case(
            f"without {kind}",
            {"portals": "keyhole", "objects": "glints", "normals": "caustic", "cones": "spotlit"}.get(kind, "keyhole"),
            {"constraints": tuple(k for k in CONSTRAINTS if k != kind)},
        )
        for kind in CONSTRAINTS
    ),
    Case("reduced differentials, drift", "caustic", {"differentials": "reduced", "drift": True}),
    Case("box, paths of up to 4 segments", "box", {}),
    Case("plastic, drift", "varnished", {"drift": True}),
    Case("two lights, one of them a spot", "spotlit", {}),
    Case("other lights alone", "spotlit", {"light_steps": 1.0}),
    Case("light from infinity and a point", "sunlit", {"coordinates": "deviation", "drift": True}),
    Case("mixed precision, drift", "caustic", {"drift": True}, "mixed"),
    Case("double precision, drift", "skewed", {"drift": True}, "double"),
]

PRECONDITIONED = Case("preconditioned steps", "keyhole", {}, steps=160)
DRIFTING = Case("drift", "skewed", {"drift": True, "coordinates": "deviation"})
ORTHOGRAPHIC = Case("orthographic chart, GGX 0.3", "skewed", {"coordinates": "deviation", "chart": "orthographic"}, steps=160)
CONTROLS = [
    Control("no determinant", PRECONDITIONED, "no determinant"),
    Control("T(X) in place of T(X̂)", PRECONDITIONED, "factor of X"),
    Control("reverse step's sign", DRIFTING, "reverse sign"),
    Control("unit Jacobian of the orthographic chart", ORTHOGRAPHIC, changes=(("chart", "orthographic-unit"),)),
]
CASES = [*PAIRWISE, *OTHERS, *{control.twin.name: control.twin for control in CONTROLS}.values()]
