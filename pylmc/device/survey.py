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
import os
import tempfile
import time
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import caches
from ..errors import PylmcError, PylmcWarning
from . import findings, forks, trials
from .findings import DeviceInfo, Rejected
from .implementations import Implementation, implementations, path_with
from .trials import one_line

if TYPE_CHECKING:
    import pyopencl

__all__ = ["DeviceInfo", "Rejected", "context_and_queue", "describes", "refresh", "rejected", "select", "usable"]

REMEDY = (
    "on Debian or Ubuntu run `sudo apt install pocl-opencl-icd`; without root, on x86-64, "
    "`pip install intel-opencl-rt intel-cmplr-lib-rt`"
)


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
        findings.file().unlink()
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
            f"PYOPENCL_CTX='{choice}' names no device ({one_line(str(error))}); unset it or see `pylmc devices`"
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


# --- the survey -------------------------------------------------------------------------------------------------------


@functools.cache
def _survey() -> _Survey:
    remembered = findings.read()
    cache: dict[str, Any] = {}
    devices: list[DeviceInfo] = []
    failures: list[Rejected] = []
    loadable: list[Implementation] = []
    for implementation in implementations():
        key = findings.fingerprint(implementation)
        result = remembered.get(key)
        if result is None:
            result = {"time": time.time(), **trials.tried(implementation)}
        cache[key] = result
        devices += [DeviceInfo(**device) for device in result["usable"]]
        failures += [Rejected(**failure) for failure in result["rejected"]]
        if result["usable"]:
            loadable.append(implementation)
    # Other virtual environments and settings share the file, so their results are kept.
    findings.write({**remembered, **cache})
    return _Survey(tuple(sorted(devices, key=_merit)), tuple(failures), tuple(loadable))


def _merit(device: DeviceInfo) -> tuple[int, int]:
    """Sort key, best first; Python's sort keeps the order of equals."""
    maker = device.platform.lower()
    kind = {"gpu": 0, "cpu": 1}.get(device.kind, 2)
    return kind, 0 if kind == 0 or "portable computing language" in maker else 1 if "intel" in maker else 2
