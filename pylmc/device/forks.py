"""OpenCL in a forked process: drivers' threads stay behind in the parent, and whoever waited for one would wait for ever."""

from __future__ import annotations

import os

from ..errors import PylmcError

_opened = _lost = False


def opening() -> None:
    """To be called before this process opens a driver. Raises PylmcError as :func:`check` does."""
    global _opened
    check()
    _opened = True


def check() -> None:
    """Raise PylmcError if this process was forked from one that had opened a driver."""
    if _lost:
        raise PylmcError(
            "OpenCL was used before this process was forked, and its drivers do not survive that: start processes with "
            "multiprocessing.get_context('spawn'), or render nothing before they are forked"
        )


def _forked() -> None:
    global _lost
    _lost = _opened


if hasattr(os, "register_at_fork"):  # Windows cannot fork
    os.register_at_fork(after_in_child=_forked)
