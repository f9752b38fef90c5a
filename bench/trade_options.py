"""The named approximations that ``bench.trade`` measures, each against its exact or its default form."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from pylmc.sampling.compiled import CompiledScene
from pylmc.settings import CONSTRAINTS

DEPTH = 8  # of the default; the reference knows longer paths


@dataclass(frozen=True)
class Option:
    """One cell's settings. ``against`` names the option that it is an alternative to; "" is the default."""

    name: str
    settings: dict[str, Any] = field(default_factory=dict)
    integrator: str = "lmc"
    against: str = "default"
    needs: str = ""  # a feature of the scene without which the option changes nothing

    @property
    def depth(self) -> int:
        """The longest paths it draws."""
        return int(self.settings.get("max_depth", DEPTH))


WHOLE, DEVIATION = {"blocks": False}, {"coordinates": "deviation"}

OPTIONS = (
    Option("default"),
    Option("precision mixed", {"precision": "mixed"}),
    Option("precision double", {"precision": "double"}),
    Option("precision float-float", {"precision": "float-float"}),
    Option("math relaxed", {"math": "relaxed"}),
    Option("math fast", {"math": "fast"}),
    Option("math native", {"math": "native"}),
    Option("whole steps", WHOLE),
    Option("deviation charts", DEVIATION),
    Option("isotropic, blocks", {"constraints": ()}),
    Option("isotropic, whole steps", WHOLE | {"constraints": ()}, against="whole steps"),
    Option("isotropic, deviation charts", DEVIATION | {"constraints": ()}, against="deviation charts"),
    Option("orthographic", {"chart": "orthographic"}, needs="HAS_NARROW"),
    Option("orthographic-unit", {"chart": "orthographic-unit"}, needs="HAS_NARROW"),
    Option("orthographic, deviation charts", DEVIATION | {"chart": "orthographic"}, against="deviation charts"),
    Option("orthographic-unit, deviation charts", DEVIATION | {"chart": "orthographic-unit"}, against="deviation charts"),
    Option("orthographic projection, deviation charts", DEVIATION | {"projection": "orthographic"}, against="deviation charts"),
    Option("rule mean", {"rule": "mean"}),
    Option("rule rms", {"rule": "rms"}),
    Option("drift", {"drift": True}),
    Option("drift, deviation charts", DEVIATION | {"drift": True}, against="deviation charts"),
    Option("reduced differentials", {"differentials": "reduced"}, needs="HAS_DEVIATION"),
    Option("reduced differentials, deviation charts", DEVIATION | {"differentials": "reduced"}, against="deviation charts"),
    *(
        Option(f"without {kind}", {"constraints": tuple(k for k in CONSTRAINTS if k != kind)}, needs=kind)
        for kind in CONSTRAINTS
    ),
    Option("h = 0.03", {"step_length": (0.03, 0.03)}),
    Option("h = 0.1", {"step_length": (0.1, 0.1)}),
    Option("h = 0.3", {"step_length": (0.3, 0.3)}),
    Option("h = 0.7", {"step_length": (0.7, 0.7)}),
    Option("h 0.001 to 0.1", {"step_length": (0.001, 0.1)}),
    Option("h 0.03 to 1", {"step_length": (0.03, 1.0)}),
    Option("large steps 0.05", {"large_steps": 0.05}),
    Option("large steps 0.5", {"large_steps": 0.5}),
    Option("large steps alone", {"large_steps": 1.0}),
    Option("target not evened", {"even": False}),
    Option("aim from the light", {"aim": "light"}, needs="targets"),
    Option("max depth 3", {"max_depth": 3}),
    Option("max depth 5", {"max_depth": 5}),
    Option("max depth 12", {"max_depth": 12}),
    Option("bdpt", {}, "bdpt"),
    Option("path", {}, "path"),
)


def applies(option: Option, compiled: CompiledScene) -> bool:
    """Whether the option changes anything for this scene."""
    features, plan = compiled.features, compiled.plan
    has = {
        "": True,
        "HAS_NARROW": features["HAS_NARROW"],
        "targets": features["NUM_TARGETS"] > 0,
        # target charts of flat, wide surfaces need neither frames nor normals' tangents
        "HAS_DEVIATION": features["HAS_NARROW"] or features["HAS_SMOOTH"],
        **{constraint.name: constraint.present for constraint in plan.constraints},
    }
    return bool(has[option.needs])
