"""Every choice that is not the scene's: its name, default, values and help, each written once.

``Settings`` are how light paths are sampled; ``Run`` is how much of that is done, and on what. The API's signatures and
docstrings, the command line's arguments and docs/settings.md are made from these fields: a new setting is one field.
"""

from __future__ import annotations

import inspect
import textwrap
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any, TypeVar

from .errors import PylmcError
from .integrators import INTEGRATORS
from .options import (
    Anything,
    Choice,
    Flag,
    Integer,
    Interval,
    Number,
    Subset,
    check_all,
    check_names,
    option,
)

CHARTS = ("equal-area", "orthographic", "orthographic-unit")
COORDINATES = ("target", "deviation")
RULES = ("sum", "mean", "rms")
AIMS = ("everywhere", "light")
PROJECTIONS = ("normalise", "orthographic")
CONSTRAINTS = ("lobes", "portals", "objects", "normals", "cones")
DIFFERENTIALS = ("full", "reduced")
MATHS = ("exact", "relaxed", "fast", "native")
PRECISIONS = ("single", "mixed", "double", "float-float")
MAX_DEPTH = 32
DEFAULT_SECONDS = 60.0  # of a render that is given neither time nor mutations
CHAINS, SAMPLED = ("lmc",), ("lmc", "bdpt")  # what concerns the Markov chains; what their independent sampler as well


@dataclass(frozen=True)
class Settings:
    """How light paths are sampled. The defaults are those measured best on the built-in scenes."""

    max_depth: int = option(8, Integer(1, MAX_DEPTH, "segments"), "longest light path, in segments", metavar="K")
    math: str = option(
        "exact",
        Choice(*MATHS),
        "what may be done to arithmetic: nothing (exact); the compiler reorders and contracts (relaxed), and assumes that no "
        "number is infinite or NaN (fast); the device's own short exp, log, sin, cos and roots (native; precision single "
        "only). All but exact give up what the tests guarantee: docs/trade.md has what they cost and gain",
    )
    aim: str = option(
        "everywhere",
        Choice(*AIMS),
        "from where the independent sampler aims at portals and small objects: light, camera and diffuse nodes "
        "(everywhere), or the light's first direction only (light)",
        integrators=SAMPLED,
    )
    chart: str = option(
        "equal-area",
        Choice(*CHARTS),
        "chart of the deviations from a lobe's reference direction; orthographic-unit is the preprint's, whose unit "
        "Jacobian is biased",
        integrators=CHAINS,
    )
    coordinates: str = option(
        "target",
        Choice(*COORDINATES),
        "target charts where they help, or deviations everywhere: the preprint's phase space unchanged",
        integrators=CHAINS,
    )
    rule: str = option("sum", Choice(*RULES), "how constraints are combined (theory, eq. 21)", integrators=CHAINS)
    drift: bool = option(False, Flag(), "let proposals drift along the gradient of the density", integrators=CHAINS)
    projection: str = option(
        "normalise",
        Choice(*PROJECTIONS),
        "of the first direction, with deviation coordinates: normalise (eq. 3), or the preprint's alternative (orthographic)",
        integrators=CHAINS,
    )
    large_steps: float = option(
        0.2, Number(0, 1, "probability"), "probability of an independent step", metavar="P", integrators=CHAINS
    )
    light_steps: float = option(
        0.1,
        Number(0, 1, "probability"),
        "of the other steps, the part that joins the path to another light, where the scene has several without area",
        metavar="P",
        integrators=CHAINS,
    )
    step_length: tuple[float, float] = option(
        (0.01, 0.3),
        Interval(1e-6, 100),
        "bounds of the small steps' length h, drawn log-uniformly each step",
        metavar="LEAST,GREATEST",
        integrators=CHAINS,
    )
    even: bool = option(
        True,
        Flag(),
        "weight the density so that dark and bright parts of the film get alike many samples; else it is plain luminance",
        integrators=CHAINS,
    )
    blocks: bool = option(True, Flag(), "let small steps move a leading part of the path only", integrators=CHAINS)
    constraints: tuple[str, ...] = option(
        CONSTRAINTS,
        Subset(*CONSTRAINTS),
        f"what shapes proposals: some of {', '.join(CONSTRAINTS)}; with none, small steps are isotropic",
        metavar="KINDS",
        integrators=CHAINS,
    )
    differentials: str = option(
        "full",
        Choice(*DIFFERENTIALS),
        "how directions follow a moving path: full, or reduced, which takes normals and frames as fixed",
        integrators=CHAINS,
    )
    chains: int | None = option(
        None,
        Integer(1, 1 << 24),
        "how many chains run side by side",
        metavar="N",
        unset="4096, and 65536 in a render on a GPU",
        integrators=CHAINS,
    )
    candidates: int | None = option(
        None,
        Integer(1, 1 << 30),
        "independent paths of each length and ending from which the chains' start is drawn",
        metavar="N",
        unset=f"{1 << 18}, and {1 << 16} in a short render",
        integrators=CHAINS,
    )

    def __post_init__(self) -> None:
        check_all(self)

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
            "USE_PORTALS": "portals" in self.constraints,
        }

    @classmethod
    def given(cls, settings: dict[str, Any]) -> Settings:
        """Settings from keyword arguments. Raises PylmcError for an unknown name, with the likeliest known one."""
        check_names(settings, cls.names())
        return cls(**settings)

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """The names of all settings."""
        return tuple(item.name for item in fields(cls))


@dataclass(frozen=True)
class Run:
    """How long a picture is sampled, with what, and on what."""

    seconds: float | None = option(
        None,
        Number(1e-9, 1e9, "positive number of seconds"),
        "time to sample, in seconds, set-up excluded",
        metavar="S",
        unset=f"{DEFAULT_SECONDS:g}",
    )
    mutations_per_pixel: float | None = option(
        None,
        Number(1e-9, 1e9, "positive number"),
        "work instead of time: Markov-chain steps, or samples, per pixel",
        metavar="M",
        unset="as many as the time allows",
    )
    seed: int = option(0, Integer(0, 2**32 - 1), "of the random numbers; it and the work fix the picture", metavar="N")
    device: object = option(
        None,
        Anything(),
        "cpu, gpu, an index or part of a name, as `pylmc devices` shows them",
        metavar="SPEC",
        unset="PYOPENCL_CTX if set, else the first GPU, else the first CPU",
    )
    precision: str = option(
        "single",
        Choice(*PRECISIONS),
        "single (the fastest), mixed (rays in float32, all else in float64, or in pairs of floats where the device has no "
        "64-bit floats), double (all in float64), float-float (mixed by pairs of floats)",
    )
    integrator: str = option(
        "lmc",
        Choice(*INTEGRATORS),
        ", ".join(f"{entry.what} ({name})" for name, entry in INTEGRATORS.items()),
    )

    def __post_init__(self) -> None:
        if self.seconds is not None and self.mutations_per_pixel is not None:
            raise PylmcError("give seconds or mutations_per_pixel, not both")
        check_all(self)


Explained = TypeVar("Explained", bound=Callable[..., Any])


def explained(*options: type) -> Callable[[Explained], Explained]:
    """A decorator for what takes ``options``' fields as keywords: its signature shows them, and its docstring their help.

    Fields that it names itself keep their place in the signature; the others stand where it has ``**settings``.
    """

    def explain(thing: Explained) -> Explained:
        known = {item.name: item for kind in options for item in fields(kind)}
        function: Any = thing.__init__ if isinstance(thing, type) else thing  # type: ignore[misc]
        signature = inspect.signature(function)
        named = [p for p in signature.parameters.values() if p.kind is not p.VAR_KEYWORD]
        if len(named) < len(signature.parameters):
            there = {p.name for p in named}
            named += [
                inspect.Parameter(item.name, inspect.Parameter.KEYWORD_ONLY, default=item.default, annotation=item.type)
                for item in known.values()
                if item.name not in there
            ]
            function.__signature__ = signature.replace(parameters=named)
        if thing.__doc__:  # there is none with python -OO
            parts = [inspect.cleandoc(thing.__doc__), "", "Keyword arguments:", ""]
            for name, item in known.items():
                default = repr(item.default) if item.default is not None else item.metadata["unset"]
                parts.append(
                    textwrap.fill(f"{name}: {item.metadata['help']} (default: {default})", 110, subsequent_indent="    ")
                )
            thing.__doc__ = "\n".join(parts) + "\n"
        return thing

    return explain


explained(Settings)(Settings)
explained(Run)(Run)
