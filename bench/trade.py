"""Speed against accuracy, measured: every named approximation against its exact form.

    python -m bench.trade                      all four scenes, three seeds of 3 s each (about 45 minutes)
    python -m bench.trade --seconds 1 --only box --reference 20
    python -m bench.trade --page               write the table, the plots and docs/trade.md from what was measured before

Each scene has a long reference in double precision by other seeds. Each option runs with each seed, the options taking turns,
and is looked at on the way. The error is relMSE of luminance per pixel without the worst 0.1 %, read off the option's own
curve at the default's number of mutations (equal mutations) and at as many as the option makes in the default's time (equal
time); that speed is a ratio, measured in short turns beside the default, medians of several. Bias is what is left when the
seeds' pictures are averaged and their spread is taken off. Writes trade.json, trade.md, trade.png and unit_jacobian.png
into --out, and trade.md beside it.
"""

from __future__ import annotations

import argparse
from statistics import median
from typing import Any

import numpy as np

import pylmc
from pylmc.sampling.compiled import compile_scene
from pylmc.sampling.sampler import Sampler

from .report import Report, arguments, stored
from .running import Reference, Trace, cell_bias, rate_ratios, reference, relative_mse, run
from .trade_options import DEPTH, OPTIONS, Option, applies
from .trade_page import write_page
from .unit_jacobian import measure_unit_jacobian

SCENES = ("keyhole", "caustic", "glints", "box")
STOPS = (1 / 8, 1 / 4, 1 / 2, 1.0)


def measure(name: str, args: argparse.Namespace) -> list[dict[str, Any]]:
    """One row an option: errors, bias, rates."""
    scene = pylmc.load(name, width=args.size, height=args.size)
    depths = sorted({option.depth for option in OPTIONS})
    print(f"{name}: reference of {args.reference:g} s", flush=True)
    truth = reference(scene, depths, args.reference, device=args.device)
    compiled = compile_scene(scene)
    options = [option for option in OPTIONS if applies(option, compiled)]
    samplers = {}
    for option in options:
        settings = {"max_depth": DEPTH, **option.settings}
        samplers[option.name] = Sampler(scene, device=args.device, **settings)
        run(samplers[option.name], 1e-9, 0, option.integrator)  # compiles
    traces: dict[str, list[Trace]] = {option.name: [] for option in options}
    for seed in range(args.seeds):
        for option in options:
            traces[option.name].append(run(samplers[option.name], args.seconds, seed, option.integrator, STOPS))
        print(f"{name}: seed {seed} done", flush=True)
    goal = median(trace.work[-1] for trace in traces["default"])
    rates = rate_ratios([(samplers[option.name], option.integrator) for option in options], args.rounds, args.slice)
    rows = [row(name, option, traces[option.name], truth, rate, goal) for option, rate in zip(options, rates, strict=True)]
    compare(rows)
    return rows


def compare(rows: list[dict[str, Any]]) -> None:
    """Add each row's ratios to the option that it stands against, where the scene has it, or to the default."""
    of = {entry["option"]: entry for entry in rows}
    against = {option.name: option.against for option in OPTIONS}
    for entry in rows:
        base = of.get(against[entry["option"]], of["default"])
        entry["against"] = base["option"]
        for key in ("equal_time", "equal_work", "per_second"):
            entry[f"{key}_ratio"] = entry[key] / base[key]


def row(scene: str, option: Option, traces: list[Trace], truth: Reference, rate: float, goal: float) -> dict[str, Any]:
    """An option's figures, medians over its seeds; ``rate`` is its speed over the default's.

    The truth holds longer paths too where the option is about max depth.
    """
    depth = max(truth.mean) if "max_depth" in option.settings else DEPTH
    mean, variance = truth.mean[depth], truth.variance[depth]
    curves = [[max(relative_mse(picture, mean, variance), 1e-9) for picture in trace.pictures] for trace in traces]
    bias, noise = cell_bias([trace.pictures[-1] for trace in traces], mean, variance)
    return {
        "scene": scene,
        "option": option.name,
        "integrator": option.integrator,
        "settings": option.settings,
        "seconds": [median(t.seconds[i] for t in traces) for i in range(len(curves[0]))],
        "errors": [median(curve[i] for curve in curves) for i in range(len(curves[0]))],
        "work": [median(t.work[i] for t in traces) for i in range(len(curves[0]))],
        "equal_time": median(at(goal * rate, trace.work, curve) for trace, curve in zip(traces, curves, strict=True)),
        "equal_work": median(at(goal, trace.work, curve) for trace, curve in zip(traces, curves, strict=True)),
        "bias": bias,
        "bias_noise": noise,
        "per_second": rate * goal / median(t.seconds[-1] for t in traces),
        "ess_per_second": median(t.diagnostics.get("ess", 0.0) / t.seconds[-1] for t in traces),
        "acceptance": median(t.diagnostics.get("acceptance", float("nan")) for t in traces),
        "not_finite": sum(t.diagnostics.get("not_finite_rejected", 0) for t in traces),
        "finite": all(np.isfinite(picture).all() for trace in traces for picture in trace.pictures),
    }


def at(goal: float, amounts: list[float] | list[int], errors: list[float]) -> float:
    """The error at an amount of time or work: read off the curve, and beyond its end in proportion to one over it."""
    if goal <= amounts[-1]:
        return float(np.exp(np.interp(np.log(goal), np.log(amounts), np.log(errors))))
    return errors[-1] * amounts[-1] / goal


def main() -> None:
    parser = arguments(__doc__, "docs/trade")
    parser.add_argument("--only", choices=SCENES, action="append", help="these scenes (default: all)")
    parser.add_argument("--seconds", type=float, default=3, help="run time of each render (default 3)")
    parser.add_argument("--seeds", type=int, default=3, help="renders per option, at least 2 (default 3)")
    parser.add_argument("--reference", type=float, default=180, help="run time of each scene's reference (default 180)")
    parser.add_argument("--rounds", type=int, default=5, help="turns in which speeds are measured (default 5)")
    parser.add_argument("--slice", type=float, default=0.3, help="seconds of each turn (default 0.3)")
    parser.add_argument("--size", type=int, default=128, help="pixels per side, a multiple of 16 (default 128)")
    parser.add_argument("--page", action="store_true", help="only write the table, plots and page again")
    args = parser.parse_args()
    report = Report(args.out, args.device)
    found: dict[str, Any] = stored(args.out / "trade.json") or {}
    if args.page:
        report.made = found["how"]["made"]
    else:
        for name in args.only or SCENES:
            found[name] = measure(name, args)
            found["how"] = {
                "seconds": args.seconds,
                "seeds": args.seeds,
                "reference": args.reference,
                "size": args.size,
                "made": report.made,
            }
            report.json("trade", found)
        found["unit_jacobian"] = measure_unit_jacobian(args.device)
        report.json("trade", found)
    write_page(found, report)


if __name__ == "__main__":
    main()
