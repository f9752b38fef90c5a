"""What bench programs write: figures with what they are a property of."""

import json
from pathlib import Path

import numpy as np
import pytest

from bench.report import Report, arguments, circumstances, plain, stored, table_head, words


def test_figures_say_where_they_are_from(tmp_path: Path) -> None:
    report = Report(tmp_path / "new" / "folder", pictures=False)
    report.json("a", {"rows": [{"x": np.float32(0.5), "n": np.int64(3), "bad": np.nan, "far": np.inf}]})
    report.markdown("a", table_head("x", "n") + "\n| 0.5 | 3 |\n\n")
    written = json.loads((report.folder / "a.json").read_text(encoding="utf-8"))
    assert written["made"] == report.made == circumstances()
    assert all(written["made"][key] for key in ("command", "commit", "device", "driver", "processor", "python"))
    assert stored(report.folder / "a.json") == {"rows": [{"x": 0.5, "n": 3, "bad": None, "far": None}]}
    assert stored(report.folder / "b.json") is None
    text = (report.folder / "a.md").read_text(encoding="utf-8")
    assert text == f"{words(report.made)}\n\n| x | n |\n|---|---|\n| 0.5 | 3 |\n"


def test_a_figure_is_written_once_it_is_drawn(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    with Report(tmp_path).figure("a", 1, 2, figsize=(2, 1)) as (_, (left, right)):
        left.plot([1, 2])
        right.plot([2, 1])
        assert not (tmp_path / "a.png").exists()
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_arguments_and_plain_values() -> None:
    options = arguments("About.", "out/here").parse_args(["--device", "cpu"])
    assert options.device == "cpu" and options.out == Path("out/here")
    assert plain({"a": (np.bool_(True), np.arange(2), -np.inf)}) == {"a": [True, [0, 1], None]}
