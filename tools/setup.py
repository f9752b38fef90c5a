"""Sets up pylmc in this checkout: a virtual environment, the package, and an OpenCL device that works.

Run by tools/setup.sh (which finds a Python) from the Makefile: ``setup.sh [--dev]``. Uses only the standard library.
Every step is skipped when it has been done. PYLMC_SETUP_OPENCL=apt, unpack or intel restricts the ways in which an
OpenCL implementation may be installed; none forbids it.
"""

from __future__ import annotations

import argparse
import ctypes
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
VENV = ROOT / ".venv"
PYTHON = VENV / "bin" / "python"
OPENCL = ROOT / ".opencl"
LOG = OPENCL / "setup.log"
PACKAGE = "pocl-opencl-icd"
INTEL = ("intel-opencl-rt>=2025", "intel-cmplr-lib-rt>=2025")


class Failed(Exception):
    """A step that could not be done; the message says why and what to do."""


def say(text: str) -> None:
    print(f"setup: {text}", flush=True)


def quiet(*command: str | Path, environ: dict[str, str] | None = None, folder: Path = ROOT) -> str:
    """Run a command with its output kept in the log; returns its stdout, raises Failed with its last line."""
    LOG.parent.mkdir(exist_ok=True)
    result = subprocess.run(
        [str(part) for part in command],
        env={**os.environ, **(environ or {})},
        cwd=folder,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        errors="replace",
        check=False,
    )
    with LOG.open("a", encoding="utf-8") as log:
        log.write(f"$ {' '.join(map(str, command))}\n{result.stdout}{result.stderr}[exit code {result.returncode}]\n\n")
    if result.returncode:
        lines = (result.stderr.strip() or result.stdout.strip() or "no output").splitlines()
        shown = " ".join(" ".join(map(str, (Path(command[0]).name, *command[1:]))).split())
        raise Failed(f"`{shown if len(shown) <= 80 else shown[:79] + '…'}` failed: {lines[-1].strip()}")
    return result.stdout


# --- the virtual environment and the package --------------------------------------------------------------------------


def make_venv() -> None:
    here = f"{sys.version_info.major}.{sys.version_info.minor}"
    if PYTHON.exists():
        probe = "import pip, sys; print('%d.%d' % sys.version_info[:2])"
        result = subprocess.run([PYTHON, "-c", probe], capture_output=True, text=True, check=False)
        if result.returncode == 0 and (result.stdout.strip() == here or not os.environ.get("PYTHON")):
            return
        say(f"replacing .venv, which is broken or of another Python than {here}")
    try:
        import ensurepip  # noqa: F401  (Debian ships it, and a working venv with it, in a package of its own)
        import venv  # noqa: F401
    except ImportError:
        raise Failed(
            f"this Python ({sys.executable}) cannot make virtual environments; on Debian or Ubuntu: "
            f"sudo apt install python3-venv (or python{here}-venv)"
        ) from None
    say(f"creating .venv with Python {here}")
    shutil.rmtree(VENV, ignore_errors=True)
    quiet(sys.executable, "-m", "venv", VENV)


def install_package(dev: bool) -> None:
    """Install the checkout editable, with the developers' tools if asked; again only if pyproject.toml changed."""
    stamp = VENV / "pylmc-setup.json"
    wanted = {"pyproject": hashlib.sha256((ROOT / "pyproject.toml").read_bytes()).hexdigest(), "root": str(ROOT)}
    try:
        done = json.loads(stamp.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        done = {}
    dev = dev or bool(done.get("dev"))
    if done == {**wanted, "dev": dev}:
        return
    target = f"{ROOT}[dev]" if dev else str(ROOT)
    say(f"installing pylmc and what it needs{' and its development tools' if dev else ''} into .venv (1 to 2 minutes)")
    quiet(PYTHON, "-m", "pip", "install", "-q", "--disable-pip-version-check", "-e", target)
    stamp.write_text(json.dumps({**wanted, "dev": dev}), encoding="utf-8")


# --- OpenCL -----------------------------------------------------------------------------------------------------------


def works() -> bool:
    """Whether some device builds and runs a kernel; says which, or what is wrong with those that are there."""
    code = (
        "from pylmc.device import survey; survey.refresh()\n"
        "for d in survey.usable(): print('OpenCL works:', d.label)\n"
        "for r in survey.rejected(): print(f'{r.label} does not work: {r.reason}')"
    )
    lines = quiet(PYTHON, "-c", code).splitlines()
    for line in lines:
        say(line)
    return any(line.startswith("OpenCL works: ") for line in lines)


def apt_install() -> None:
    if not shutil.which("apt-get"):
        raise Failed("this system has no apt-get")
    prefix: list[str] = []
    if os.geteuid() != 0:
        if not shutil.which("sudo"):
            raise Failed("not root, and there is no sudo")
        try:
            quiet("sudo", "-n", "true")
        except Failed:
            raise Failed("not root, and sudo asks for a password") from None
        prefix = ["sudo", "-n"]
    say(f"installing Debian's {PACKAGE} (apt-get install)")
    install = [
        *prefix,
        "env",
        "DEBIAN_FRONTEND=noninteractive",
        "apt-get",
        "install",
        "-y",
        "-q",
        "--no-install-recommends",
        PACKAGE,
    ]
    try:
        quiet(*install)
    except Failed:
        say("updating apt's package lists and trying again (apt-get update)")
        quiet(*prefix, "apt-get", "update", "-q")
        quiet(*install)


def unpack() -> None:
    """Fetch the Debian packages that are not installed here and unpack them into .opencl/root; needs no rights."""
    for tool in ("apt-get", "dpkg"):
        if not shutil.which(tool):
            raise Failed(f"this system has no {tool}")
    root, packages = OPENCL / "root", OPENCL / "packages"
    for folder in (root, packages):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
    say(f"fetching {PACKAGE} and what it needs, to be unpacked in .opencl (no root needed)")
    lists: list[str] = []
    try:
        fetch(lists, packages)
    except Failed:
        say("updating package lists of our own and trying again (apt-get update into .opencl)")
        (OPENCL / "lists" / "partial").mkdir(parents=True, exist_ok=True)
        lists = ["-o", f"Dir::State::Lists={OPENCL / 'lists'}"]
        quiet("apt-get", *private_apt(lists), "update", "-q")
        fetch(lists, packages)
    files = sorted(packages.glob("*.deb"))
    say(f"unpacking {len(files)} packages")
    for file in files:
        quiet("dpkg", "-x", file, root)
    for folder in (packages, OPENCL / "lists", OPENCL / "cache"):
        shutil.rmtree(folder, ignore_errors=True)
    describe(root)


def fetch(lists: list[str], packages: Path) -> None:
    """Download PoCL and those of its dependencies that are not installed; ``lists`` are apt's options for its lists."""
    plan = quiet("apt-get", *private_apt(lists), "-s", "--no-install-recommends", "install", PACKAGE)
    # "Inst name (version …" is new; with "[version]" before it, the package is there and would merely be updated.
    names = re.findall(r"^Inst (\S+) \(", plan, flags=re.MULTILINE)
    if not names:
        raise Failed(f"{PACKAGE} is installed already, but does not work")
    quiet("apt-get", *private_apt(lists), "-q", "download", *names, folder=packages)


def private_apt(lists: list[str]) -> list[str]:
    """Options that keep apt from writing outside the checkout and from changing its user (both need root)."""
    return [*lists, "-o", f"Dir::Cache={OPENCL / 'cache'}", "-o", "APT::Sandbox::User="]


def describe(root: Path) -> None:
    """Write .opencl/implementation.json, from which pylmc.device.survey knows what to load, in an order that works."""
    library = next(iter(sorted(root.glob("usr/lib/*/libpocl.so.2"))), None)
    if library is None:
        raise Failed("the unpacked packages hold no libpocl.so.2")
    folders = [library.parent, *root.glob("lib/*-linux-gnu*"), *root.glob("usr/lib/llvm-*/lib")]
    path = ":".join(map(str, [*folders, library.parent / "pocl"]))
    plugins = [str(plugin) for plugin in library.parent.glob("pocl/*.so")]
    code = (
        "import ctypes, sys\n"
        "for name in sys.argv[1:]: ctypes.CDLL(name)\n"
        "print(*sorted({line.split()[-1] for line in open('/proc/self/maps') if '.so' in line}), sep='\\n')"
    )
    mapped = quiet(sys.executable, "-c", code, library, *plugins, environ={"LD_LIBRARY_PATH": path}).splitlines()
    ours = [name for name in mapped if Path(name).is_relative_to(root) and not Path(name).samefile(library)]
    ours = [name for name in ours if name not in plugins]
    description: dict[str, str | list[str]] = {
        "library": str(library.relative_to(OPENCL)),
        "preload": [str(Path(name).relative_to(OPENCL)) for name in loading_order(ours)],
    }
    if (root / "usr" / "bin" / "ld").exists():  # else the system has one
        wrap_linker(root, folders)
        description["path"] = "bin"
    (OPENCL / "implementation.json").write_text(json.dumps(description, indent=1) + "\n", encoding="utf-8")


def loading_order(libraries: list[str]) -> list[str]:
    """The libraries sorted so that each comes after those it needs: a loaded one serves whoever asks for its name."""
    order: list[str] = []
    remaining = list(libraries)
    while remaining:
        loaded = []
        for name in remaining:
            try:
                ctypes.CDLL(name)
            except OSError as error:
                problem = error
            else:
                loaded.append(name)
        if not loaded:
            raise Failed(f"the unpacked libraries cannot be loaded: {problem}")
        order += loaded
        remaining = [name for name in remaining if name not in loaded]
    return order


def wrap_linker(root: Path, folders: list[Path]) -> None:
    """Write .opencl/bin/ld, which runs the unpacked linker with its libraries: PoCL looks for ``ld`` in the PATH.

    What it links kernels against is found in .opencl/lib: the unpacked libc.so is a text that names files under /usr,
    which are not there, so links to the system's own libraries stand for it.
    """
    programs, libraries = OPENCL / "bin", OPENCL / "lib"
    for folder in (programs, libraries):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
    for short, name in (("libc.so", "libc.so.6"), ("libm.so", "libm.so.6"), ("libgcc_s.so", "libgcc_s.so.1")):
        for place in (Path("/usr/lib", folders[0].name, name), Path("/lib", folders[0].name, name)):
            if place.is_file():
                (libraries / short).symlink_to(place)
                break
    for file in root.glob("usr/lib/gcc/*/*/libgcc.a"):
        (libraries / "libgcc.a").symlink_to(os.path.relpath(file, libraries))
    path = ":".join(f"$here/{os.path.relpath(folder, programs)}" for folder in folders)
    linker = os.path.relpath(root / "usr" / "bin" / "ld", programs)
    (programs / "ld").write_text(
        f'#!/bin/sh\nhere=${{0%/*}}\nLD_LIBRARY_PATH="{path}" exec "$here/{linker}" "$@" -L"$here/../lib"\n',
        encoding="utf-8",
    )
    (programs / "ld").chmod(0o755)


def pip_intel() -> None:
    say("installing Intel's OpenCL runtime from PyPI into .venv (proprietary, CPU only)")
    quiet(PYTHON, "-m", "pip", "install", "-q", "--disable-pip-version-check", *INTEL)


def ensure_opencl() -> None:
    """Find or install an OpenCL implementation on which a kernel builds and runs; raises Failed if nothing helps."""
    say("looking for an OpenCL device that builds and runs a kernel")
    if works():
        return
    ways: dict[str, Callable[[], None]] = {"apt": apt_install, "unpack": unpack, "intel": pip_intel}
    only = os.environ.get("PYLMC_SETUP_OPENCL", "")
    if only and only not in (*ways, "none"):
        raise Failed(f"PYLMC_SETUP_OPENCL={only}: use apt, unpack, intel or none")
    for name, install in ways.items():
        if only and name != only:
            continue
        try:
            install()
            if works():
                return
        except (Failed, OSError) as problem:
            say(f"{name}: {problem}")
    raise Failed(
        "no OpenCL device works, and none could be set up. Ask an administrator to install one (Debian or Ubuntu: "
        f"`sudo apt install {PACKAGE}`, or your GPU's driver), then run this again. "
        f"`.venv/bin/pylmc devices` shows what is there; details are in {LOG.relative_to(ROOT)}"
    )


def main() -> int:
    parser = argparse.ArgumentParser(description="Set up .venv, pylmc in it, and an OpenCL device that works.")
    parser.add_argument("--dev", action="store_true", help="with the tools that tests and lint need")
    arguments = parser.parse_args()
    try:
        make_venv()
        install_package(arguments.dev)
        ensure_opencl()
    except (Failed, OSError) as problem:
        print(f"setup: error: {problem}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
