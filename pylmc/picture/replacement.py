"""Files that appear whole or not at all: written under another name in the same folder, then renamed."""

from __future__ import annotations

import contextlib
import os
import secrets
import shutil
from pathlib import Path

from ..errors import PylmcError


class Replacement:
    """Several files that take their places together when this is left; after an exception none does.

    An earlier file stays as it is until then, so that a full disk costs nothing but the new one.
    """

    def __init__(self) -> None:
        self._files: dict[Path, Path] = {}

    def path_for(self, target: str | Path) -> Path:
        """Where to write what shall become ``target``. Links are followed; what is no plain file is written directly."""
        real = Path(os.path.realpath(target))
        if real.exists() and not real.is_file():
            return real
        return self._files.setdefault(real, real.with_name(f".pylmc-{secrets.token_hex(6)}"))

    def __enter__(self) -> Replacement:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        try:
            for real, written in self._files.items() if kind is None else ():
                try:
                    if real.exists():
                        shutil.copymode(real, written)
                    os.replace(written, real)
                except OSError as error:
                    raise PylmcError(f"{real}: cannot be replaced: {error.strerror}; check its folder") from None
        finally:
            for written in self._files.values():
                with contextlib.suppress(OSError):
                    written.unlink(missing_ok=True)
