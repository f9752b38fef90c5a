"""What each precision does at the extremes: NaN, bias, acceptance, and where it gives up.

    python -m bench.extremes                     every axis of tests/studies/extreme_scenes.py, about 15 minutes on two cores
    python -m bench.extremes --quick             each axis at its two ends, with less work
    python -m bench.extremes --only hole         one axis

Each cell (a value in a precision) is measured with independent seeds and judged against a double-precision reference with
seeds of its own (see tests/studies/extreme_cells.py for the tests); the row ``double`` is that judgement's own control. A mode
has **given up** at a cell, by the first of these that holds:

=========  =============================================================================================================
refused    it says so beforehand, in a message (memory, numbers beyond its range, ...)
dark       it finds no light, and says so in place of a black picture
not finite NaN or infinity in the picture, in the chains' arrays or in the candidates' weights
biased     z beyond Z_LIMIT (Sidak over the table: alpha = 0.01); or the picture's mean is not b, which every step adds
stuck      small steps are accepted less than once in a hundred times
unjudged   too few independent paths find the light, in this mode or in the reference, for a verdict
=========  =============================================================================================================

Writes extremes.json, extremes.png and table.md into ``--out``.
"""

from __future__ import annotations

import argparse
import math
import time
from typing import Any

import numpy as np
from studies.extreme_cells import Z_LIMIT, Cell, acceptance, bias, run, summed, verdict
from studies.extreme_scenes import AXES, Axis

from pylmc import PylmcError

from .extremes_report import markdown, picture
from .report import Report, arguments

PRECISIONS = ("single", "mixed", "double")
LARGE_FILM = 1 << 20  # pixels: one seed is enough to see whether it works
SEEDS, CANDIDATES, CHAINS = 4, 1 << 16, 2048


def row(axis: Axis, value: Any, precision: str, cell: Cell, reference: Cell, groups: list[str] | None) -> dict[str, Any]:
    """A cell's figures, as the JSON has them."""
    judged = bias(cell, reference, groups)
    accepted = acceptance(cell, groups)
    mean, mean_error = summed(cell, groups)
    return {
        "axis": axis.name,
        "value": value,
        "precision": precision,
        "gives_up": verdict(cell, judged, accepted),
        "message": cell.refused,
        "warned": cell.warned,
        "acceptance": accepted,
        "mean": mean,
        "mean_error": mean_error,
        **{f"z_{k}": judged[k] for k in ("b", "film", "balance", "worst")},
        "bias": judged["relative"],
        "bias_error": judged["relative_error"],
        "bad_pixels": cell.bad_pixels,
        "bad_states": cell.bad_states,
        "bad_weights": cell.bad_weights,
        "not_finite_rejected": cell.not_finite,
        "film_loss": cell.film_loss,
        "seconds": round(cell.seconds, 2),
    }


def run_axis(axis: Axis, args: argparse.Namespace) -> list[dict[str, Any]]:
    """All rows of an axis, the reference's own with law's check first at each value."""
    by_length = axis.name == "path length"  # one run holds every length
    values = (axis.values[0], axis.values[-1]) if args.quick else axis.values
    rows: list[dict[str, Any]] = []
    cells: dict[str, Cell] = {}
    before: tuple[float, float] | None = None
    for value in values:
        groups = [f"{value} hit", f"{value} connect"] if by_length else None
        if not (by_length and cells):
            try:
                scene = axis.build(value)
            except PylmcError as error:
                cells = {name: Cell(refused=str(error)) for name in ("reference", *PRECISIONS)}
            else:
                seeds = 1 if scene.camera.width * scene.camera.height >= LARGE_FILM else 2 if args.quick else SEEDS
                work = (axis.max_depth, CANDIDATES >> args.quick, CHAINS >> args.quick)
                for name in ("reference", *PRECISIONS):
                    first = 101 if name == "reference" else 1
                    cells[name] = run(
                        scene,
                        "double" if name == "reference" else name,
                        work[0],
                        range(first, first + seeds),
                        work[1],
                        work[2],
                        device=args.device,
                    )
        reference = cells["reference"]
        expected = axis.law(value) if axis.law else math.nan
        mean, error = summed(reference, groups)
        now = (mean / expected, error / expected)
        law = (now[0] / before[0], float(np.hypot(now[1] / before[0], before[1] * now[0] / before[0] ** 2))) if before else None
        for precision in PRECISIONS:
            rows.append(row(axis, value, precision, cells[precision], reference, groups))
            rows[-1] |= {"law": law[0], "law_error": law[1]} if law and precision == "double" else {}
            print(line(rows[-1]), flush=True)
        before = now if now[0] > 0 else None
    return rows


def line(r: dict[str, Any]) -> str:
    """A row in a few words."""
    shown = f"{r['axis']:15s} {r['value']!s:>11} {r['precision']:7s}"
    if r["message"]:
        return f"{shown} refused: {r['message'][:90]}"
    return (
        f"{shown} z {r['z_worst']:5.1f} (b {r['z_b']:.1f} film {r['z_film']:.1f} balance {r['z_balance']:.1f}) "
        f"bias {r['bias']:+.4f} +- {r['bias_error']:.4f} acc {r['acceptance']:.3f} nf {r['not_finite_rejected']} "
        f"{r['seconds']:.1f}s {r['gives_up']}"
    )


def main() -> None:
    parser = arguments(__doc__, "docs/extremes")
    parser.add_argument("--quick", action="store_true", help="each axis at its two ends, half the seeds, half the work")
    parser.add_argument("--only", action="append", choices=[axis.name for axis in AXES], help="this axis (may be repeated)")
    args = parser.parse_args()
    report = Report(args.out, args.device)
    start = time.perf_counter()
    rows = [r for axis in AXES if not args.only or axis.name in args.only for r in run_axis(axis, args)]
    data = {"seconds": round(time.perf_counter() - start), "quick": args.quick, "z_limit": Z_LIMIT, "rows": rows}
    report.json("extremes", data)
    report.markdown("table", markdown(rows))
    picture(rows, report)
    print(f"{len(rows)} cells in {data['seconds']} s")


if __name__ == "__main__":
    main()
