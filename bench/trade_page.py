"""What ``bench.trade`` found, as a table, two plots and a page in words."""

from __future__ import annotations

from typing import Any

import numpy as np

from .report import Report, table_head

SCENES = ("keyhole", "caustic", "glints", "box")
LABELLED = 6  # options named in each panel: those on the front, then the best
HEADER = table_head(
    *("scene", "option", "against", "error, equal time", "ratio", "error, equal mutations", "ratio", "bias", "mutations/s"),
    *("ratio", "ESS/s", "acceptance"),
)


def line(row: dict[str, Any]) -> str:
    """A row of the table in Markdown; a bias within twice its noise is given as what it is below."""
    bias, noise = 100 * row["bias"], 100 * row["bias_noise"]
    shown = f"{bias:.1f} %" if bias > 2 * noise else f"< {2 * noise:.1f} %"
    ess = f"{row['ess_per_second']:.3g}" if row["ess_per_second"] else ""
    accepted = f"{row['acceptance']:.2f}" if row["acceptance"] is not None and np.isfinite(row["acceptance"]) else ""
    against = "" if row["option"] == row["against"] else row["against"]
    return (
        f"| {row['scene']} | {row['option']} | {against} | {row['equal_time']:.3g} | {row['equal_time_ratio']:.2f} "
        f"| {row['equal_work']:.3g} | {row['equal_work_ratio']:.2f} | {shown} | {row['per_second']:.3g} "
        f"| {row['per_second_ratio']:.2f} | {ess} | {accepted} |"
    )


def pareto(rows: list[dict[str, Any]]) -> list[tuple[float, float, str]]:
    """(seconds, error, option) of those points that no other is better than in both, by time."""
    points = sorted((t, e, row["option"]) for row in rows for t, e in zip(row["seconds"], row["errors"], strict=True))
    front, best = [], np.inf
    for t, e, option in points:
        if e < best:
            best = e
            front.append((t, e, option))
    return front


def plot(found: dict[str, Any], report: Report) -> None:
    """Error against time, a panel a scene, with the Pareto front drawn: no option there is worse in both."""
    from matplotlib import colormaps

    names = [name for name in SCENES if name in found]
    with report.figure("trade", 2, 2, figsize=(13, 10)) as (figure, panels):
        for panel in panels.flat[len(names) :]:
            panel.set_visible(False)
        for panel, name in zip(panels.flat, names, strict=False):
            rows = found[name]
            front, chains = pareto(rows), pareto([row for row in rows if row["integrator"] == "lmc"])
            shown = list(dict.fromkeys([option for *_, option in front + chains] + ["default", "path", "bdpt"]))[: LABELLED + 3]
            colours = colormaps["tab10"]
            for row in rows:
                known = row["option"] in shown
                colour = colours(shown.index(row["option"]) % 10) if known else "0.8"
                style: dict[str, Any] = (
                    {"lw": 1.6, "marker": "o", "zorder": 3, "label": row["option"]} if known else {"lw": 0.7}
                )
                panel.loglog(row["seconds"], row["errors"], color=colour, ms=3, **style)
            for points, label, style in ((front, "Pareto front", "-"), (chains, "Pareto front of the chains", "--")):
                times, errors = [t for t, *_ in points], [e for _, e, _ in points]
                panel.loglog(times, errors, style, color="k", lw=3, alpha=0.35, zorder=2, label=label)
            panel.set(title=name, xlabel="run time [s]", ylabel="relMSE without the worst 0.1 %")
            panel.grid(True, which="both", alpha=0.2)
            panel.legend(fontsize=8)
        figure.suptitle("Error against time; every option in grey, those on the front and the baselines in colour")


def plot_unit_jacobian(rows: list[dict[str, float]], report: Report) -> None:
    """Bias of the printed unit Jacobian against roughness, with the exact chart's noise."""
    alpha = [row["alpha"] for row in rows]
    with report.figure("unit_jacobian", figsize=(6.5, 4)) as (_, panel):
        panel.loglog(alpha, [row["unit"] for row in rows], "o-", label="orthographic-unit (as printed)")
        panel.loglog(alpha, [row["exact"] for row in rows], "s--", color="0.5", label="orthographic (exact): noise")
        panel.set(xlabel="GGX roughness of all walls", ylabel="relative deviation of the film's cells")
        panel.set_title("The unit Jacobian's bias")
        panel.grid(True, which="both", alpha=0.2)
        panel.legend()


def _rows(found: dict[str, Any], option: str) -> dict[str, dict[str, Any]]:
    return {name: row for name in SCENES for row in found.get(name, []) if row["option"] == option}


def mean_ratio(found: dict[str, Any], option: str, key: str) -> float:
    """Geometric mean over the scenes of an option's ratio to what it stands against; NaN where no scene has it."""
    values = [row[f"{key}_ratio"] for row in _rows(found, option).values()]
    return float(np.exp(np.mean(np.log(values)))) if values else float("nan")


def _each(found: dict[str, Any], option: str, key: str) -> str:
    return ", ".join(f"{name} {row[f'{key}_ratio']:.2f}" for name, row in _rows(found, option).items())


def _compared(found: dict[str, Any], option: str, label: str) -> str:
    return (
        f"| {label} | {mean_ratio(found, option, 'equal_time'):.2f} | {mean_ratio(found, option, 'equal_work'):.2f} "
        f"| {mean_ratio(found, option, 'per_second'):.2f} | {_each(found, option, 'equal_time')} |"
    )


def biased(found: dict[str, Any]) -> list[str]:
    """Options whose bias is beyond twice its noise, and beyond the default's, by scene."""
    out = []
    for name in SCENES:
        base = next((row for row in found.get(name, []) if row["option"] == "default"), None)
        for row in found.get(name, []):
            if base and row["bias"] > 2 * row["bias_noise"] and row["bias"] > base["bias"] + 2 * base["bias_noise"]:
                out.append(f"{row['option']} on {name}: {100 * row['bias']:.1f} %")
    return out


def findings(found: dict[str, Any]) -> str:
    """The page's text, figures from the measurement alone."""
    how = found["how"]
    drift, drift_d = (mean_ratio(found, o, "equal_time") for o in ("drift", "drift, deviation charts"))
    isotropic = {
        o: mean_ratio(found, o, "equal_time")
        for o in ("isotropic, blocks", "isotropic, whole steps", "isotropic, deviation charts")
    }
    charts = mean_ratio(found, "deviation charts", "equal_time")
    whole = mean_ratio(found, "whole steps", "equal_time")
    gains = {
        "the target charts (against deviation charts)": charts,
        "blocks (against whole steps)": whole,
        "the preconditioner, in target charts with blocks (against isotropic steps)": isotropic["isotropic, blocks"],
        "the preconditioner, in target charts, whole steps": isotropic["isotropic, whole steps"],
        "the preconditioner, in deviation charts": isotropic["isotropic, deviation charts"],
        "large steps at 0.2 (against 0.05)": mean_ratio(found, "large steps 0.05", "equal_time"),
        "small steps (against large steps alone)": mean_ratio(found, "large steps alone", "equal_time"),
        "the evened target": mean_ratio(found, "target not evened", "equal_time"),
        "drift": 1 / drift,
    }
    ranked = sorted(gains.items(), key=lambda item: -item[1])
    pays = [ratio < 1 - MARGIN for ratio in (drift, drift_d)]
    verdict = "pays" if all(pays) else "pays in places" if any(pays) else "does not pay"
    largest = ranked[0][0]
    text = [
        f"Each scene at {how['size']} × {how['size']} pixels and paths of up to 8 segments, {how['seeds']} seeds of "
        f"{how['seconds']:g} s on {how['made']['device']}; the reference is a run of {how['reference']:g} s in double "
        "precision by other seeds. Ratios below one are better than what the option stands against, above one worse.",
        "",
        "![error against time](trade/trade.png)",
        "",
        "## Is the follow-up paper right?",
        "",
        "The group's own follow-up (Mathematics 2024, 12(21), 3437) says that drift can be dropped because it does not improve "
        "convergence, and that the preconditioner gives the largest gain while needing no gradient.",
        "",
        f"**Drift {verdict}.** With it the error at equal time is {drift:.2f} times that without in target charts "
        f"({_each(found, 'drift', 'equal_time')}) and {drift_d:.2f} times in deviation charts "
        f"({_each(found, 'drift, deviation charts', 'equal_time')}). At equal mutations it is "
        f"{mean_ratio(found, 'drift', 'equal_work'):.2f} and {mean_ratio(found, 'drift, deviation charts', 'equal_work'):.2f}.",
        "",
        f"**The preconditioner** lowers the error at equal time by {isotropic['isotropic, deviation charts']:.2f} in deviation "
        f"charts, the paper's own phase space, by {isotropic['isotropic, whole steps']:.2f} in target charts with whole steps "
        f"and by {isotropic['isotropic, blocks']:.2f} with blocks (geometric means over the scenes; by scene: "
        f"{_each(found, 'isotropic, deviation charts', 'equal_time')} in deviation charts, "
        f"{_each(found, 'isotropic, blocks', 'equal_time')} with blocks). The largest gain of all measured is {largest}:",
        "",
        "| what | error without it over error with it, at equal time |",
        "|---|---|",
        *(f"| {name} | {gain:.2f} |" for name, gain in ranked),
        "",
        "## The options",
        "",
        "Geometric means over the scenes in which the option changes anything.",
        "",
        "| option | equal time | equal mutations | mutations/s | equal time by scene |",
        "|---|---|---|---|---|",
        *(
            _compared(found, option, option + (f" (against {against})" if against != "default" else ""))
            for option, against in _all_options(found)
        ),
        "",
        *defaults(found),
        "",
        f"Bias beyond twice the noise of its measurement (and beyond the default's): {'; '.join(biased(found)) or 'none'}.",
        "",
    ]
    if "unit_jacobian" in found:
        text += [
            "## The unit Jacobian",
            "",
            "The preprint takes the orthographic chart's Jacobian as one. Small steps alone, deviation coordinates, a box "
            "whose walls all have the same roughness (`bench/unit_jacobian.py`):",
            "",
            "![bias against roughness](trade/unit_jacobian.png)",
            "",
            "| roughness | deviation of the film's cells, as printed | with the exact Jacobian (noise) |",
            "|---|---|---|",
            *(
                f"| {row['alpha']:g} | {100 * row['unit']:.1f} % | {100 * row['exact']:.1f} % |"
                for row in found["unit_jacobian"]
            ),
            "",
        ]
    return "\n".join(text)


# What each default is chosen among: exact alternatives that answer the same question.
CHOICES = {
    "precision single": ("precision mixed", "precision double", "precision float-float"),
    "coordinates target, blocks": ("whole steps", "deviation charts"),
    "chart equal-area": ("orthographic",),
    "constraints: all kinds": ("isotropic, blocks", "without lobes", "without holes", "without objects", "without normals"),
    "rule sum": ("rule mean", "rule rms"),
    "drift off": ("drift",),
    "differentials full": ("reduced differentials",),
    "step h 0.01 to 0.3": ("h = 0.03", "h = 0.1", "h = 0.3", "h = 0.7", "h 0.001 to 0.1", "h 0.03 to 1"),
    "large steps 0.2": ("large steps 0.05", "large steps 0.5", "large steps alone"),
    "evened target": ("target not evened",),
    "aim from everywhere": ("aim from the light",),
}
MARGIN = 0.05  # ratios nearer to one than this are within the noise of three seeds


def defaults(found: dict[str, Any]) -> list[str]:
    """The section on the defaults: each against the best of its alternatives, in geometric mean over the scenes."""
    lines = [
        "## The defaults",
        "",
        f"A default stays unless an exact alternative has a lower error at equal time by more than {100 * MARGIN:.0f} %, "
        "in geometric mean over the scenes that it concerns. `math` stays exact whatever it gains: the tests' guarantees "
        "go with it.",
        "",
        "| default | best alternative | its error over the default's | verdict |",
        "|---|---|---|---|",
    ]
    for default, options in CHOICES.items():
        ratios = {option: mean_ratio(found, option, "equal_time") for option in options if _rows(found, option)}
        if not ratios:  # none of the scenes measured has a choice here
            continue
        best = min(ratios, key=lambda option: ratios[option])
        verdict = "stays" if ratios[best] > 1 - MARGIN else "**the alternative is better**"
        lines.append(f"| {default} | {best} | {ratios[best]:.2f} | {verdict} |")
    return lines


def _all_options(found: dict[str, Any]) -> list[tuple[str, str]]:
    seen: dict[str, str] = {}
    for name in SCENES:
        for row in found.get(name, []):
            if row["option"] != "default":
                seen.setdefault(row["option"], row["against"])
    return list(seen.items())


def write_page(found: dict[str, Any], report: Report) -> None:
    """trade.md, the plots, and the page beside the folder, whose hand-written end (from its marker on) is kept."""
    table = "\n".join([HEADER, *(line(row) for name in SCENES for row in found.get(name, []))])
    report.markdown("trade", table)
    plot(found, report)
    if "unit_jacobian" in found:
        plot_unit_jacobian(found["unit_jacobian"], report)
    page = report.folder.parent / "trade.md"
    marker = "<!-- below: written by hand -->"
    written = page.read_text(encoding="utf-8") if page.exists() else ""
    kept = written.split(marker, 1)[1] if marker in written else "\n"
    head = (
        "# The trade of speed for accuracy\n\n`python -m bench.trade` makes this page, its "
        "[table of all cells](trade/trade.md) and its plots.\n\n"
    )
    page.write_text(head + findings(found) + lean(report) + "\n" + marker + kept, encoding="utf-8")


def lean(report: Report) -> str:
    """The section on specialised kernels, from what ``bench.lean`` left in the same folder."""
    table = report.folder / "lean.md"
    if not table.exists():
        return ""
    return (
        "\n## Model only what a scene requires\n\n`python -m bench.lean` builds, for each scene, its own kernel and one "
        "for everything; and, for the box, its own with one feature more at a time. They draw the same chains.\n\n"
        "![time per mutation](trade/lean.png)\n\n" + table.read_text(encoding="utf-8")
    )
