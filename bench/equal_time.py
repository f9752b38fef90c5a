"""Equal time, equal scene: how much lower is the error of the chains than that of the baselines?

    python -m bench.equal_time                 the keyhole at hole 0.01, roughness 0.005, and at a tenth of both
    python -m bench.equal_time --seconds 10    quicker and rougher

The two bdpt rows are the chains' own independent sampler alone: as it is, aiming at the hole from the light, from diffuse
nodes and from the camera; and as theory.md, 6 has it, with the light's first direction aimed only.

Each method renders for the same run time with each of the seeds; the error is relMSE per pixel against a long reference
(lmc with target charts, other seeds), whole and with the worst 0.1 % of pixels left out. Medians over the seeds; the
last columns are ratios to the first method. Writes out/equal_time.json and .md, and the pictures beside them.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

import pylmc
from pylmc.picture.metrics import metrics

from .report import Report, arguments, table_head

METHODS: dict[str, dict[str, Any]] = {
    "lmc, target charts": {},
    "lmc, deviation charts": {"coordinates": "deviation"},
    "bdpt, aimed from everywhere": {"integrator": "bdpt"},
    "bdpt, aimed from the light": {"integrator": "bdpt", "aim": "light"},
    "path": {"integrator": "path"},
}
CASES = ({"hole": 0.01, "alpha": 0.005}, {"hole": 0.001, "alpha": 0.0005})


def run_case(case: dict[str, float], args: argparse.Namespace, folder: Path) -> list[dict[str, Any]]:
    """One row a method: medians of the errors, speed, and the ratios to the first row."""
    label = "keyhole_" + "_".join(f"{k}{v:g}" for k, v in case.items())
    scene = pylmc.load("keyhole", **case).with_size(args.size, args.size)
    common = {"max_depth": args.max_depth, "device": args.device}
    share = args.reference / args.seeds
    parts = [pylmc.render(scene, seconds=share, seed=1000 + s, progress=False, **common).image for s in range(args.seeds)]
    reference = np.mean(parts, axis=0)
    found: dict[str, list[tuple[float, float, float]]] = {method: [] for method in METHODS}
    for seed in range(args.seeds):  # the methods take turns, so that a busy machine is busy for all of them
        for method, options in METHODS.items():
            result = pylmc.render(scene, seconds=args.seconds, seed=seed, progress=False, **common, **options)
            error = metrics(result.image, reference)
            rate = result.diagnostics.get("mutations_per_second", result.diagnostics.get("samples_per_second", 0.0))
            found[method].append((error["relMSE"], error["relMSE_trimmed"], rate))
            result.save(folder / f"{label}_{method.replace(', ', '_').replace(' ', '_')}.exr")
    rows: list[dict[str, Any]] = []
    for method, values in found.items():
        errors, trimmed, rates = zip(*values, strict=True)
        row = {
            "case": case,
            "method": method,
            "relMSE": median(errors),
            "relMSE_trimmed": median(trimmed),
            "all": errors,
            "per_second": median(rates),
        }
        rows.append(row)
        row["ratio"] = row["relMSE"] / rows[0]["relMSE"]
        row["ratio_trimmed"] = row["relMSE_trimmed"] / rows[0]["relMSE_trimmed"]
        print(line(row), flush=True)
    # how far the reference itself is from the truth, from its parts
    spread = np.mean([metrics(part, reference)["relMSE"] for part in parts]) / max(args.seeds - 1, 1)
    print(f"the reference's own relMSE is about {spread:.2g}\n", flush=True)
    rows[0]["reference_relMSE"] = float(spread)
    return rows


HEADER = table_head("hole", "roughness", "method", "relMSE", "trimmed", "ratio", "ratio, trimmed", "mutations or samples/s")


def line(row: dict[str, Any]) -> str:
    """A row of the table in Markdown."""
    case = row["case"]
    return (
        f"| {case['hole']:g} | {case['alpha']:g} | {row['method']} | {row['relMSE']:.3g} | {row['relMSE_trimmed']:.3g} "
        f"| {row['ratio']:.1f} | {row['ratio_trimmed']:.1f} | {row['per_second']:.3g} |"
    )


def main() -> None:
    parser = arguments(__doc__, "out/equal_time")
    parser.add_argument("--seconds", type=float, default=30, help="run time of each render (default 30)")
    parser.add_argument("--reference", type=float, default=300, help="run time of the whole reference (default 300)")
    parser.add_argument("--seeds", type=int, default=3, help="renders per method (default 3)")
    parser.add_argument("--size", type=int, default=256, help="pixels per side (default 256)")
    parser.add_argument("--max-depth", type=int, default=6, help="segments of the longest path (default 6)")
    args = parser.parse_args()
    report = Report(args.out, args.device, pictures=False)
    print(HEADER, flush=True)
    rows = [row for case in CASES for row in run_case(case, args, args.out)]
    report.json("equal_time", rows)
    report.markdown("equal_time", "\n".join([HEADER, *map(line, rows)]))


if __name__ == "__main__":
    main()
