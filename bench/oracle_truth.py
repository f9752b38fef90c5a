"""How close the kernels are to the float64 oracle: the table and picture of docs/truth.md's first part.

    python -m bench.oracle_truth            runs tests/kernels/test_oracle_agreement.py and gathers what it measured

Errors are in roundings of the number type (the test's docstring says what that means); for each quantity and precision the
table has the worst case's median, 99 % quantile and maximum, and the bounds that the test holds them to. Writes oracle.md,
oracle.json and oracle.png into --out.
"""

from __future__ import annotations

import re
import subprocess
import sys
from typing import Any

import numpy as np

from .report import Report, arguments, table_head

TEST = "tests/kernels/test_oracle_agreement.py"
_CASE = re.compile(r"::\w+\[([^\]]+)\]")
_FOUND = re.compile(r"^(.*?): ([-\d.e+]+) ([-\d.e+]+) ([-\d.e+]+) of \((\d+), (\d+), (\d+)\)$")


def gather(extra: list[str]) -> list[dict[str, Any]]:
    """Run the test and return a record for each quantity that it printed: case, precision, quantity, errors, bounds."""
    command = [sys.executable, "-m", "pytest", "-v", "-s", "-p", "no:cacheprovider", TEST, *extra]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{' '.join(command)} failed:\n{done.stdout[-3000:]}")
    records, case = [], ""
    for line in done.stdout.splitlines():
        named = _CASE.search(line)
        if named:
            case = named[1]
            line = line[named.end() :].strip()
        found = _FOUND.match(line)
        if found:
            name, *numbers = found.groups()
            precision = next(p for p in ("single", "mixed", "double", "float-float") if f"-{p}" in f"-{case}")
            records.append(
                {
                    "case": case,
                    "precision": precision,
                    "quantity": name,
                    "errors": [float(x) for x in numbers[:3]],
                    "bounds": [float(x) for x in numbers[3:]],
                }
            )
    return records


def worst(records: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """A row for each quantity and precision."""
    rows: dict[tuple[str, str, tuple[float, ...]], list[list[float]]] = {}
    for record in records:
        rows.setdefault((record["quantity"], record["precision"], tuple(record["bounds"])), []).append(record["errors"])
    return [
        {"quantity": q, "precision": p, "cases": len(errors), "errors": np.max(errors, axis=0).tolist(), "bounds": list(b)}
        for (q, p, b), errors in sorted(rows.items())
    ]


HEADER = table_head("quantity", "precision", "cases", "median", "99 %", "largest", "bounds")


def line(row: dict[str, Any]) -> str:
    """A row of the table in Markdown."""
    errors = " | ".join(f"{error:.2g}" for error in row["errors"])
    bounds = ", ".join(f"{bound:g}" for bound in row["bounds"])
    return f"| {row['quantity']} | {row['precision']} | {row['cases']} | {errors} | {bounds} |"


def plot(rows: list[dict[str, Any]], report: Report) -> None:
    """Errors over bounds, a line a quantity: left of one is within."""
    with report.figure("oracle", figsize=(9, 0.22 * len(rows) + 1.2)) as (_, panel):
        for k, (label, marker) in enumerate((("median", "o"), ("99 %", "s"), ("largest", "^"))):
            shares = [max(row["errors"][k], 1e-3) / row["bounds"][k] for row in rows]
            panel.plot(shares, range(len(rows)), marker, ms=5, label=label)
        panel.axvline(1, color="C3")
        panel.set_xscale("log")
        panel.set_yticks(range(len(rows)), [f"{row['quantity']}, {row['precision']}" for row in rows], fontsize=7)
        panel.invert_yaxis()
        panel.grid(True, axis="x", alpha=0.3)
        panel.set(xlabel="error over its bound", title="Kernels against the oracle: the worst case of each quantity")
        panel.legend(loc="upper left", fontsize=8)


def main() -> None:
    parser = arguments(__doc__, "docs/truth", device=False)
    parser.add_argument("--full", action="store_true", help="the long grid, float-float too (about 30 minutes)")
    args = parser.parse_args()
    report = Report(args.out)
    rows = worst(gather([] if args.full else ["-m", "not long"]))
    table = "\n".join([HEADER, *map(line, rows)])
    report.markdown("oracle", table)
    report.json("oracle", rows)
    plot(rows, report)
    print(table)


if __name__ == "__main__":
    main()
