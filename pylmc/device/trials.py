"""Trying OpenCL implementations, each in processes of its own, so that a driver that crashes or hangs harms nobody."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from .implementations import Implementation, path_with

PROBE_TIMEOUT = 60.0  # seconds that an implementation gets to list its devices and run a kernel on one


def tried(implementation: Implementation) -> dict[str, list[dict[str, Any]]]:
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
                bad.append({"label": f"{device['platform']}: {device['name']}", "reason": one_line(event["error"])})
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
        failure += f": {one_line(complaints[-1])}"
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


def one_line(text: str, limit: int = 240) -> str:
    """A driver's words on one line, cut off where they are many."""
    line = " ".join(text.split())
    return line if len(line) <= limit else line[: limit - 1] + "…"
