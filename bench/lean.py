"""Model only what a scene requires: what specialising the kernels to a scene saves.

    python -m bench.lean                    the built-in scenes, each with its own kernel and with one that has everything
    python -m bench.lean --rounds 3         quicker and rougher

The general kernel has every feature (point lights, emitters, GGX, refraction, smooth normals, textures, narrow lobes, small
objects, a hole) and room for paths of 32 segments; it draws the same chains. Then, for the box, each feature is compiled in
by itself. Kernels take turns; time per mutation is the median over the rounds, compile time that of a cold build. Writes
lean.json, lean.md and lean.png into --out.
"""

from __future__ import annotations

import argparse
import json
import time
import uuid
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
import pyopencl as cl

import pylmc
from pylmc.sampling.sampler import Sampler
from pylmc.settings import MAX_DEPTH

SCENES = ("box", "glints", "keyhole", "caustic")
CHAINS, STEPS, DEPTH = 4096, 32, 6


def everything(sampler: Sampler) -> dict[str, Any]:
    """The constants of a kernel for any scene."""
    features = sampler.compiled.features
    return {name: True for name in features if name.startswith("HAS_")} | {"HAS_DEVIATION": True, "MAX_DEPTH": MAX_DEPTH}


def variants(name: str, sampler: Sampler) -> dict[str, dict[str, Any]]:
    """Kernels to compare, by name: their constants beyond the scene's own."""
    found = {"specialised": {}, "general": everything(sampler)}
    if name == "box":
        flags = {key: True for key, on in sampler.compiled.features.items() if key.startswith("HAS_") and not on}
        found |= {f"with {key}": {key: True} for key in flags}
        found |= {
            "with HAS_NARROW, HAS_DEVIATION": {"HAS_NARROW": True, "HAS_DEVIATION": True},
            "with room for 32 segments": {"MAX_DEPTH": MAX_DEPTH},
            "with drift": {"DRIFT": True},
        }
        del found["with HAS_NARROW"]
    return found


def built(sampler: Sampler, constants: dict[str, Any]) -> tuple[dict[str, Any], float, dict[str, int]]:
    """(the kernel's constants, seconds of a cold build, what the driver tells). A comment of its own keeps caches away."""
    device = sampler.device_scene
    start = time.perf_counter()
    constants = {**constants, "FAULT": f"0 // {uuid.uuid4().hex}"}
    sampler.step(0, **constants)  # some implementations compile for real at the first launch
    seconds = time.perf_counter() - start
    kernel = device.kernel("entry/chains.cl", "run_chains", **constants)
    info = cl.kernel_work_group_info
    told = {
        "private_bytes": kernel.get_work_group_info(info.PRIVATE_MEM_SIZE, device.device),
        "binary_bytes": len(kernel.program.binaries[0]),
    }
    return constants, seconds, told


def measure(name: str, rounds: int, device: Any) -> list[dict[str, Any]]:
    """A row a variant: nanoseconds per mutation and its ratio to the specialised kernel's, build time, memory."""
    sampler = Sampler(pylmc.load(name, width=64, height=64), device=device, max_depth=DEPTH)
    sampler.init(seed=1, chains=CHAINS, candidates=1 << 15)
    rows = []
    kernels = {}
    for label, constants in variants(name, sampler).items():
        kernels[label], seconds, told = built(sampler, constants)
        rows.append({"scene": name, "kernel": label, "build_seconds": seconds, **told})
    times: dict[str, list[float]] = {label: [] for label in kernels}
    for _ in range(rounds):
        for label, constants in kernels.items():
            start = time.perf_counter()
            sampler.step(4 * STEPS, **constants)
            times[label].append((time.perf_counter() - start) / (4 * STEPS * sampler.chains))
    for row in rows:
        label = row["kernel"]
        row["ns_per_mutation"] = 1e9 * median(times[label])
        row["ratio"] = median(np.array(times[label]) / np.array(times["specialised"]))
        print(line(row), flush=True)
    return rows


HEADER = (
    "| scene | kernel | ns per mutation | ratio | cold build [s] | binary [kB] | private memory told [B] |\n"
    "|---|---|---|---|---|---|---|"
)


def line(row: dict[str, Any]) -> str:
    """A row of the table in Markdown."""
    return (
        f"| {row['scene']} | {row['kernel']} | {row['ns_per_mutation']:.0f} | {row['ratio']:.2f} "
        f"| {row['build_seconds']:.1f} | {row['binary_bytes'] / 1000:.0f} | {row['private_bytes']} |"
    )


def plot(rows: list[dict[str, Any]], path: Path) -> None:
    """Specialised against general by scene, and the box's kernel with each feature."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 4.5), layout="constrained", width_ratios=(1, 1.4))
    for offset, label in ((-0.2, "specialised"), (0.2, "general")):
        own = [row for row in rows if row["kernel"] == label]
        places = [SCENES.index(row["scene"]) + offset for row in own]
        left.bar(places, [row["ns_per_mutation"] for row in own], 0.4, label=label)
    left.set_xticks(range(len(SCENES)), SCENES)
    left.set(ylabel="ns per mutation", title="A kernel of its own, and one for everything")
    left.legend()
    box = [row for row in rows if row["scene"] == "box"]
    right.barh([row["kernel"] for row in box], [row["ratio"] for row in box], color="C0")
    right.axvline(1, color="k", lw=1)
    right.set(xlabel="time per mutation over that of the specialised kernel", title="box")
    right.invert_yaxis()
    figure.savefig(path, dpi=80)
    plt.close(figure)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=7, help="measurements of each kernel (default 7)")
    parser.add_argument("--device", default=None, help="as for pylmc render")
    parser.add_argument("--out", type=Path, default=Path("docs/trade"), help="folder for the results (default docs/trade)")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    print(HEADER, flush=True)
    rows = [row for name in SCENES for row in measure(name, args.rounds, args.device)]
    (args.out / "lean.json").write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    (args.out / "lean.md").write_text("\n".join([HEADER, *map(line, rows)]) + "\n", encoding="utf-8")
    plot(rows, args.out / "lean.png")


if __name__ == "__main__":
    main()
