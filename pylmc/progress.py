"""How far a render is, on stderr: a bar on a terminal, elsewhere a line now and then."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Mapping

from tqdm import tqdm

# Seconds until the first line, then between two of them at least, and at least this part of the time so far: a long
# run's log stays short.
FIRST_LINE, BETWEEN_LINES, BETWEEN_LINES_PART = 1.0, 10.0, 0.1


class Progress:
    """Shows how much of ``goal`` is done. A stderr that cannot be written costs what is shown, not the render."""

    def __init__(self, goal: float, shown: bool) -> None:
        self._goal = goal
        self._start = time.perf_counter()
        self._due = FIRST_LINE
        self._shown = shown and sys.stderr is not None
        self._bar: tqdm | None = None
        if self._shown and sys.stderr.isatty():
            layout = "{desc} {percentage:3.0f}% |{bar}| time left {remaining}{postfix}"
            self._bar = tqdm(total=goal, desc="rendering", bar_format=layout)

    def show(self, done: float, note: Mapping[str, str]) -> None:
        """Say that ``done`` of the goal is done; ``note`` holds what else there is to tell."""
        if not self._shown:
            return
        try:
            if self._bar is not None:
                self._bar.n = min(done, self._goal)
                self._bar.set_postfix(note)
            else:
                self._line(min(done / self._goal, 1.0), note)
        except OSError:
            self._shown = False

    def _line(self, part: float, note: Mapping[str, str]) -> None:
        elapsed = time.perf_counter() - self._start
        if elapsed < self._due or part <= 0:
            return
        self._due = elapsed + max(BETWEEN_LINES, BETWEEN_LINES_PART * elapsed)
        left = tqdm.format_interval(elapsed * (1 - part) / part)
        told = ", ".join(f"{name}={value}" for name, value in note.items())
        print(f"rendering {100 * part:3.0f}%, time left {left}, {told}", file=sys.stderr, flush=True)

    def close(self) -> None:
        """Leave the bar as it stands."""
        if self._bar is not None:
            with contextlib.suppress(OSError):
                self._bar.close()
