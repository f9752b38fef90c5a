"""The command line's arguments: what each command takes, its help, and what is refused at once."""

from __future__ import annotations

import argparse
import math
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn

from ..errors import PylmcError
from ..settings import (
    CHARTS,
    CONSTRAINTS,
    COORDINATES,
    DEFAULT_SECONDS,
    DIFFERENTIALS,
    INTEGRATORS,
    MATHS,
    MAX_DEPTH,
    PRECISIONS,
    RULES,
)

EPILOG = """\
examples:
  pylmc render keyhole -o keyhole.exr --seconds 120
  pylmc render keyhole:hole=0.02,alpha=0.01 -o small.exr --size 512x512
  pylmc render truck.glb --auto-camera --auto-light -o truck.exr
  pylmc render box -o reference.exr --integrator path --mutations-per-pixel 4000
  pylmc info keyhole
  pylmc compare keyhole.exr reference.exr -o difference.png

SCENE is a built-in scene (`pylmc scenes` lists them), such as keyhole, with parameters after a colon if wanted:
keyhole:hole=0.01,alpha=0.005; or the path of a .gltf or .glb file.

`pylmc COMMAND --help` explains a command. Bad input gives one line on stderr and exit code 2.
"""

CHAIN_OPTIONS = (
    "chart",
    "coordinates",
    "rule",
    "drift",
    "large_steps",
    "step_length",
    "blocks",
    "constraints",
    "differentials",
)


class _Parser(argparse.ArgumentParser):
    """argparse, with its complaints as PylmcError: one line, without the usage."""

    def error(self, message: str) -> NoReturn:
        raise PylmcError(f"{message} (see `{self.prog} --help`)")


class _Version(argparse.Action):
    """--version, looked up only when asked for."""

    def __init__(self, option_strings: Sequence[str], dest: str, help: str | None = None) -> None:
        super().__init__(option_strings, dest, nargs=0, help=help)

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> NoReturn:
        from .. import __version__

        print(f"pylmc {__version__}")
        parser.exit()


def _size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d+)[xX×](\d+)", text)
    if not match or not all(int(side) for side in match.groups()):
        raise argparse.ArgumentTypeError(f"'{text}' is not a size; give WIDTHxHEIGHT in pixels, such as 640x480")
    return int(match[1]), int(match[2])


def _positive(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not (math.isfinite(number) and number > 0):
        raise argparse.ArgumentTypeError(f"'{text}' is not a positive number")
    return number


def _depth(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= MAX_DEPTH:
        raise argparse.ArgumentTypeError(f"'{text}' is not a path length; give a number of segments, 1 to {MAX_DEPTH}")
    return int(text)


def _probability(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not 0 <= number <= 1:
        raise argparse.ArgumentTypeError(f"'{text}' is not a probability; give a number from 0 to 1")
    return number


def _step(text: str) -> tuple[float, float]:
    try:
        low, high = (float(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is no pair of step lengths; give two such as 0.01,0.3") from None
    return low, high


def _constraints(text: str) -> tuple[str, ...]:
    kinds = () if text == "none" else tuple(text.split(","))
    for kind in kinds:
        if kind not in CONSTRAINTS:
            raise argparse.ArgumentTypeError(f"'{kind}' is no constraint; give some of {','.join(CONSTRAINTS)}, or none")
    return kinds


def _seed(text: str) -> int:
    if not text.isdecimal() or int(text) >= 2**32:
        raise argparse.ArgumentTypeError(f"'{text}' is not a seed; give a whole number from 0 to {2**32 - 1}")
    return int(text)


def build_parser(run: Mapping[str, Callable[[argparse.Namespace], int]]) -> argparse.ArgumentParser:
    """The command line's parser; ``run`` names the function behind each command."""
    parser = _Parser(
        prog="pylmc",
        description="Markov-chain light transport on any OpenCL device, with constraint-preconditioned proposals.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--version", action=_Version, help="show the version and exit")
    commands = parser.add_subparsers(metavar="COMMAND", required=True, title="commands")

    def command(name: str, summary: str, more: str = "") -> argparse.ArgumentParser:
        sub = commands.add_parser(
            name,
            help=summary,
            description=f"{summary[0].upper()}{summary[1:]}.{more}",
            allow_abbrev=False,
        )
        sub.set_defaults(run=run[name])
        return sub

    render = command(
        "render",
        "draw a scene and write OUT.exr, OUT.png and OUT.json",
        " Ctrl-C ends it early and still writes the picture so far (exit code 130).",
    )
    _add_scene(render)
    render.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="OUT.exr",
        help="linear RGB picture; the tone-mapped .png and the figures in .json go beside it "
        "(default: the scene's name in this folder)",
    )
    effort = render.add_mutually_exclusive_group()
    effort.add_argument(
        "--seconds",
        type=_positive,
        metavar="S",
        help=f"time to sample, in seconds, set-up excluded (default: {DEFAULT_SECONDS:g})",
    )
    effort.add_argument(
        "--mutations-per-pixel",
        type=_positive,
        metavar="M",
        help="effort instead of time: Markov-chain steps, or samples, per pixel",
    )
    render.add_argument("--seed", type=_seed, default=0, metavar="N", help="of the random numbers (default: 0)")
    render.add_argument(
        "--device",
        metavar="SPEC",
        help="cpu, gpu, an index or part of a name, as `pylmc devices` shows them (default: "
        "PYOPENCL_CTX if set, else the first GPU, else the first CPU)",
    )
    _add_precision(render)
    render.add_argument(
        "--math",
        choices=MATHS,
        help="exact, or what may be shortened: relaxed (the compiler reorders, contracts), fast (and "
        "forgets infinities), native (short exp, log, sin, cos, roots) (default: exact)",
    )
    render.add_argument(
        "--integrator",
        choices=INTEGRATORS,
        default="lmc",
        help="Markov chains (lmc), their independent bidirectional sampler alone (bdpt), or a "
        "unidirectional path tracer (path) (default: lmc)",
    )
    _add_chain(render)
    render.add_argument("--quiet", action="store_true", help="no progress bar and no report")

    info = command("info", "say how a scene would be sampled: path lengths, lobes, constraints")
    _add_scene(info)
    _add_precision(info)
    _add_chain(info)

    compare = command(
        "compare", "measure how far picture A.exr is from the reference B.exr", " Prints relMSE, MSE, MAE, SMAPE and FLIP."
    )
    compare.add_argument("a", type=Path, metavar="A.exr", help="the picture to judge")
    compare.add_argument("b", type=Path, metavar="B.exr", help="the reference, of the same size")
    compare.add_argument("-o", "--output", type=Path, metavar="DIFF.png", help="write a picture of the differences")

    command("devices", "list the OpenCL devices that work, and why the others do not")
    command("scenes", "list the built-in scenes with their parameters' default values")
    return parser


def _add_scene(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "scene",
        metavar="SCENE",
        help="a built-in scene (`pylmc scenes`), with parameters if wanted: "
        "keyhole:hole=0.01,alpha=0.005; or a .gltf or .glb file",
    )
    parser.add_argument("--size", type=_size, metavar="WxH", help="of the film, in pixels (default: the scene's)")
    parser.add_argument(
        "--max-depth",
        type=_depth,
        default=8,
        metavar="K",
        help=f"longest light path, in segments, 1 to {MAX_DEPTH} (default: 8)",
    )
    parser.add_argument("--auto-camera", action="store_true", help="frame a file's scene that has no camera")
    parser.add_argument("--auto-light", action="store_true", help="light a file's scene that has no light")


def _add_precision(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--precision",
        choices=PRECISIONS,
        default="single",
        help="single (the fastest), mixed (rays in float32, all else in float64, or in pairs of floats "
        "where the device has no 64-bit floats), double (all in float64), float-float (mixed by "
        "pairs of floats) (default: single)",
    )


def _add_chain(parser: argparse.ArgumentParser) -> None:
    chain = parser.add_argument_group("the Markov chain (with --integrator lmc)")
    chain.add_argument(
        "--chart", choices=CHARTS, help="of the deviations from a lobe's reference direction (default: equal-area)"
    )
    chain.add_argument(
        "--coordinates", choices=COORDINATES, help="target charts where they help, or deviations everywhere (default: target)"
    )
    chain.add_argument("--rule", choices=RULES, help="how constraints are combined (default: sum)")
    chain.add_argument(
        "--drift", action="store_true", default=None, help="let proposals drift along the gradient (default: off)"
    )
    chain.add_argument(
        "--large-steps", type=_probability, metavar="P", help="probability of an independent step (default: 0.2)"
    )
    chain.add_argument(
        "--step-length",
        type=_step,
        metavar="LEAST,GREATEST",
        help="bounds of the small steps' length h, drawn log-uniformly (default: 0.01,0.3)",
    )
    chain.add_argument(
        "--blocks",
        action=argparse.BooleanOptionalAction,
        default=None,
        help="let small steps move a leading part of the path only (default: --blocks)",
    )
    chain.add_argument(
        "--constraints",
        type=_constraints,
        metavar="KINDS",
        help=f"what shapes proposals: some of {','.join(CONSTRAINTS)}, or none (default: all)",
    )
    chain.add_argument(
        "--differentials", choices=DIFFERENTIALS, help="full, or reduced: normals and frames taken as fixed (default: full)"
    )
