"""Progress: a bar on a terminal, a line now and then elsewhere, and never a reason to fail."""

import io
import sys

import pytest

from pylmc import progress
from pylmc.progress import Progress


class Clock:
    """Time that passes when told to."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(progress.time, "perf_counter", made)
    return made


def test_a_file_gets_a_line_now_and_then(clock: Clock, monkeypatch: pytest.MonkeyPatch) -> None:
    out = io.StringIO()
    monkeypatch.setattr(sys, "stderr", out)
    shown = Progress(3600, True)
    for _ in range(36_000):
        clock.now += 0.1
        shown.show(clock.now - 100, {"mutations/s": "1e6", "acceptance": "0.5"})
    shown.close()
    lines = out.getvalue().splitlines()
    assert lines[0] == "rendering   0%, time left 59:58, mutations/s=1e6, acceptance=0.5"
    assert 10 < len(lines) < 100 and "\r" not in out.getvalue()


def test_a_terminal_gets_a_bar(monkeypatch: pytest.MonkeyPatch) -> None:
    out = io.StringIO()
    out.isatty = lambda: True  # type: ignore[method-assign]
    monkeypatch.setattr(sys, "stderr", out)
    shown = Progress(10, True)
    shown.show(5, {"acceptance": "0.5"})
    shown.close()
    assert "rendering  50%" in out.getvalue() and "acceptance=0.5" in out.getvalue()


@pytest.mark.parametrize("terminal", [True, False])
def test_a_stderr_that_fails_costs_nothing(terminal: bool, clock: Clock, monkeypatch: pytest.MonkeyPatch) -> None:
    class Full(io.StringIO):
        broken = False

        def isatty(self) -> bool:
            return terminal

        def write(self, text: str) -> int:
            if self.broken:
                raise OSError(28, "No space left on device")
            return len(text)

    out = Full()
    monkeypatch.setattr(sys, "stderr", out)
    shown = Progress(10, True)
    out.broken = True
    for _ in range(3):
        clock.now += 20
        shown.show(5, {})
    shown.close()


def test_without_stderr_or_wish_nothing_is_shown(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    Progress(10, False).show(5, {})
    assert capsys.readouterr() == ("", "")
    monkeypatch.setattr(sys, "stderr", None)
    Progress(10, True).show(5, {})
