"""The program's handlers of signals, kept in force against those that compilers put over them."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

# LLVM, which is in most implementations, takes these to remove its temporary files. Its handler serves once: the second
# of two signals in a row, as `timeout` sends them, would end the process at once and lose the picture.
TAKEN = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


@contextmanager
def kept_handlers() -> Iterator[None]:
    """Python's handlers are in force again when this is left (by the main thread, which alone may set them)."""
    try:
        yield
    finally:
        if threading.current_thread() is threading.main_thread():
            for number in TAKEN:
                handler = signal.getsignal(number)
                if callable(handler):
                    signal.signal(number, handler)
