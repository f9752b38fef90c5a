"""SIGTERM and SIGHUP end a command as Ctrl-C does."""

from __future__ import annotations

import signal
import threading
from typing import Any

from ..interruption import Asked

AS_CTRL_C = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))  # Windows has no SIGHUP


class Signals:
    """While this is entered, SIGTERM and SIGHUP ask to stop, or raise KeyboardInterrupt where nobody listens.

    Only the first of them counts: a terminal that is closed sends several. Those that the parent ignores, as nohup does,
    stay ignored.
    """

    def __init__(self) -> None:
        self._number = signal.SIGINT
        self._before: dict[int, Any] = {}

    @property
    def name(self) -> str:
        """What ended the command, as people write it."""
        return "Ctrl-C" if self._number == signal.SIGINT else self._number.name

    @property
    def code(self) -> int:
        """The exit code of a command that it ended, as a shell gives it."""
        return 128 + self._number

    def __enter__(self) -> Signals:
        if threading.current_thread() is threading.main_thread():
            for number in AS_CTRL_C:
                if signal.getsignal(number) != signal.SIG_IGN:
                    self._before[number] = signal.signal(number, self._handle)
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _handle(self, number: int, frame: Any) -> None:
        if self._number != signal.SIGINT:
            return
        self._number = signal.Signals(number)
        listener = signal.getsignal(signal.SIGINT)
        if not isinstance(listener, Asked):
            raise KeyboardInterrupt
        listener.ask()
