"""stdout and stderr that may be closed, full or hung up: what cannot be written is noted, and stops nothing."""

from __future__ import annotations

import contextlib
import errno
import io
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any


class Output:
    """A text stream in place of ``stream`` (None where it is closed) whose writing never raises.

    ``error`` is the first failure; what is written after it is dropped. All else is the stream's own.
    """

    def __init__(self, stream: Any) -> None:
        self._stream = stream
        self.error: OSError | None = None
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a file's name must not break a terminal of few characters

    def write(self, text: str) -> int:
        """Write, or note why not."""
        if self._stream is None:
            self.error = OSError(errno.EBADF, "it is closed")
        else:
            self._try(lambda: self._stream.write(text))
        return len(text)

    def flush(self) -> None:
        """Flush, or note why not."""
        if self._stream is not None:
            self._try(self._stream.flush)

    def isatty(self) -> bool:
        """Whether a person may be looking on."""
        return self._stream is not None and bool(self._stream.isatty())

    def _try(self, do: Callable[[], object]) -> None:
        if self.error is not None:
            return
        try:
            do()
        except OSError as error:
            self.error = error
            # What is left in the stream's buffer must not fail once more when Python flushes it at the end.
            with contextlib.suppress(OSError, ValueError), open(os.devnull, "wb") as nowhere:
                os.dup2(nowhere.fileno(), self._stream.fileno())

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


@contextmanager
def outputs() -> Iterator[Output]:
    """sys.stdout (which is handed out) and sys.stderr as Outputs, for as long as this is entered.

    A closed 0, 1 or 2 is opened on the null device: else the next file that is opened, such as the picture, would get
    that number, and with it whatever a driver prints.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)
    before = sys.stdout, sys.stderr
    out, err = Output(sys.stdout), Output(sys.stderr)
    sys.stdout, sys.stderr = out, err
    try:
        yield out
    finally:
        out.flush()
        err.flush()
        sys.stdout, sys.stderr = before
