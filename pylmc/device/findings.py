"""What trying OpenCL implementations has found, and how it is remembered in the user's cache folder."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import platform
import tempfile
import time
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from .implementations import Implementation, resolve

GOOD_FOR = 7 * 86400.0  # seconds that a remembered success is believed while the driver looks the same
BAD_FOR = 3600.0  # the same for a failure; shorter, since its cause may lie outside the driver (a missing linker)


@dataclass(frozen=True)
class DeviceInfo:
    """One device on which a kernel was built and run. ``memory`` is in bytes."""

    name: str
    kind: str  # "cpu", "gpu" or "other"
    platform: str
    platform_version: str
    driver: str
    position: int  # among the platform's devices
    compute_units: int
    memory: int
    fp64: bool
    int64_atomics: bool

    @property
    def label(self) -> str:
        """What a person calls it: platform and device name; a part of this is a valid SPEC."""
        return f"{self.platform}: {self.name}"


@dataclass(frozen=True)
class Rejected:
    """A device, or a whole implementation, that does not work, and why."""

    label: str
    reason: str


def file() -> Path:
    """Where results are kept."""
    home = os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser()
    return Path(home, "pylmc", "devices.json")


def fingerprint(implementation: Implementation) -> str:
    """Changes whenever the driver, the machine, or a setting that drivers look at does."""
    facts: list[Any] = [asdict(implementation), version("pyopencl"), platform.node(), platform.release()]
    facts.append(Path(__file__).with_name("probe.py").read_text(encoding="utf-8"))
    for library in (resolve(implementation.library), *implementation.preload):
        with contextlib.suppress(OSError):
            state = os.stat(library)
            facts.append((os.path.realpath(library), state.st_size, state.st_mtime_ns))
    with contextlib.suppress(OSError):  # the kernel's side of NVIDIA's driver
        facts.append(Path("/proc/driver/nvidia/version").read_text(encoding="utf-8", errors="replace"))
    prefixes = ("POCL_", "OCL_", "CL_", "RUSTICL_", "CUDA_", "NVIDIA_", "HIP_", "ROCR_", "LD_LIBRARY_PATH", "PATH")
    looked_at = {name: value for name, value in os.environ.items() if name.startswith(prefixes)}
    looked_at.pop("POCL_CACHE_DIR", None)  # always one that can be written: see pylmc.caches
    facts.append(sorted(looked_at.items()))
    return hashlib.sha256(json.dumps(facts).encode()).hexdigest()


def read() -> dict[str, Any]:
    """Results that are still to be believed, by fingerprint."""
    try:
        content = json.loads(file().read_text(encoding="utf-8"))
        now = time.time()
        fresh = {}
        for key, result in content.items():
            for device in result["usable"]:
                DeviceInfo(**device)
            for failure in result["rejected"]:
                Rejected(**failure)
            if 0 <= now - result["time"] < (BAD_FOR if result["rejected"] else GOOD_FOR):
                fresh[key] = result
        return fresh
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return {}


def write(content: dict[str, Any]) -> None:
    """Keep results, by fingerprint."""
    place = file()
    with contextlib.suppress(OSError):  # a cache that cannot be written only costs a second at the next start
        place.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile("w", encoding="utf-8", dir=place.parent, delete=False) as temporary:
            json.dump(content, temporary)
        os.replace(temporary.name, place)
