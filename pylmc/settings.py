"""Every choice of the sampler that is not the scene's, validated in one place."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from .errors import PylmcError

CHARTS = ("equal-area", "orthographic", "orthographic-unit")
COORDINATES = ("target", "deviation")
RULES = ("sum", "mean", "rms")
PROJECTIONS = ("normalise", "orthographic")
INTEGRATORS = ("lmc", "bdpt", "path")
PRECISIONS = ("single", "mixed", "double")
MAX_DEPTH = 32


@dataclass(frozen=True)
class Settings:
    """How the chains move. The defaults are those measured best on the built-in scenes.

    chart: deviation chart (theory.md, 2); ``orthographic-unit`` is the preprint's, with its biased unit Jacobian.
    coordinates: ``target`` charts where they apply, or ``deviation``: the paper's phase space unchanged.
    rule: the combination rule (21). drift: whether steps follow the gradient. projection: of v_1, eq. (3)
    (``normalise``) or the preprint's alternative (``orthographic``); used with deviation coordinates only.
    max_depth: segments of the longest path. large_steps: probability of an independent step.
    step: (least, greatest) step length h, drawn log-uniformly each step. even: whether the target is weighted so that dark
    and bright parts of the film get alike many samples (see :mod:`pylmc.evenness`), or is plain luminance.
    """

    max_depth: int = 8
    chart: str = "equal-area"
    coordinates: str = "target"
    rule: str = "sum"
    drift: bool = False
    projection: str = "normalise"
    large_steps: float = 0.1
    step: tuple[float, float] = (0.02, 0.4)
    even: bool = True

    def __post_init__(self) -> None:
        choices = (("chart", CHARTS), ("coordinates", COORDINATES), ("rule", RULES), ("projection", PROJECTIONS))
        for name, allowed in choices:
            check_choice(name, getattr(self, name), allowed)
        check_integer("max_depth", self.max_depth, 1, MAX_DEPTH)
        if not 0 <= self.large_steps <= 1:
            raise PylmcError(f"large_steps={self.large_steps!r} is a probability; give a number from 0 to 1")
        low, high = self.step
        if not 0 < low <= high < 100:
            raise PylmcError(f"step={self.step!r}: give (least, greatest) with 0 < least <= greatest; try (0.02, 0.4)")

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
        }

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """The names of all settings."""
        return tuple(field.name for field in fields(cls))


def check_choice(name: str, value: Any, allowed: tuple[str, ...]) -> None:
    """Raise PylmcError unless ``value`` is one of ``allowed``."""
    if value not in allowed:
        raise PylmcError(f"{name}={value!r} is unknown; choose from {', '.join(allowed)}")


def check_integer(name: str, value: Any, least: int, greatest: int) -> None:
    """Raise PylmcError unless ``value`` is a whole number in [least, greatest]."""
    try:
        whole = int(value) == value
    except (TypeError, ValueError):
        whole = False
    if not whole or not least <= value <= greatest:
        raise PylmcError(f"{name}={value!r}: give a whole number from {least} to {greatest}")


def check_precision(precision: str) -> None:
    """Only single precision exists yet; say so rather than render in another one."""
    check_choice("precision", precision, PRECISIONS)
    if precision != "single":
        raise PylmcError(f"precision '{precision}' is not available yet; use 'single'")
