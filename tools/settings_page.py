"""Writes docs/settings.md, the table of every setting, from pylmc.settings: ``python tools/settings_page.py``."""

from __future__ import annotations

from dataclasses import Field, fields
from pathlib import Path
from typing import Any

from pylmc.options import Flag, default_words, flag
from pylmc.settings import Run, Settings

PAGE = Path(__file__).resolve().parents[1] / "docs" / "settings.md"
HEAD = """\
# Settings

Written by `python tools/settings_page.py` from `pylmc/settings.py`, where each of these is described once.

Names in Python and on the command line differ in spelling only. A setting that concerns some integrators only is
refused on the command line, and has no effect in Python, with another one.
"""


def row(item: Field[Any]) -> str:
    """The table's row of one field."""
    kind = item.metadata["kind"]
    option = f"`--{flag(item.name)}`" + (f", `--no-{flag(item.name)}`" if isinstance(kind, Flag) else "")
    default = f"`{item.default}`" if isinstance(kind, Flag) else default_words(item)
    cells = [f"`{item.name}`", option, kind.words(), default, ", ".join(item.metadata["integrators"]) or "all"]
    return "| " + " | ".join([*cells, item.metadata["help"]]) + " |"


def page() -> str:
    """The whole page."""
    parts = [HEAD]
    titles = (
        (Run, "A render", "Of `pylmc.render` and `pylmc render`."),
        (Settings, "How light is sampled", "Of `pylmc.render`, `info` and `Sampler`, and of `pylmc render` and `pylmc info`."),
    )
    for kind, title, where in titles:
        head = "| Python | command line | values | default | integrators | what it is |\n|---|---|---|---|---|---|"
        parts.append(f"## {title}\n\n{where}\n\n{head}\n" + "\n".join(row(item) for item in fields(kind)) + "\n")
    return "\n".join(parts)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
