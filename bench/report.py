"""What all bench programs have in common: arguments, what figures are a property of, and how results are written."""

from __future__ import annotations

import argparse
import json
import math
import platform
import shlex
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from pylmc.device import survey

ROOT = Path(__file__).resolve().parents[1]


def arguments(about: str | None, out: str = "", device: bool = True) -> argparse.ArgumentParser:
    """A program's arguments, ``about`` being its docstring, with --device and, for a default ``out``, --out."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    if device:
        parser.add_argument("--device", default=None, help="as for pylmc render")
    if out:
        parser.add_argument("--out", type=Path, default=Path(out), help=f"folder for the results (default {out})")
    return parser


def circumstances(device: str | None = None) -> dict[str, str]:
    """What figures are a property of: the command, commit, device with its driver, processor and Python."""
    used = survey.select(device)
    program = getattr(sys.modules["__main__"], "__spec__", None)
    return {
        "command": shlex.join(["python", "-m", program.name if program else sys.argv[0], *sys.argv[1:]]),
        "commit": commit(),
        "device": f"{used.platform.name.strip()}: {used.name.strip()}",
        "driver": used.driver_version.strip(),
        "processor": processor(),
        "python": platform.python_version(),
    }


def commit() -> str:
    """The checkout's commit, with "-dirty" where files have changed since; "unknown" outside of a repository."""
    command = ["git", "-C", str(ROOT), "describe", "--always", "--dirty", "--exclude=*"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.stdout.strip() or "unknown"


def processor() -> str:
    """What the CPU calls itself."""
    told = Path("/proc/cpuinfo")
    lines = told.read_text(encoding="utf-8").splitlines() if told.exists() else []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.processor())


def words(made: Mapping[str, str]) -> str:
    """A sentence of `circumstances`, in Markdown."""
    return (
        f"Made by `{made['command']}` at commit {made['commit']}, on {made['device']}, driver {made['driver']}; "
        f"{made['processor']}, Python {made['python']}."
    )


def table_head(*columns: str) -> str:
    """The first two lines of a table in Markdown."""
    return f"| {' | '.join(columns)} |\n|{'---|' * len(columns)}"


class Report:
    """The results of a program, in a folder: NAME.json, NAME.md and NAME.png, each saying where its figures are from.

    ``pictures``: whether there will be any; what draws them is then missed before anything is measured.
    """

    def __init__(self, folder: Path, device: str | None = None, pictures: bool = True) -> None:
        if pictures and find_spec("matplotlib") is None:
            raise SystemExit("matplotlib is missing: pip install -e '.[bench]'")
        self.folder, self.made = folder, circumstances(device)
        folder.mkdir(parents=True, exist_ok=True)

    def json(self, name: str, results: Any) -> None:
        """Write ``results``, in which NumPy's numbers become Python's, and NaN and infinity null."""
        text = json.dumps({"made": self.made, "results": plain(results)}, indent=1, allow_nan=False)
        (self.folder / f"{name}.json").write_text(text + "\n", encoding="utf-8")

    def markdown(self, name: str, text: str) -> None:
        """Write ``text``, tables mostly, below a sentence on where it is from."""
        (self.folder / f"{name}.md").write_text(f"{words(self.made)}\n\n{text.rstrip()}\n", encoding="utf-8")

    @contextmanager
    def figure(self, name: str, rows: int = 1, columns: int = 1, *, dpi: int = 80, **options: Any) -> Iterator[Any]:
        """A figure and its panels, as matplotlib's ``subplots`` gives them, which are written at the end."""
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot

        figure, panels = pyplot.subplots(rows, columns, layout="constrained", **options)
        yield figure, panels
        about = {"Description": words(self.made)}
        figure.savefig(self.folder / f"{name}.png", dpi=dpi, metadata=about, pil_kwargs={"optimize": True})
        pyplot.close(figure)


def stored(path: Path) -> Any:
    """The results that an earlier run wrote to a JSON file; None where there is no such file."""
    return json.loads(path.read_text(encoding="utf-8"))["results"] if path.exists() else None


def plain(value: Any) -> Any:
    """``value`` as JSON has it."""
    if isinstance(value, Mapping):
        return {str(key): plain(part) for key, part in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [plain(part) for part in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value
