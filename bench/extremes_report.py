"""The table and the picture of bench.extremes."""

from __future__ import annotations

import math
from typing import Any

from studies.extreme_scenes import AXES

from .report import Report, table_head

MARKS = {"refused": "R", "dark": "D", "not finite": "N", "biased": "B", "stuck": "S", "unjudged": "?"}
COLUMNS = (
    *("value", "precision", "bias of the mean", "z: b", "film", "balance", "acceptance", "NaN, Inf", "rejected", "law"),
    *("gives up", "warned"),
)
SHOWN_Z = 8.0  # the colour scale ends here


def shown(value: Any) -> str:
    """A value of an axis, short."""
    return value if isinstance(value, str) else f"{value:g}"


def markdown(rows: list[dict[str, Any]]) -> str:
    """One table per axis."""
    parts = []
    for axis in AXES:
        own = [r for r in rows if r["axis"] == axis.name]
        if not own:
            continue
        parts.append(f"### {axis.name}: {axis.what}\n")
        parts.append(table_head(*COLUMNS))
        parts += [_line(r) for r in own]
        parts.append("")
    return "\n".join(parts)


def _line(r: dict[str, Any]) -> str:
    warned = "yes" if r["warned"] else ""
    if r["message"]:
        nothing = " | " * 8
        return f"| {shown(r['value'])} | {r['precision']} |{nothing}| {r['gives_up']}: {r['message']} | {warned} |"
    bad = r["bad_pixels"] + r["bad_states"] + r["bad_weights"]
    law = f"{r['law']:.3f} ± {r['law_error']:.3f}" if r.get("law") is not None else ""
    bias = f"{100 * r['bias']:+.2f} ± {100 * r['bias_error']:.2f} %"
    return (
        f"| {shown(r['value'])} | {r['precision']} | {bias} | {r['z_b']:.1f} | {r['z_film']:.1f} | {r['z_balance']:.1f} "
        f"| {r['acceptance']:.3f} | {bad} | {r['not_finite_rejected']} | {law} | {r['gives_up']} | {warned} |"
    )


def picture(rows: list[dict[str, Any]], report: Report) -> None:
    """A heat map per axis: columns are values, rows precisions; colour is the bias in standard errors, the number in a cell
    the acceptance of small steps, a letter the reason why the mode has given up there."""
    from matplotlib.patches import Rectangle

    axes = [axis for axis in AXES if any(r["axis"] == axis.name for r in rows)]
    columns = 2 if len(axes) > 1 else 1
    lines = -(-len(axes) // columns)
    size = (6.4 * columns, 1.75 * lines + 0.9)
    with report.figure("extremes", lines, columns, dpi=90, figsize=size, squeeze=False) as (figure, places):
        image = None
        for place, axis in zip(places.flat, axes, strict=False):
            own = [r for r in rows if r["axis"] == axis.name]
            values, modes = list(dict.fromkeys(r["value"] for r in own)), list(dict.fromkeys(r["precision"] for r in own))
            zs = [[0.0] * len(values) for _ in modes]
            for r in own:
                i, j = modes.index(r["precision"]), values.index(r["value"])
                refused, given_up = bool(r["message"]), r["gives_up"]
                zs[i][j] = math.nan if refused else min(r["z_worst"], SHOWN_Z)
                text = "" if refused else f"{r['acceptance']:.2f}"
                dark = not refused and r["z_worst"] > 0.6 * SHOWN_Z
                place.text(
                    j,
                    i,
                    f"{text} {MARKS[given_up]}".strip() if given_up else text,
                    ha="center",
                    va="center",
                    fontsize=10,
                    color="white" if dark else "black",
                    weight="bold" if given_up else "normal",
                )
                if given_up:
                    place.add_patch(Rectangle((j - 0.47, i - 0.44), 0.94, 0.88, fill=False, edgecolor="black", linewidth=2))
            place.set_facecolor("#cccccc")
            image = place.imshow(zs, vmin=0, vmax=SHOWN_Z, cmap="YlOrRd", aspect="auto")
            place.set_xticks(range(len(values)), [shown(v) for v in values], fontsize=9)
            place.set_yticks(range(len(modes)), modes, fontsize=9)
            place.set_title(f"{axis.name}: {axis.what}", fontsize=8.5, loc="left")
        for place in list(places.flat)[len(axes) :]:
            place.axis("off")
        bar = figure.colorbar(image, ax=places, location="bottom", shrink=0.6, aspect=50, pad=0.02)
        words = ", ".join(f"{letter} {name}" for name, letter in MARKS.items())
        bar.set_label(
            f"bias against double, in standard errors; in the cells: acceptance of small steps. Gives up: {words}", fontsize=9
        )
