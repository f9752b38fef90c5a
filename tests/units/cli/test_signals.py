"""Ctrl-C, SIGTERM and SIGHUP end a command early, and a render keeps its picture."""

import contextlib
import ctypes
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import pylmc
from pylmc.cli.signals import Signals
from pylmc.device.handlers import TAKEN
from pylmc.interruption import SAME, gently
from pylmc.picture.image import read_exr

RENDER = ["render", "box", "--size", "16x16", "--max-depth", "2", "-o", "box.exr"]
Process = subprocess.Popen[bytes]


def start(arguments: list[str], folder: Path, ready: Callable[[], object] | None = None) -> Process:
    """`pylmc ARGUMENTS` in ``folder``; ``ready`` is called in it before it begins."""
    command = [sys.executable, "-u", "-m", "pylmc", *arguments]
    environ = {**os.environ, "PYTHONPATH": str(Path(pylmc.__file__).parents[1])}
    return subprocess.Popen(
        command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, cwd=folder, env=environ, preexec_fn=ready
    )


def wait_for(words: str, process: Process) -> str:
    """What stderr says until ``words`` have come."""
    said = b""
    while words.encode() not in said:
        more = process.stderr.read1(4096)  # type: ignore[union-attr]
        assert more, f"ended before it said '{words}': {said.decode()}"
        said += more
    return said.decode()


def end(process: Process) -> tuple[int, str]:
    """Its exit code and what else it says."""
    _, said = process.communicate(timeout=60)
    return process.returncode, said.decode()


@pytest.mark.parametrize(
    ("name", "code", "integrator"),
    [("SIGINT", 130, "lmc"), ("SIGTERM", 143, "lmc"), ("SIGHUP", 129, "bdpt"), ("SIGTERM", 143, "path")],
)
def test_a_render_that_is_ended_keeps_its_picture(name: str, code: int, integrator: str, tmp_path: Path) -> None:
    process = start([*RENDER, "--seconds", "100", "--integrator", integrator], tmp_path)
    wait_for("/s=", process)
    for _ in range(2):  # as `timeout` sends it, and a terminal that is closed
        process.send_signal(getattr(signal, name))
    status, said = end(process)
    assert status == code and said.splitlines()[-1].startswith("pylmc: interrupted by "), said
    assert ("Ctrl-C" if name == "SIGINT" else name) in said and "picture so far was written" in said
    assert json.loads((tmp_path / "box.json").read_text(encoding="utf-8"))["interrupted"] is True
    assert read_exr(tmp_path / "box.exr")[0].sum() > 0 and (tmp_path / "box.png").exists()


def test_a_render_under_nohup_goes_on(tmp_path: Path) -> None:
    process = start([*RENDER, "--seconds", "2"], tmp_path, lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
    wait_for("/s=", process)
    process.send_signal(signal.SIGHUP)
    status, said = end(process)
    assert status == 0 and "interrupted" not in said


def test_a_signal_before_the_first_sample_writes_nothing(tmp_path: Path) -> None:
    """At any moment before it, the first second's imports included."""
    (tmp_path / "box.exr").write_text("earlier", encoding="utf-8")
    for number, wait in ((signal.SIGINT, 0.25), (signal.SIGTERM, 0.5)):
        process = start([*RENDER, "--seconds", "100"], tmp_path)
        time.sleep(wait)
        process.send_signal(number)
        status, said = end(process)
        assert status in (128 + number, -number), said  # the latter before pylmc has the word
        if status > 0 and "so far" not in said:
            assert "nothing was written" in said and said.count("\n") == 1
            assert (tmp_path / "box.exr").read_text(encoding="utf-8") == "earlier"


def test_a_compiler_does_not_take_the_signals() -> None:
    """LLVM's handlers in PoCL serve once; what is in force is asked of the C library."""
    library = ctypes.CDLL(None)

    def in_force() -> list[bytes]:
        actions = [ctypes.create_string_buffer(256) for _ in TAKEN]
        for number, action in zip(TAKEN, actions, strict=True):
            library.sigaction(number, None, action)
        return [action.raw[: ctypes.sizeof(ctypes.c_void_p)] for action in actions]

    with Signals():
        before = in_force()
        pylmc.Sampler(pylmc.load("box").with_size(8, 8), max_depth=2, chains=64, candidates=256).init(seed=1)
        assert in_force() == before


def raised(number: int) -> bool:
    """Whether the signal raises KeyboardInterrupt."""
    with contextlib.suppress(KeyboardInterrupt):
        signal.raise_signal(number)
        return False
    return True


def test_gently_notes_the_first_and_raises_the_second() -> None:
    before = signal.getsignal(signal.SIGINT)
    with gently() as asked, gently() as within:
        assert within is asked and not asked.is_set()
        assert not raised(signal.SIGINT) and asked.is_set()
        assert not raised(signal.SIGINT), "one of the same moment is the first once more"
        time.sleep(SAME)
        assert raised(signal.SIGINT)
    assert signal.getsignal(signal.SIGINT) is before


def test_signals_do_as_ctrl_c_does() -> None:
    before = signal.getsignal(signal.SIGTERM)
    with Signals() as signals:
        assert (signals.name, signals.code) == ("Ctrl-C", 130)
        with gently() as asked:
            assert not raised(signal.SIGTERM) and asked.is_set()
            assert (signals.name, signals.code) == ("SIGTERM", 143)
            time.sleep(SAME)
            assert not raised(signal.SIGHUP), "only the first counts"
            assert signals.name == "SIGTERM"
    with Signals() as signals:
        assert raised(signal.SIGHUP) and not raised(signal.SIGHUP) and signals.code == 129
    assert signal.getsignal(signal.SIGTERM) is before


def test_another_thread_has_no_signals() -> None:
    seen = []

    def run() -> None:
        with Signals(), gently() as asked:
            seen.append(asked.is_set())

    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    assert seen == [False]
