"""Radiometry at a presentable size: the scenes of tests/studies/comparison rendered by pylmc and by Mitsuba 3, and compared.

    python -m bench.truth                  writes docs/truth/radiometry.png, .json and .md, and prints the table
    python -m bench.truth --scenes room    one scene only

Needs a checkout (the scenes are the tests' own) and the extras ``mitsuba`` and ``bench``. Each renderer makes independent
runs with seeds of their own for the given time; p-values are those of tests/studies/comparison/verdict.py. One row of the
picture is a scene; its columns are Mitsuba, lmc, path (exposed alike) and the two differences in standard errors of each pixel,
of luminance. Seeds are fixed, but as runs are filled by time, figures vary a little between machines.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from studies.comparison.description import Description
from studies.comparison.scenes import SCENES
from studies.comparison.to_mitsuba import mitsuba_runs
from studies.comparison.to_pylmc import lmc_runs, path_runs, pylmc_scene
from studies.comparison.verdict import Verdict, judge

from pylmc.colour import LUMINANCE
from pylmc.picture.tonemap import exposure, tonemap

from .report import Report, arguments, table_head

INTEGRATORS = ("lmc", "path")
END = 5.0  # standard errors at the ends of the colour scale
Runs = np.ndarray


def timed(render: Callable[[int], Runs], pilot: int, seconds: float) -> Runs:
    """Runs of as much work as fills ``seconds``, judged by a pilot of ``pilot`` units, whose runs are thrown away."""
    render(1)  # compiled by now
    start = time.perf_counter()
    render(pilot)
    return render(max(round(pilot * seconds / (time.perf_counter() - start)), 1))


def render_all(scene: Description, runs: int, seconds: float) -> dict[str, Runs]:
    """Pictures (runs, height, width, 3) by each renderer, each given the same time."""
    ours = pylmc_scene(scene)
    return {
        "mitsuba": timed(lambda n: mitsuba_runs(scene, runs, 4 * n), 4, seconds),
        "lmc": timed(lambda n: lmc_runs(ours, scene.depth, runs, 32 * n, chains=4096), 1, seconds),
        "path": timed(lambda n: path_runs(ours, scene.depth, runs, 4 * n), 4, seconds),
    }


def row_of(scene: Description, integrator: str, verdict: Verdict) -> dict[str, Any]:
    """Numbers of one comparison."""
    return {"scene": scene.name, "about": scene.about, "depth": scene.depth, "integrator": integrator, **verdict.summary()}


HEADER = table_head(
    "scene", "segments", "integrator", "least p of pixels", "of tiles", "of the film", "mean over Mitsuba's", "agrees"
)


def line(row: dict[str, Any]) -> str:
    """A row of the table in Markdown."""
    p = row["least_p"]
    agrees = "yes" if row["passed"] else "**no**"
    return (
        f"| {row['scene']}: {row['about']} | {row['depth']} | {row['integrator']} | {p['pixels']:.1e} | {p['tiles']:.1e} "
        f"| {p['film']:.1e} | {row['ratio']:.4f} ± {row['ratio_error']:.4f} | {agrees} |"
    )


def caption(rows: list[dict[str, Any]], runs: int, size: int, seconds: float) -> str:
    """What the table's numbers mean, for the reader of the page."""
    first = rows[0]
    levels = ", ".join(
        f"{first['threshold'][level]:.1e} for each of {first['tests'][level]} {label}"
        for level, label in (
            ("pixels", f"values ({size} x {size} pixels, three channels)"),
            ("tiles", "tiles' values"),
            ("film", "values of the whole film"),
        )
    )
    return (
        f"{runs} independent runs of each renderer, {seconds:g} s for all of them; Welch's t-test. All {len(rows)} "
        f"comparisons together fail with probability {first['alpha']:g} if nothing is wrong (Šidák): a p-value counts "
        f"below {levels}."
    )


def luminance_t(ours: Runs, theirs: Runs) -> np.ndarray:
    """Difference of mean luminance in standard errors (height, width), each pixel by its own runs."""
    a, b = ours @ LUMINANCE, theirs @ LUMINANCE
    error = np.sqrt(a.var(axis=0, ddof=1) / len(a) + b.var(axis=0, ddof=1) / len(b))
    difference = a.mean(axis=0) - b.mean(axis=0)
    return np.divide(difference, error, where=error > 0, out=np.zeros_like(error))


def draw(pictures: dict[str, dict[str, Runs]], report: Report) -> None:
    """The contact sheet."""
    columns = ["Mitsuba 3", *(f"pylmc {name}" for name in INTEGRATORS), *(f"{name} − Mitsuba" for name in INTEGRATORS)]
    size = (1.5 * len(columns) + 0.9, 1.53 * len(pictures) + 0.3)
    shape = (len(pictures), len(columns))
    with report.figure("radiometry", *shape, dpi=120, figsize=size, squeeze=False) as (figure, axes):
        shown = None
        for row, (name, runs) in zip(axes, pictures.items(), strict=True):
            exposed = exposure(runs["mitsuba"].mean(axis=0))
            for axis, which in zip(row, ("mitsuba", *INTEGRATORS), strict=False):
                axis.imshow(tonemap(runs[which].mean(axis=0), exposed), interpolation="nearest")
            for axis, which in zip(row[1 + len(INTEGRATORS) :], INTEGRATORS, strict=True):
                shown = axis.imshow(
                    luminance_t(runs[which], runs["mitsuba"]), cmap="RdBu_r", vmin=-END, vmax=END, interpolation="nearest"
                )
            row[0].set_ylabel(name, fontsize=8)
            for axis in row:
                axis.set_xticks([])
                axis.set_yticks([])
        for axis, title in zip(axes[0], columns, strict=True):
            axis.set_title(title, fontsize=8)
        assert shown is not None
        bar = figure.colorbar(shown, ax=axes, shrink=0.5, aspect=40, pad=0.01)
        bar.set_label("difference in standard errors of the pixel", fontsize=8)
        bar.ax.tick_params(labelsize=7)


def main() -> None:
    parser = arguments(__doc__, "docs/truth", device=False)
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES), help="which scenes (default all)")
    parser.add_argument("--seconds", type=float, default=10, help="time of each renderer in each scene (default 10)")
    parser.add_argument("--runs", type=int, default=16, help="independent runs of each renderer (default 16)")
    parser.add_argument("--size", type=int, default=40, help="pixels per side (default 40)")
    args = parser.parse_args()
    report = Report(args.out)
    print(HEADER, flush=True)
    rows: list[dict[str, Any]] = []
    pictures = {}
    for name in args.scenes:
        scene = SCENES[name].with_size(args.size, args.size)
        pictures[name] = render_all(scene, args.runs, args.seconds)
        for integrator in INTEGRATORS:
            verdict = judge(pictures[name][integrator], pictures[name]["mitsuba"], len(args.scenes) * len(INTEGRATORS))
            rows.append(row_of(scene, integrator, verdict))
            print(line(rows[-1]), flush=True)
    note = caption(rows, args.runs, args.size, args.seconds)
    print("\n" + note)
    report.json("radiometry", rows)
    report.markdown("radiometry", "\n".join([HEADER, *map(line, rows), "", note]))
    draw(pictures, report)


if __name__ == "__main__":
    main()
