"""OpenCL implementations on this machine: where their libraries are, and what they need to be opened.

Whether they work is another question: see :mod:`pylmc.device.survey`.
"""

from __future__ import annotations

import json
import os
import sys
import sysconfig
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Implementation:
    """What the ICD loader is to open. ``library`` is empty where the system's own loader finds it (macOS, Windows)."""

    label: str
    library: str
    preload: tuple[str, ...] = ()  # libraries that it needs and the dynamic linker would not find
    path: str = ""  # a folder with programs that it needs, appended to PATH


def path_with(implementation: Implementation) -> str:
    """PATH with the implementation's own programs last, so that they never replace the system's."""
    folders = os.environ.get("PATH", os.defpath).split(os.pathsep)
    if implementation.path and implementation.path not in folders:
        folders.append(implementation.path)
    return os.pathsep.join(folders)


def implementations() -> list[Implementation]:
    """Every implementation that this machine may have, in no order of merit."""
    if not sys.platform.startswith("linux"):
        return [Implementation("the system's OpenCL", "")]
    given = os.environ.get("OCL_ICD_VENDORS")
    if given:
        path = Path(given)
        if path.is_dir():
            return list(_from_icd_files(path))
        if path.suffix == ".icd":
            return [Implementation(given, _first_line(path))]
        return [Implementation(given, given)]
    found = list(_from_icd_files(Path("/etc/OpenCL/vendors")))
    # PyPI packages may leave .icd files here that point nowhere; conda's are good.
    found += [i for i in _from_icd_files(Path(sys.prefix, "etc/OpenCL/vendors")) if Path(i.library).is_file()]
    names = " ".join(implementation.library for implementation in found).lower()
    if "pocl" not in names:
        found += unpacked()
    if "intelocl" not in names:
        library = Path(sys.prefix, "lib/libintelocl.so")
        found += [Implementation(str(library), str(library))] * library.is_file()
    if "nvidia" not in names:
        library_found = resolve("libnvidia-opencl.so.1")
        found += [Implementation(library_found, library_found)] if "/" in library_found else []
    return found


def _from_icd_files(folder: Path) -> Iterator[Implementation]:
    for file in sorted(folder.glob("*.icd")):
        yield Implementation(str(file), _first_line(file))


def _first_line(file: Path) -> str:
    try:
        lines = os.fsdecode(file.read_bytes()).splitlines()
    except OSError:
        lines = []
    return lines[0].strip() if lines else ""


def unpacked() -> list[Implementation]:
    """PoCL as tools/setup.py unpacked it without root: described by ``implementation.json`` in its folder."""
    folder = Path(os.environ.get("PYLMC_OPENCL") or Path(__file__).resolve().parents[2] / ".opencl").absolute()
    try:
        description = json.loads((folder / "implementation.json").read_text(encoding="utf-8"))
        # Paths are relative to the folder, so that a checkout can be moved.
        return [
            Implementation(
                str(folder),
                str(folder / description["library"]),
                tuple(str(folder / library) for library in description["preload"]),
                str(folder / description["path"]) if "path" in description else "",
            )
        ]
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return []


def resolve(library: str) -> str:
    """The path of ``library`` where the dynamic linker would look, else its bare name."""
    if "/" in library:
        return library
    folders = os.environ.get("LD_LIBRARY_PATH", "").split(":")
    folders += [f"/usr/lib/{sysconfig.get_config_var('MULTIARCH')}", "/usr/lib64", "/usr/lib", "/usr/local/lib"]
    folders += ["/usr/local/nvidia/lib64", "/usr/lib/wsl/lib"]
    return next((f"{folder}/{library}" for folder in folders if folder and Path(folder, library).is_file()), library)
