"""Does a rebuilding keep every picture? Builds two commits and compares their pictures and counters bit for bit.

    python -m bench.same HEAD~1               this checkout as it stands, against a commit
    python -m bench.same v0.1.0 --with main   two commits
    python -m bench.same HEAD --quick         single precision only (about a minute a side)

Each side renders every built-in scene with every integrator and precision, a glTF file, a textured scene of several lobes,
and runs with drift and with deviation coordinates, for a fixed number of mutations and a fixed seed, on this machine's
default device (`bench/same_record.py`). The exit code is 1 where anything differs, and OUT/same.json says what was
compared, and on what: bits are a property of device, driver and processor as well.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from .report import ROOT, Report, arguments


@contextmanager
def checkout(commit: str | None) -> Iterator[Path]:
    """A folder with the commit's files; this checkout itself for None."""
    if commit is None:
        yield ROOT
        return
    with tempfile.TemporaryDirectory(prefix="pylmc-same-") as folder:
        git = ["git", "-C", str(ROOT), "worktree"]
        subprocess.run([*git, "add", "--detach", "--force", folder, commit], check=True, capture_output=True)
        try:
            yield Path(folder)
        finally:
            subprocess.run([*git, "remove", "--force", folder], check=True, capture_output=True)


def record(tree: Path, out: Path, quick: bool, only: str) -> dict[str, dict[str, Any]]:
    """Run the recorder on a checkout; what each case counted, with its picture's digest."""
    # -P: the folder of the script holds names of the standard library (numbers)
    command = [sys.executable, "-P", str(Path(__file__).with_name("same_record.py")), str(out), "--only", only]
    environment = {**os.environ, "PYTHONPATH": str(tree)}
    subprocess.run([*command, "--quick"] if quick else command, cwd=tree, env=environment, check=True, stdout=sys.stderr)
    return {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in sorted(out.glob("*.json"))}


def difference(name: str, ours: dict[str, Any], theirs: dict[str, Any], folders: tuple[Path, Path]) -> str:
    """What differs in one case, in words; empty where nothing does."""
    if "failed" in ours or "failed" in theirs:
        return f"fails: {ours.get('failed') or theirs.get('failed')}"
    counted = [key for key in theirs if key != "sha256" and ours.get(key) != theirs[key]]
    said = [f"{key} {theirs[key]} -> {ours.get(key)}" for key in counted]
    if ours["sha256"] != theirs["sha256"]:
        a, b = (np.load(folder / f"{name}.npy").astype(np.float64) for folder in folders)
        unlike = f"{np.count_nonzero(a != b)} of {a.size} numbers" if a.shape == b.shape else f"shapes {a.shape}, {b.shape}"
        said.insert(0, f"picture: {unlike}, mean {b.mean():.9g} -> {a.mean():.9g}")
    return "; ".join(said)


def main() -> int:
    parser = arguments(__doc__, "out/same", device=False)
    parser.add_argument("base", metavar="BASE", help="the commit to compare with")
    parser.add_argument("--with", dest="head", metavar="COMMIT", help="the other one (default: this checkout as it stands)")
    parser.add_argument("--quick", action="store_true", help="single precision only")
    parser.add_argument("--only", default="", metavar="TEXT", help="cases whose name holds this")
    options = parser.parse_args()
    folders = (options.out.resolve() / "head", options.out.resolve() / "base")
    for folder in folders:
        for file in folder.glob("*.*"):
            file.unlink()
    with checkout(options.head) as head, checkout(options.base) as base, ThreadPoolExecutor(2) as pool:
        sides = [
            pool.submit(record, tree, folder, options.quick, options.only)
            for tree, folder in zip((head, base), folders, strict=True)
        ]
        ours, theirs = (side.result() for side in sides)
    found = {name: difference(name, ours[name], theirs[name], folders) for name in theirs}
    for name, words in found.items():
        print(f"{'same  ' if not words else 'DIFFERS'} {name}{': ' if words else ''}{words}")
    if not found:
        parser.error(f"no case's name holds '{options.only}'")
    unlike = sum(bool(words) for words in found.values())
    print(f"{len(found) - unlike} of {len(found)} cases are the same, bit for bit")
    Report(options.out, pictures=False).json(
        "same", {"base": options.base, "head": options.head or "working tree", "differences": found}
    )
    return 1 if unlike else 0


if __name__ == "__main__":
    sys.exit(main())
