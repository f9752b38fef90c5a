"""Does the Markov kernel keep its target? Every configuration of tests/studies/invariance_cases.py, and the faults that
must be seen.

    python -m bench.sampler_truth             writes docs/truth/sampler.md, .json and .png, and prints the table
    python -m bench.sampler_truth --seed 7    with other random numbers

Needs a checkout (the configurations are the tests' own) and the extra ``bench``. Unlike the tests, which share two samples
of a scene's target among its configurations, every configuration has samples of its own here, so that their p-values are
independent of each other. Seeds are fixed: the same device gives the same table.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import stats
from studies.ergodicity import STEPS, run
from studies.invariance import Outcome
from studies.invariance_cases import ALPHA, CASES, CONTROLS, FAULTY, start

from .report import Report, arguments, table_head

HEADER = table_head("{what}", "scene", "precision", "steps", "accepted", "tests", "least p", "{bound}", "corrected", "")


def row(name: str, scene: str, precision: str, steps: int, outcome: Outcome, faulty: bool = False) -> dict[str, Any]:
    """Numbers of one comparison; ``faulty``: it must fail."""
    passed = outcome.smallest < FAULTY if faulty else outcome.corrected > ALPHA
    return {
        "name": name,
        "scene": scene,
        "precision": precision,
        "steps": steps,
        "acceptance": outcome.acceptance,
        "tests": outcome.tests,
        "least": outcome.smallest,
        "of": outcome.worst,
        "corrected": outcome.corrected,
        "bound": FAULTY if faulty else outcome.threshold(ALPHA),
        "as_it_should": passed,
        "p_values": list(outcome.p_values.values()),
    }


def run_all(seed: int) -> dict[str, list[dict[str, Any]]]:
    """Rows of the three tables."""
    rows: dict[str, list[dict[str, Any]]] = {"kept": [], "seen": [], "met": []}
    seeds = {}
    for number, case in enumerate(CASES):
        seeds[case.name] = seed + 10 * number
        rows["kept"].append(row(case.name, case.scene, case.precision, case.steps, case.run(seed=seeds[case.name])))
        print(line(rows["kept"][-1]), flush=True)
        if not any(control.twin is case for control in CONTROLS):
            start.cache_clear()  # its paths would only take memory
        for control in CONTROLS:
            if control.twin is case:
                outcome = control.run(seeds[case.name])
                rows["seen"].append(row(control.name, case.scene, case.precision, case.steps, outcome, faulty=True))
                print(line(rows["seen"][-1]), flush=True)
    for scene, steps in STEPS.items():
        before, (after, *_) = run(scene, 0.0, steps, large_steps=0.5)
        rows["met"].append(row("two paths, before", scene, "single", 0, before, faulty=True))
        rows["met"].append(row("two paths, after", scene, "single", steps, after))
    _, (apart, *_) = run("caustic", 0.0, STEPS["caustic"], large_steps=0.0)
    rows["met"].append(row("two paths, after small steps alone", "caustic", "single", STEPS["caustic"], apart, faulty=True))
    return rows


def shown(p: float) -> str:
    return "< 1e-300" if p < 1e-300 else f"{p:.1e}" if p < 0.01 else f"{p:.2f}"


def line(r: dict[str, Any]) -> str:
    """A row in Markdown."""
    accepted = f"{r['acceptance']:.2f}" if r["acceptance"] else ""
    verdict = "as it should" if r["as_it_should"] else "**not as it should**"
    return (
        f"| {r['name']} | {r['scene']} | {r['precision']} | {r['steps']} | {accepted} | {r['tests']} | {shown(r['least'])} "
        f"| {shown(r['bound'])} | {shown(r['corrected'])} | {verdict} |"
    )


def markdown(rows: dict[str, list[dict[str, Any]]]) -> str:
    """The page's part on the sampler."""
    family = -np.expm1(len(rows["kept"]) * np.log1p(-ALPHA))
    pooled = np.concatenate([r["p_values"] for r in rows["kept"]])
    kinds = {"kept": ("configuration", "must exceed"), "seen": ("fault", "must be below"), "met": ("chains", "bound")}
    tables = {
        kind: "\n".join([HEADER.format(what=what, bound=bound), *map(line, rows[kind])])
        for kind, (what, bound) in kinds.items()
    }
    return f"""Chains start in an exact sample of the target, take some steps, and are compared with another exact sample: every
coordinate (film, nodes, directions, deviations, log π) of every group by Kolmogorov and Smirnov's test and by χ² over 16
bins, the lobes and the film by χ², and every pixel by itself. Alpha is {ALPHA:g} for a configuration, Šidák-corrected over its
tests, hence {family:.2g} for the table. Of all {len(pooled)} p-values, {100 * np.mean(pooled < 0.01):.2f} % are below 0.01 and
{100 * np.mean(pooled < 0.001):.3f} % below 0.001.

{tables["kept"]}

The twin of a fault is the same configuration, with the same random numbers, without it; it is in the table above.

{tables["seen"]}

Two sets of chains, all of each group in one path, those at the left and at the right end of the film, and the same after a
mixture of half large and half small steps. The two sets must differ before, and must not after; small steps alone keep a
path's lobes, so that they cannot meet.

{tables["met"]}

![p-values against uniform](sampler.png)

Configurations that must pass, above: sorted p-values against those of a uniform distribution, the smallest to the left. Grey:
all of them, pooled; blue: the smallest of each configuration, corrected, and where 95 % of each would be if tests were
independent. They are not, which makes the correction err on the high side, as do the starts, whose resampling is systematic.
Faults, below: the smallest p-value of each, and of its twin.
"""


def draw(rows: dict[str, list[dict[str, Any]]], report: Report) -> None:
    """QQ-plot of the configurations, and the faults below it."""
    with report.figure("sampler", 2, 1, dpi=110, figsize=(7, 7.5), height_ratios=(3, 1.3)) as (_, (above, below)):
        pooled = np.sort(np.concatenate([r["p_values"] for r in rows["kept"]]))
        corrected = np.sort([r["corrected"] for r in rows["kept"]])
        n, ranks = len(corrected), np.arange(1, len(corrected) + 1)
        low, high = (stats.beta.ppf(q, ranks, n + 1 - ranks) for q in (0.025, 0.975))
        least = 0.3 / len(pooled)
        above.fill_between(ranks / (n + 1), low, high, color="tab:blue", alpha=0.15, linewidth=0)
        above.plot([least, 1], [least, 1], color="black", linewidth=0.8)
        above.plot(
            np.arange(1, len(pooled) + 1) / (len(pooled) + 1),
            pooled,
            ".",
            color="0.45",
            markersize=3,
            label=f"all {len(pooled)} tests",
        )
        above.plot(
            ranks / (n + 1),
            corrected,
            "o",
            color="tab:blue",
            markersize=5,
            label=f"smallest of each of {n} configurations, corrected",
        )
        above.axhline(ALPHA, color="tab:red", linestyle="--", linewidth=1)
        limit = f"a configuration fails below α = {ALPHA:g}, corrected"
        above.text(0.98, ALPHA * 1.15, limit, color="tab:red", fontsize=9, ha="right")
        above.set(
            xscale="log",
            yscale="log",
            xlim=(least, 1.1),
            ylim=(min(least, pooled[0] / 2), 1.3),
            xlabel="uniform quantile",
            ylabel="p-value",
            title="Configurations that must pass",
        )
        above.legend(loc="upper left", fontsize=9)
        faults = sorted(rows["seen"], key=lambda r: r["least"], reverse=True)
        digits = [-np.log10(max(r["least"], 1e-300)) for r in faults]
        end = max(digits) * 1.05
        below.plot(
            [-np.log10(r["twin"]) for r in faults],
            range(len(faults)),
            "o",
            color="tab:blue",
            label="the same without the fault",
        )
        below.plot(digits, range(len(faults)), "D", color="tab:red", markersize=7, label="with the fault")
        for y, (x, r) in enumerate(zip(digits, faults, strict=True)):
            right = x < end / 2
            below.text(
                x + (0.02 if right else -0.02) * end,
                y,
                f"{r['name']}: {shown(r['least'])}",
                va="center",
                ha="left" if right else "right",
                fontsize=9,
            )
        below.axvline(-np.log10(FAULTY), color="tab:red", linestyle="--", linewidth=1)
        below.set_yticks([])
        below.set(
            xlim=(0, end),
            ylim=(-1.9, len(faults) - 0.4),
            xlabel=f"−log₁₀ of the smallest p-value (dashed: {FAULTY:g})",
            title="Faults that must be seen",
        )
        below.legend(loc="lower right", fontsize=9)


def main() -> None:
    parser = arguments(__doc__, "docs/truth", device=False)
    parser.add_argument("--seed", type=int, default=1001, help="of the first configuration (default 1001)")
    args = parser.parse_args()
    report = Report(args.out)
    rows = run_all(args.seed)
    twins = {control.name: r["least"] for control in CONTROLS for r in rows["kept"] if r["name"] == control.twin.name}
    for r in rows["seen"]:
        r["twin"] = twins[r["name"]]
    page = markdown(rows)
    print(page)
    report.markdown("sampler", page)
    # p-values are hundreds of numbers each
    kept = {kind: [{key: r[key] for key in r if key != "p_values"} for r in table] for kind, table in rows.items()}
    report.json("sampler", kept)
    draw(rows, report)


if __name__ == "__main__":
    main()
