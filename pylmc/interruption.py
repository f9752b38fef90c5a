"""Ending early: a first Ctrl-C asks, so that what is under way is finished and kept; a second one ends it at once."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

SAME = 0.2  # seconds in which a second signal belongs to the first: `timeout` signals its child, then the child's group


class Asked:
    """Whether somebody has asked to stop; as a handler of SIGINT, what is asked by Ctrl-C."""

    def __init__(self) -> None:
        self._since: float | None = None

    def is_set(self) -> bool:
        """Whether somebody has asked."""
        return self._since is not None

    def ask(self) -> None:
        """Ask to stop."""
        self._since = self._since or time.monotonic()

    def __call__(self, number: int, frame: Any) -> None:
        if self._since is not None and time.monotonic() - self._since > SAME:
            raise KeyboardInterrupt
        self.ask()


@contextmanager
def gently() -> Iterator[Asked]:
    """Within, the first Ctrl-C is only noted, and a second one raises KeyboardInterrupt.

    One within another is the same request. In a thread other than the main one, which gets no signals, none is noted.
    """
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread():
        yield Asked()
    elif isinstance(before, Asked):
        yield before
    else:
        asked = Asked()
        signal.signal(signal.SIGINT, asked)
        try:
            yield asked
        finally:
            signal.signal(signal.SIGINT, before)
