"""Which OpenCL devices work, and which one to use.

A listed device proves nothing: each implementation is tried in a process of its own, where a kernel is built and run on
every device, so that a driver that crashes or hangs harms nobody. What was found is remembered in the user's cache
folder, for as long as the driver stays the same.

Besides the system's implementations (/etc/OpenCL/vendors) this finds PoCL where `make render` unpacked it without root
(the checkout's ``.opencl``, or the folder that PYLMC_OPENCL names), Intel's from PyPI in the running Python's prefix,
and NVIDIA's driver where it came without an .icd file. If OCL_ICD_VENDORS is set, it alone counts.
"""

from __future__ import annotations

import contextlib
import ctypes
import functools
import hashlib
import json
import os
import platform
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import caches
from ..errors import PylmcError, PylmcWarning
from . import forks
from .implementations import Implementation, implementations, path_with, resolve

if TYPE_CHECKING:
    import pyopencl

__all__ = ["DeviceInfo", "Rejected", "context_and_queue", "describes", "refresh", "rejected", "select", "usable"]

PROBE_TIMEOUT = 60.0  # seconds that an implementation gets to list its devices and run a kernel on one
GOOD_FOR = 7 * 86400.0  # seconds that a remembered success is believed while the driver looks the same
BAD_FOR = 3600.0  # the same for a failure; shorter, since its cause may lie outside the driver (a missing linker)

REMEDY = (
    "on Debian or Ubuntu run `sudo apt install pocl-opencl-icd`; without root, on x86-64, "
    "`pip install intel-opencl-rt intel-cmplr-lib-rt`"
)


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


@dataclass(frozen=True)
class _Survey:
    """Everything known about the machine's OpenCL. ``loadable``: implementations that survive being opened."""

    usable: tuple[DeviceInfo, ...]
    rejected: tuple[Rejected, ...]
    loadable: tuple[Implementation, ...]


def usable() -> list[DeviceInfo]:
    """The devices that work, best first: GPUs, then CPUs (PoCL before others, Intel's proprietary one after it)."""
    return list(_survey().usable)


def rejected() -> list[Rejected]:
    """What was listed or installed but does not work, each with its reason."""
    return list(_survey().rejected)


def refresh() -> None:
    """Forget what was remembered, on disk too, and try every device again (in new processes)."""
    with contextlib.suppress(OSError):
        _cache_file().unlink()
    _survey.cache_clear()


def select(spec: str | int | None = None) -> pyopencl.Device:
    """The device that ``spec`` asks for, ready for use in this process.

    ``spec`` is ``cpu``, ``gpu``, an index into ``usable()``, or part of a device's or platform's name (any case).
    ``None`` takes PYOPENCL_CTX if that is set, else the first of ``usable()``. Raises PylmcError if there is no such
    device, naming what there is, and in a process forked from one that used OpenCL.
    """
    if spec is not None and not isinstance(spec, str | int):
        raise PylmcError(f"device={spec!r}: give 'cpu', 'gpu', an index, part of a name, or a pyopencl.Device")
    devices = usable()
    if not devices:
        reasons = "".join(f" ({item.label}: {item.reason})" for item in rejected()[:1])
        raise PylmcError(f"no OpenCL device works here{reasons}; {REMEDY}; `pylmc devices` shows what was tried")
    if spec is None and os.environ.get("PYOPENCL_CTX"):
        return _from_pyopencl_ctx(devices)
    return _open(devices[0] if spec is None else _match(str(spec), devices))


def context_and_queue(device: pyopencl.Device) -> tuple[pyopencl.Context, pyopencl.CommandQueue]:
    """A context that holds ``device`` alone, and an in-order queue on it. Raises PylmcError in a forked process."""
    import pyopencl as cl

    forks.opening()
    context = cl.Context([device])
    return context, cl.CommandQueue(context)


# --- choosing ---------------------------------------------------------------------------------------------------------


def _match(spec: str, devices: list[DeviceInfo]) -> DeviceInfo:
    wanted = spec.strip().lower()
    there = ", ".join(f"{index} = {device.label}" for index, device in enumerate(devices))
    if wanted.isdecimal():
        if int(wanted) < len(devices):
            return devices[int(wanted)]
    elif wanted in ("cpu", "gpu"):
        for device in devices:
            if device.kind == wanted:
                return device
    elif wanted:
        for device in devices:
            if wanted in device.label.lower():
                return device
    for item in rejected():
        if wanted and wanted in item.label.lower():
            raise PylmcError(f"device '{spec}' does not work: {item.label}: {item.reason}; usable: {there}")
    raise PylmcError(f"no device '{spec}'; usable: {there}; `pylmc devices` shows them all")


def _from_pyopencl_ctx(devices: list[DeviceInfo]) -> pyopencl.Device:
    import pyopencl as cl

    _open(devices[0])  # so that the loader knows every implementation before pyopencl lists them
    choice = os.environ["PYOPENCL_CTX"]
    try:
        device = cl.choose_devices(interactive=False)[0]
    except (RuntimeError, ValueError, IndexError, cl.Error) as error:
        raise PylmcError(
            f"PYOPENCL_CTX='{choice}' names no device ({_one_line(str(error))}); unset it or see `pylmc devices`"
        ) from None
    if not any(describes(info, device) for info in devices):
        raise PylmcError(
            f"PYOPENCL_CTX='{choice}' chooses {device.platform.name.strip()}: {device.name.strip()}, "
            "which does not work; unset it, and see `pylmc devices` for the reason"
        )
    return device


def describes(info: DeviceInfo, device: pyopencl.Device) -> bool:
    """Whether ``info`` is about ``device``, by the names and version that OpenCL gives."""
    return (device.name.strip(), device.platform.name.strip(), device.platform.version.strip()) == (
        info.name,
        info.platform,
        info.platform_version,
    )


def _open(info: DeviceInfo) -> pyopencl.Device:
    """The device in this process that ``info`` describes."""
    import pyopencl as cl

    forks.opening()
    _load_implementations()
    for opened in cl.get_platforms():
        with contextlib.suppress(cl.Error):  # a platform without devices
            devices = opened.get_devices()
            if info.position < len(devices) and describes(info, devices[info.position]):
                return devices[info.position]
    raise PylmcError(
        f"{info.label} works in a process of its own but cannot be seen from this one; if other code used "
        "OpenCL first, call pylmc.device.survey.select() before it, else run `pylmc devices`"
    )


@functools.cache
def _load_implementations() -> None:
    """Have the ICD loader open the implementations that survived their test; it does so only once per process."""
    import pyopencl as cl

    if caches.complaint():
        warnings.warn(caches.complaint(), PylmcWarning, stacklevel=2)
    chosen = [implementation for implementation in _survey().loadable if implementation.library]
    if not chosen:
        return
    for implementation in chosen:
        os.environ["PATH"] = path_with(implementation)
        for library in implementation.preload:
            ctypes.CDLL(library)
    before = os.environ.get("OCL_ICD_VENDORS")
    with tempfile.TemporaryDirectory(prefix="pylmc-") as folder:
        for index, implementation in enumerate(chosen):
            Path(folder, f"{index:02}.icd").write_bytes(os.fsencode(implementation.library) + b"\n")
        os.environ["OCL_ICD_VENDORS"] = folder
        try:
            with contextlib.suppress(cl.Error):
                cl.get_platforms()
        finally:  # child processes must see the user's own setting, not ours
            if before is None:
                del os.environ["OCL_ICD_VENDORS"]
            else:
                os.environ["OCL_ICD_VENDORS"] = before


# --- trying them ------------------------------------------------------------------------------------------------------


@functools.cache
def _survey() -> _Survey:
    remembered = _read_cache()
    cache: dict[str, Any] = {}
    devices: list[DeviceInfo] = []
    failures: list[Rejected] = []
    loadable: list[Implementation] = []
    for implementation in implementations():
        key = _fingerprint(implementation)
        result = remembered.get(key)
        if result is None:
            result = {"time": time.time(), **_try(implementation)}
        cache[key] = result
        devices += [DeviceInfo(**device) for device in result["usable"]]
        failures += [Rejected(**failure) for failure in result["rejected"]]
        if result["usable"]:
            loadable.append(implementation)
    # Other virtual environments and settings share the file, so their results are kept.
    _write_cache({**remembered, **cache})
    return _Survey(tuple(sorted(devices, key=_merit)), tuple(failures), tuple(loadable))


def _merit(device: DeviceInfo) -> tuple[int, int]:
    """Sort key, best first; Python's sort keeps the order of equals."""
    maker = device.platform.lower()
    kind = {"gpu": 0, "cpu": 1}.get(device.kind, 2)
    return kind, 0 if kind == 0 or "portable computing language" in maker else 1 if "intel" in maker else 2


def _try(implementation: Implementation) -> dict[str, list[dict[str, Any]]]:
    """List the implementation's devices and run a kernel on each, in as many processes as it brings down."""
    good: list[dict[str, Any]] = []
    bad: list[dict[str, Any]] = []
    first, listed = 0, 1
    while first < listed:
        events, failure = _run_probe(implementation, first)
        listed = next((event["listed"] for event in events if "listed" in event), 0)
        device: dict[str, Any] | None = None
        for event in events:
            if "device" in event:
                device = event["device"]
                first += 1
            elif device is not None and "ok" in event:
                good.append(device)
                device = None
            elif device is not None and "error" in event:
                bad.append({"label": f"{device['platform']}: {device['name']}", "reason": _one_line(event["error"])})
                device = None
        if device is not None:  # the process ended while this device was tried
            bad.append({"label": f"{device['platform']}: {device['name']}", "reason": failure or "it ended silently"})
        elif failure:
            bad.append({"label": implementation.label, "reason": failure})
            break
        elif listed == 0:
            names = [name for event in events for name in event.get("platforms", [])]
            reason = f"{', '.join(names)} lists no device" if names else _why_not_opened(implementation)
            bad.append({"label": implementation.label, "reason": reason})
    return {"usable": good, "rejected": bad}


def _why_not_opened(implementation: Implementation) -> str:
    library = implementation.library
    if implementation.label.endswith(".icd") and not library:
        return "the .icd file is empty or cannot be read; it should name a library"
    if "/" in library and not Path(library).exists():
        return f"{library} does not exist"
    return f"the OpenCL loader could not open {library or 'any implementation'}"


def _run_probe(implementation: Implementation, first: int) -> tuple[list[dict[str, Any]], str | None]:
    """What the probe printed, and how its process failed (None if it ended well)."""
    # A kernel out of a cache would prove nothing about the compiler.
    environ = {**os.environ, "PATH": path_with(implementation), "POCL_KERNEL_CACHE": "0", "PYOPENCL_NO_CACHE": "1"}
    command = [sys.executable, "-P", str(Path(__file__).with_name("probe.py")), str(first), *implementation.preload]
    # Files, not pipes: a driver's helper that outlives the probe would keep a pipe open.
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err, tempfile.TemporaryDirectory() as vendors:
        if implementation.library:
            Path(vendors, "probed.icd").write_bytes(os.fsencode(implementation.library) + b"\n")
            environ["OCL_ICD_VENDORS"] = vendors
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=out, stderr=err, env=environ, start_new_session=True
        )
        failure = None
        try:
            status = process.wait(PROBE_TIMEOUT)
        except subprocess.TimeoutExpired:
            failure = f"it did not answer within {PROBE_TIMEOUT:g} s"
        else:
            if status < 0:
                failure = f"it crashed ({signal.Signals(-status).name}) while a test kernel was built or run"
            elif status > 0:
                failure = f"its test ended with exit code {status}"
        finally:
            _end(process)
        out.seek(0)
        err.seek(0)
        events = _events(out.read().decode(errors="replace"))
        complaints = err.read().decode(errors="replace").strip().splitlines()
    if failure and complaints:
        failure += f": {_one_line(complaints[-1])}"
    return events, failure


def _end(process: subprocess.Popen[bytes]) -> None:
    """End the probe and what it started, if it still runs."""
    if process.poll() is None:
        if hasattr(os, "killpg"):
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
        else:
            process.kill()
        with contextlib.suppress(subprocess.TimeoutExpired):  # a process stuck in a kernel driver cannot be ended
            process.wait(5)


def _events(text: str) -> list[dict[str, Any]]:
    events = []
    for line in text.splitlines():
        with contextlib.suppress(ValueError):  # drivers print to stdout, too
            event = json.loads(line)
            if isinstance(event, dict):
                events.append(event)
    return events


def _one_line(text: str, limit: int = 240) -> str:
    line = " ".join(text.split())
    return line if len(line) <= limit else line[: limit - 1] + "…"


# --- remembering ------------------------------------------------------------------------------------------------------


def _cache_file() -> Path:
    home = os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser()
    return Path(home, "pylmc", "devices.json")


def _fingerprint(implementation: Implementation) -> str:
    """Changes whenever the driver, the machine, or a setting that drivers look at does."""
    facts: list[Any] = [asdict(implementation), version("pyopencl"), platform.node(), platform.release()]
    facts.append(Path(__file__).with_name("probe.py").read_text(encoding="utf-8"))
    for file in (resolve(implementation.library), *implementation.preload):
        with contextlib.suppress(OSError):
            state = os.stat(file)
            facts.append((os.path.realpath(file), state.st_size, state.st_mtime_ns))
    with contextlib.suppress(OSError):  # the kernel's side of NVIDIA's driver
        facts.append(Path("/proc/driver/nvidia/version").read_text(encoding="utf-8", errors="replace"))
    prefixes = ("POCL_", "OCL_", "CL_", "RUSTICL_", "CUDA_", "NVIDIA_", "HIP_", "ROCR_", "LD_LIBRARY_PATH", "PATH")
    looked_at = {name: value for name, value in os.environ.items() if name.startswith(prefixes)}
    looked_at.pop("POCL_CACHE_DIR", None)  # always one that can be written: see pylmc.caches
    facts.append(sorted(looked_at.items()))
    return hashlib.sha256(json.dumps(facts).encode()).hexdigest()


def _read_cache() -> dict[str, Any]:
    """Results that are still to be believed, by fingerprint."""
    try:
        content = json.loads(_cache_file().read_text(encoding="utf-8"))
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


def _write_cache(content: dict[str, Any]) -> None:
    file = _cache_file()
    with contextlib.suppress(OSError):  # a cache that cannot be written only costs a second at the next start
        file.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile("w", encoding="utf-8", dir=file.parent, delete=False) as temporary:
            json.dump(content, temporary)
        os.replace(temporary.name, file)
