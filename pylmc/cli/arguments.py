"""The command line's arguments: what each command takes, its help, and what is refused at once."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import Field, fields
from pathlib import Path
from typing import Any, NoReturn

from ..errors import PylmcError
from ..options import Choice, Flag, Kind, default_words, flag
from ..settings import Run, Settings

EPILOG = """\
examples:
  pylmc render keyhole -o keyhole.exr --seconds 120
  pylmc render keyhole:hole=0.02,alpha=0.01 -o small.exr --size 512x512
  pylmc render truck.glb --auto-camera --auto-light -o truck.exr
  pylmc render box -o reference.exr --integrator path --mutations-per-pixel 4000
  pylmc info keyhole
  pylmc compare keyhole.exr reference.exr -o difference.png

SCENE is a built-in scene (`pylmc scenes` lists them), such as keyhole, with parameters after a colon if wanted:
keyhole:hole=0.01,alpha=0.005; or the path of a scene file (glTF, GLB, STL).

`pylmc COMMAND --help` explains a command.

exit codes:
  0    done
  1    done, but stdout could not be written: it is closed or full (a picture is written all the same)
  2    bad input, or a file or device that cannot be used: one line on stderr says what and what to do
  130  ended by Ctrl-C (SIGINT); 143 by SIGTERM, 129 by SIGHUP: `render` writes the picture so far, and says so; a
       second Ctrl-C ends it at once
"""


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


def _reader(item: Field[Any]) -> Callable[[str], Any]:
    """What argparse calls with the text given for an option: its value, checked as the API checks it."""
    kind: Kind = item.metadata["kind"]

    def read(text: str) -> Any:
        try:
            value = kind.read(text)
        except (ValueError, KeyError):
            value = text  # which the check complains about
        try:
            return kind.check(item.name, value)
        except PylmcError as error:
            raise argparse.ArgumentTypeError(str(error)) from None

    return read


def _add_option(parser: Any, item: Field[Any]) -> None:
    """An argument for a field of Settings or Run; None where it is not given, so that the API's default counts."""
    kind, metavar = item.metadata["kind"], item.metadata["metavar"]
    help = f"{item.metadata['help']} (default: {default_words(item)})".replace("%", "%%")
    name = f"--{flag(item.name)}"
    if isinstance(kind, Flag):
        parser.add_argument(name, action=argparse.BooleanOptionalAction, default=None, help=help)
        return
    if isinstance(kind, Choice):
        metavar = f"{{{','.join(kind.allowed)}}}"
    parser.add_argument(name, type=_reader(item), metavar=metavar, help=help)


def _add_settings(parser: argparse.ArgumentParser) -> None:
    """All of Settings, grouped by the integrators that they concern."""
    groups: dict[tuple[str, ...], Any] = {}
    for item in fields(Settings):
        concerned = item.metadata["integrators"]
        if concerned not in groups:
            title = f"how light is sampled, with --integrator {' or '.join(concerned)}" if concerned else "how light is sampled"
            groups[concerned] = parser.add_argument_group(title)
        _add_option(groups[concerned], item)


def given(options: argparse.Namespace, kind: type) -> dict[str, Any]:
    """Those of the fields of ``kind`` (Settings or Run) that were given, for the API, which knows the defaults."""
    names = [item.name for item in fields(kind)]
    return {name: getattr(options, name) for name in names if getattr(options, name, None) is not None}


def refuse_what_does_not_concern(options: argparse.Namespace) -> None:
    """Raise PylmcError for a setting that has no meaning with the chosen integrator."""
    integrator = given(options, Run).get("integrator", Run.integrator)
    chosen = given(options, Settings)
    for item in fields(Settings):
        concerned = item.metadata["integrators"]
        if item.name in chosen and concerned and integrator not in concerned:
            raise PylmcError(
                f"--{flag(item.name)} has no meaning with --integrator {integrator}, only with {' or '.join(concerned)}; "
                "leave one of them out"
            )


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
        " Ctrl-C, SIGTERM and SIGHUP end it early and still write the picture so far (exit codes 130, 143, 129).",
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
    for item in fields(Run):
        _add_option(effort if item.name in ("seconds", "mutations_per_pixel") else render, item)
    render.add_argument("--quiet", action="store_true", help="no progress and no report")
    _add_settings(render)

    info = command("info", "say how a scene would be sampled: path lengths, lobes, constraints")
    _add_scene(info)
    _add_option(info, next(item for item in fields(Run) if item.name == "precision"))
    _add_settings(info)

    compare = command(
        "compare", "measure how far picture A.exr is from the reference B.exr", " Prints relMSE, MSE, MAE, SMAPE and FLIP."
    )
    compare.add_argument("a", type=Path, metavar="A.exr", help="the picture to judge")
    compare.add_argument("b", type=Path, metavar="B.exr", help="the reference, of the same size")
    compare.add_argument("-o", "--output", type=Path, metavar="DIFF.png", help="write a picture of the differences")

    command("devices", "list the OpenCL devices that work, and why the others do not")
    command("scenes", "list the built-in scenes with their parameters, and the kinds of scene files")
    return parser


def _add_scene(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "scene",
        metavar="SCENE",
        help="a built-in scene (`pylmc scenes`), with parameters if wanted: "
        "keyhole:hole=0.01,alpha=0.005; or a scene file (glTF, GLB, STL)",
    )
    parser.add_argument("--size", type=_size, metavar="WxH", help="of the film, in pixels (default: the scene's)")
    parser.add_argument("--auto-camera", action="store_true", help="frame a file's scene that has no camera")
    parser.add_argument("--auto-light", action="store_true", help="light a file's scene that has no light")
