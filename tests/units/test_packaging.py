"""What is installed is what lies in the checkout."""

from __future__ import annotations

import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_every_package_is_installed() -> None:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["setuptools"]
    there = {str(file.parent.relative_to(ROOT)).replace("/", ".") for file in ROOT.glob("pylmc/**/*.py")}
    assert set(settings["packages"]) == there | {"pylmc.cl_kernels"}
    assert settings["package-data"]["pylmc.cl_kernels"] == ["**/*.cl"]
