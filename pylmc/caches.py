"""Where drivers keep compiled kernels: folders that cannot be written are replaced by one of this process alone.

Without a cache's folder pyopencl cannot be imported, and PoCL lists no device. That happens where the home folder is
none, as in a container with a user of its own.
"""

from __future__ import annotations

import contextlib
import os

USERS = ("pytools", "pyopencl", "pocl/kcache")  # subfolders of ~/.cache that are used here


def mend() -> None:
    """Have XDG_CACHE_HOME and POCL_CACHE_DIR name folders that can be written. To be called before pyopencl is imported."""
    if os.name != "posix":
        return
    base = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    below = [path for path in (f"{base}/{name}" for name in USERS) if os.path.exists(path)]
    if not all(map(_writable, (base, *below))):
        _replace("XDG_CACHE_HOME", base)
    chosen = os.environ.get("POCL_CACHE_DIR")
    if chosen and not _writable(chosen):
        _replace("POCL_CACHE_DIR", chosen)


def complaint() -> str:
    """A sentence on the folders that were replaced; empty if there are none."""
    if not _replaced:
        return ""
    return (
        f"every start compiles all kernels: {' and '.join(_replaced.values())} cannot be written; "
        f"set {' and '.join(_replaced)} to a folder that can"
    )


_replaced: dict[str, str] = {}  # by the variable that names another one now


def _writable(folder: str) -> bool:
    with contextlib.suppress(OSError):
        os.makedirs(folder, exist_ok=True)
        return os.access(folder, os.W_OK | os.X_OK)
    return False


def _replace(variable: str, folder: str) -> None:
    import atexit
    import shutil
    import tempfile

    with contextlib.suppress(OSError):  # with no place for temporary files either, the driver may complain
        os.environ[variable] = tempfile.mkdtemp(prefix="pylmc-cache-")
        atexit.register(shutil.rmtree, os.environ[variable], ignore_errors=True)
        _replaced[variable] = folder
