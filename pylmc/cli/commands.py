"""The `pylmc` command.

Whatever a person got wrong comes out as one line, ``pylmc: error: …``, with exit code 2. A command that a signal ends
exits with 128 and the signal's number; a render writes the picture so far first. Output that cannot be written stops
nothing, and makes the exit code 1.
"""

from __future__ import annotations

import argparse
import importlib
import math
import os
import re
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ..errors import PylmcError, PylmcWarning
from ..interruption import gently
from ..settings import Run, Settings
from .arguments import build_parser, given, refuse_what_does_not_concern
from .signals import Signals
from .streams import outputs

__all__ = ["main"]

OUTPUT_LOST = 1


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command with ``arguments`` (``sys.argv[1:]`` if None) and return its exit code."""
    with outputs() as out, Signals() as signals:
        code = _run(arguments, signals)
        out.flush()
        if out.error is None:
            return code
        if not isinstance(out.error, BrokenPipeError):  # of `pylmc … | head`, which has seen enough
            _complain(f"error: stdout cannot be written ({out.error.strerror}); the text meant for it is lost")
        return code or OUTPUT_LOST


def _run(arguments: Sequence[str] | None, signals: Signals) -> int:
    try:
        commands = {"render": _render, "info": _info, "compare": _compare, "devices": _devices, "scenes": _scenes}
        options = build_parser(commands).parse_args(arguments, argparse.Namespace(signals=signals))
        with _one_line_warnings():
            code: int = options.run(options)
        return code
    except PylmcError as error:
        _complain(f"error: {error}")
        return 2
    except KeyboardInterrupt:
        _complain(f"interrupted by {signals.name}; nothing was written")
        return signals.code
    except SystemExit as done:  # of --help and --version
        return int(done.code or 0)


def _complain(text: str) -> None:
    print(f"pylmc: {' '.join(text.split())}", file=sys.stderr, flush=True)


@contextmanager
def _one_line_warnings() -> Iterator[None]:
    """Every PylmcWarning as one line on stderr, without Python's own trimmings."""
    with warnings.catch_warnings():
        warnings.simplefilter("always", PylmcWarning)
        others = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *place: Any, **more: Any) -> None:
            if issubclass(category, PylmcWarning):
                _complain(f"warning: {message}")
            else:
                others(message, category, *place, **more)

        warnings.showwarning = show
        yield


def _import(*modules: str) -> None:
    """Import modules of the package; a signal meanwhile takes effect afterwards.

    trimesh guards its optional imports with ``except BaseException`` and would swallow it.
    """
    with gently() as asked:
        for module in modules:
            importlib.import_module(f"pylmc.{module}")
    if asked.is_set():
        raise KeyboardInterrupt


# --- commands ---------------------------------------------------------------------------------------------------------


def _render(options: argparse.Namespace) -> int:
    refuse_what_does_not_concern(options)
    _import("scene.loading", "rendering")
    scene_name, parameters = parse_scene(options.scene)
    output = check_output(options.output or Path(f"{Path(scene_name).stem}.exr"))
    import pylmc

    from ..device import survey

    survey.select(options.device)  # complain about the device before a scene is loaded
    scene = _load(options, scene_name, parameters)
    with gently() as asked:  # until the picture is on the disk
        picture = pylmc.render(scene, progress=not options.quiet, **given(options, Run), **given(options, Settings))
        interrupted = bool(picture.diagnostics.get("interrupted"))
        if interrupted and 0 in (picture.diagnostics.get("mutations"), picture.diagnostics.get("samples")):
            raise KeyboardInterrupt  # a black picture must not replace an earlier one
        try:
            output.parent.mkdir(parents=True, exist_ok=True)
            written = picture.save(output)
        except OSError as error:
            raise PylmcError(f"cannot write {output}: {error.strerror or error}") from None
    if interrupted or asked.is_set():
        what = "the picture so far was written" if interrupted else "the picture was done and is written"
        _complain(f"interrupted by {options.signals.name}; {what}")
    if not options.quiet:
        print("wrote", ", ".join(str(path) for path in written))
    return options.signals.code if interrupted or asked.is_set() else 0


def _info(options: argparse.Namespace) -> int:
    _import("scene.loading", "inspection")
    scene_name, parameters = parse_scene(options.scene)
    import pylmc

    scene = _load(options, scene_name, parameters)
    print(pylmc.info(scene, **given(options, Run), **given(options, Settings)))
    return 0


def _compare(options: argparse.Namespace) -> int:
    for path in (options.a, options.b):
        if not path.is_file():
            raise PylmcError(f"{path} does not exist or is not a file")
    picture = check_output(options.output, (".png",)) if options.output else None
    from ..picture.metrics import compare

    try:
        if picture:
            picture.parent.mkdir(parents=True, exist_ok=True)
        figures = compare(options.a, options.b, picture)
    except OSError as error:
        raise PylmcError(f"cannot compare {options.a} and {options.b}: {error}") from None
    width = max(map(len, figures))
    for name, value in figures.items():
        print(f"{name:<{width}}  {value:.6g}")
    if picture:
        print(f"wrote {picture}")
    return 0


def _devices(options: argparse.Namespace) -> int:
    from ..device import survey

    survey.refresh()
    working, broken = survey.usable(), survey.rejected()
    default = survey.select(None) if working else None
    for index, info in enumerate(working):
        is_default = default is not None and survey.describes(info, default)
        abilities = [name for name, has in (("fp64", info.fp64), ("int64 atomics", info.int64_atomics)) if has]
        print(f"{'*' if is_default else ' '} {index}  {info.kind}  {info.label}")
        print(
            f"       {info.compute_units} compute units, {info.memory / 2**30:.1f} GiB, driver {info.driver}"
            f"{', ' if abilities else ''}{', '.join(abilities)}"
        )
    if working:
        print("(* is used unless --device says otherwise: cpu, gpu, a number, or part of a name)")
    if broken:
        print("not usable:")
    for item in broken:
        print(f"  {item.label}: {item.reason}")
    if not working:
        survey.select(None)  # raises, with the remedy
    return 0


def _scenes(options: argparse.Namespace) -> int:
    from ..scene import builtin
    from ..scene.importers import importers

    for name in builtin.NAMES:
        known = builtin.parameters(name)
        defaults = ",".join(f"{key}={default:g}" for key, (default, _) in known.items())
        print(f"{name}{':' if defaults else ''}{defaults}\n    {builtin.summary(name)}")
        for key, (_, parameter) in known.items():
            print(f"    {key}: {parameter.help} (greater than 0, at most {parameter.greatest:g})")
    print(f"or a file: {', '.join(sorted(importers()))}")
    return 0


def _load(options: argparse.Namespace, name: str, parameters: dict[str, Any]) -> Any:
    import pylmc

    width, height = options.size or (None, None)
    return pylmc.load(
        name, width=width, height=height, auto_camera=options.auto_camera, auto_light=options.auto_light, **parameters
    )


# --- reading arguments ------------------------------------------------------------------------------------------------


def parse_scene(text: str) -> tuple[str, dict[str, Any]]:
    """A SCENE argument as a name or path and its parameters; raises PylmcError for a malformed or missing one."""
    from ..scene import builtin

    name, colon, rest = text.partition(":")
    if not text.strip():
        raise PylmcError("no scene is given; name a file or a built-in scene (`pylmc scenes`)")
    if name not in builtin.NAMES and Path(text).exists():
        if Path(text).is_dir():
            raise PylmcError(f"scene '{text}' is a folder; name a scene file in it")
        return text, {}
    if not re.fullmatch(r"[A-Za-z_]\w*", name):
        raise PylmcError(f"scene '{text}': no such file; give a path, or a built-in scene (`pylmc scenes`)")
    parameters: dict[str, Any] = {}
    for part in rest.split(",") if colon else []:
        key, equals, value = (piece.strip() for piece in part.partition("="))
        if not (equals and value and re.fullmatch(r"[A-Za-z_]\w*", key)):
            raise PylmcError(f"scene '{text}': '{part}' is not of the form name=value")
        if key in ("name_or_path", "auto_camera", "auto_light", "width", "height"):  # load()'s own, which no scene has
            raise PylmcError(f"scene '{text}' has no parameter '{key}'")
        if key in parameters:
            raise PylmcError(f"scene '{text}': parameter '{key}' is given twice")
        parameters[key] = _value(value, f"scene '{text}': parameter '{key}'")
    return name, parameters


def _value(text: str, what: str) -> int | float | bool | str:
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    try:
        return int(text)
    except ValueError:
        pass
    try:
        number = float(text)
    except ValueError:
        return text
    if not math.isfinite(number):
        raise PylmcError(f"{what} is {text}; give a finite number")
    return number


def check_output(path: Path, endings: tuple[str, ...] = (".exr",)) -> Path:
    """``path``, if a file can be written there (its folder may have to be made); else PylmcError."""
    if path.suffix.lower() not in endings:
        raise PylmcError(f"output '{path}' must end in {' or '.join(endings)}")
    for file in (path, path.with_suffix(".png"), path.with_suffix(".json")):
        if file.is_dir():
            raise PylmcError(f"output '{file}' is a folder")
        if file.exists() and not os.access(file, os.W_OK):
            raise PylmcError(f"output '{file}' exists and may not be overwritten")
    folder = path.absolute().parent
    while not folder.exists():
        folder = folder.parent
    if not folder.is_dir():
        raise PylmcError(f"output '{path}': {folder} is not a folder")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise PylmcError(f"output '{path}': the folder {folder} may not be written to")
    return path
