"""Every choice of the sampler that is not the scene's, validated in one place."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from .checks import check_choice, check_flag, check_integer, check_number, check_subset
from .errors import PylmcError

CHARTS = ("equal-area", "orthographic", "orthographic-unit")
COORDINATES = ("target", "deviation")
RULES = ("sum", "mean", "rms")
AIMS = ("everywhere", "light")
PROJECTIONS = ("normalise", "orthographic")
CONSTRAINTS = ("lobes", "portals", "objects", "normals")
DIFFERENTIALS = ("full", "reduced")
MATHS = ("exact", "relaxed", "fast", "native")
INTEGRATORS = ("lmc", "bdpt", "path")
PRECISIONS = ("single", "mixed", "double", "float-float")
MAX_DEPTH = 32
DEFAULT_SECONDS = 60.0  # of a render that is given neither time nor mutations


@dataclass(frozen=True)
class Settings:
    """How the chains move. The defaults are those measured best on the built-in scenes.

    chart: deviation chart (theory.md, 2); ``orthographic-unit`` is the preprint's, with its biased unit Jacobian.
    coordinates: ``target`` charts where they apply, or ``deviation``: the paper's phase space unchanged.
    rule: the combination rule (21). drift: whether steps follow the gradient. projection: of v_1, eq. (3)
    (``normalise``) or the preprint's alternative (``orthographic``); used with deviation coordinates only.
    max_depth: segments of the longest path. large_steps: probability of an independent step.
    step_length: (least, greatest) length h, drawn log-uniformly each step.
    aim: from where the independent sampler aims at portals and small objects: ``everywhere`` (light, camera, diffuse
    nodes) or ``light`` (its first direction only, as in theory.md, 6). even: whether the density is weighted so that dark
    and bright parts of the film get alike many samples (see :mod:`pylmc.sampling.evenness`), or is plain luminance.
    blocks: whether small steps may move a leading part of the path only (theory.md, 2, Blocks).
    constraints: the kinds that shape the proposal, of ``lobes``, ``portals``, ``objects`` and ``normals``; with none of them
    steps are isotropic: one radian or chart unit per direction. differentials: ``full``, or ``reduced``, which takes
    normals and frames as fixed while a path moves. math: ``exact`` built-ins without contraction; ``relaxed`` lets the
    compiler reorder and contract; ``fast`` lets it assume besides that no number is infinite or NaN; ``native`` takes the
    device's own short versions of exp, log, sin, cos and roots (single precision only). All but ``exact`` give up what
    the tests guarantee; docs/trade.md has what they cost and gain.
    """

    max_depth: int = 8
    chart: str = "equal-area"
    coordinates: str = "target"
    rule: str = "sum"
    drift: bool = False
    projection: str = "normalise"
    large_steps: float = 0.2
    step_length: tuple[float, float] = (0.01, 0.3)
    aim: str = "everywhere"
    even: bool = True
    blocks: bool = True
    constraints: tuple[str, ...] = CONSTRAINTS
    differentials: str = "full"
    math: str = "exact"

    def __post_init__(self) -> None:
        choices = (
            ("chart", CHARTS),
            ("coordinates", COORDINATES),
            ("rule", RULES),
            ("projection", PROJECTIONS),
            ("aim", AIMS),
            ("differentials", DIFFERENTIALS),
            ("math", MATHS),
        )
        for name, allowed in choices:
            check_choice(name, getattr(self, name), allowed)
        checked: dict[str, Any] = {
            "max_depth": check_integer("max_depth", self.max_depth, 1, MAX_DEPTH),
            "large_steps": check_number("large_steps", self.large_steps, 0, 1),
            "drift": check_flag("drift", self.drift),
            "even": check_flag("even", self.even),
            "blocks": check_flag("blocks", self.blocks),
            "constraints": check_subset("constraints", self.constraints, CONSTRAINTS),
        }
        try:
            low, high = self.step_length
            checked["step_length"] = (
                check_number("step_length[0]", low, 1e-6, 100),
                check_number("step_length[1]", high, low, 100),
            )
        except (TypeError, ValueError):
            raise PylmcError(f"step_length={self.step_length!r}: give (least, greatest); try (0.01, 0.3)") from None
        for name, value in checked.items():  # plain Python numbers, which JSON knows
            object.__setattr__(self, name, value)

    def defines(self) -> dict[str, Any]:
        """The kernel constants that these choices compile to."""
        constants: dict[str, Any] = {f"CHART_{chart.upper().replace('-', '_')}": i for i, chart in enumerate(CHARTS)}
        constants |= {f"RULE_{rule.upper()}": i for i, rule in enumerate(RULES)}
        constants |= {f"PROJECTION_{projection.upper()}": i for i, projection in enumerate(PROJECTIONS)}
        return constants | {
            "MAX_DEPTH": self.max_depth,
            "CHART": CHARTS.index(self.chart),
            "RULE": RULES.index(self.rule),
            "PROJECTION": PROJECTIONS.index(self.projection),
            "COORDINATES_TARGET": self.coordinates == "target",
            "DRIFT": self.drift,
            "AIM_EVERYWHERE": self.aim == "everywhere",
            "BLOCKS": self.blocks and self.coordinates == "target",
            "DIFFERENTIALS_REDUCED": self.differentials == "reduced",
            **{f"USE_{kind.upper()}": kind in self.constraints for kind in CONSTRAINTS},
        }

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """The names of all settings."""
        return tuple(field.name for field in fields(cls))
