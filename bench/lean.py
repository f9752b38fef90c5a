"""Model only what a scene requires: what specialising the kernels to a scene saves.

    python -m bench.lean                    the built-in scenes, each with its own kernel and with one that has everything
    python -m bench.lean --rounds 3         quicker and rougher

The general kernel has every feature (point lights, emitters, every lobe, smooth normals, textures, narrow lobes, small
objects) and room for paths of 32 segments; it draws the same chains, for its lobes come with shapes that no ray meets, one
of each material. Then, for the box, each feature is compiled in by itself. Kernels take turns; time per mutation is the
median over the rounds, compile time that of a cold build. Writes lean.json, lean.md and lean.png into --out.
"""

from __future__ import annotations

import random
import time
from statistics import median
from typing import Any

import numpy as np
import pyopencl as cl

import pylmc
from pylmc.sampling.evenness import GRID
from pylmc.sampling.sampler import Sampler
from pylmc.scene import Material, Scene, Shape
from pylmc.settings import MAX_DEPTH

from .report import Report, arguments, table_head

SCENES = ("box", "glints", "keyhole", "caustic")
CHAINS, STEPS, DEPTH = 4096, 32, 6


def with_every_lobe(scene: Scene) -> Scene:
    """The scene and, across it, a shape of each material that no ray meets: its faces have no area."""
    bounds = np.concatenate([shape.bounds() for shape in scene.shapes])
    low, high = bounds.min(axis=0), bounds.max(axis=0)
    corners = np.where(np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]], bool), high, low)
    edges = [[0, 1, 1], [1, 2, 2], [2, 3, 3]]
    unseen = [Shape((corners, edges), kind(), name=f"unseen {kind.__name__}") for kind in Material.kinds]
    return Scene(scene.camera, [*scene.shapes, *unseen], scene.lights, scene.portals)


Variant = tuple[Sampler, dict[str, Any]]


def variants(name: str, device: Any) -> dict[str, Variant]:
    """Kernels to compare, by name: the chains that they move, and their constants beyond those of the chains' own kernel."""
    scene = pylmc.load(name, width=64, height=64)
    own, general = (Sampler(each, device=device, max_depth=DEPTH) for each in (scene, with_every_lobe(scene)))
    features = [key for key in own.compiled.features if key.startswith("HAS_")]
    everything = {key: True for key in [*features, "HAS_DEVIATION"]} | {"MAX_DEPTH": MAX_DEPTH}
    found: dict[str, Variant] = {"specialised": (own, {}), "general": (general, everything)}
    if name == "box":
        absent = [key for key in features if not own.compiled.features[key]]
        found |= {f"with {key}": (own, {key: True}) for key in absent if key not in ("HAS_NARROW", "HAS_PAIRS")}
        # a lobe is narrow, and of a pair, where there are such lobes
        narrow = {"HAS_NARROW": True, "HAS_DEVIATION": True}
        plain = {key: own.compiled.features[key] for key in features}
        found |= {
            "with every lobe": (general, {**plain, "HAS_PAIRS": True, "HAS_DEVIATION": False}),
            "with every lobe, narrow": (general, {**plain, "HAS_PAIRS": True, **narrow}),
            "with room for 32 segments": (own, {"MAX_DEPTH": MAX_DEPTH}),
            "with drift": (own, {"DRIFT": True}),
        }
    for sampler in (own, general):
        if not sampler.compiled.features["HAS_TIES"]:  # a table in which nothing lies on any side of a triangle
            sides = 2 * len(sampler.compiled.arrays["faces"])
            device_scene = sampler.device_scene
            device_scene.buffers["ties"] = device_scene.upload(np.full(sides + 1, sides + 1, np.int32))
        sampler.init(seed=1, chains=CHAINS, candidates=1 << 15)
    return found


def built(sampler: Sampler, constants: dict[str, Any]) -> tuple[dict[str, Any], float, dict[str, int]]:
    """(the kernel's constants, seconds of a cold build, what the driver tells)."""
    device = sampler.device_scene
    # compilers' caches know a program by its text, some of them after preprocessing: one constant is written as never before
    constants = {**constants, "EVENNESS_GRID": f"({GRID} + 0 * {random.SystemRandom().randrange(1 << 31)})"}
    start = time.perf_counter()
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
    rows = []
    kernels = {}
    for label, (sampler, constants) in variants(name, device).items():
        constants, seconds, told = built(sampler, constants)
        kernels[label] = sampler, constants
        rows.append({"scene": name, "kernel": label, "build_seconds": seconds, **told})
    times: dict[str, list[float]] = {label: [] for label in kernels}
    for _ in range(rounds):
        for label, (sampler, constants) in kernels.items():
            start = time.perf_counter()
            sampler.step(4 * STEPS, **constants)
            times[label].append((time.perf_counter() - start) / (4 * STEPS * sampler.chains))
    for row in rows:
        label = row["kernel"]
        row["ns_per_mutation"] = 1e9 * median(times[label])
        row["ratio"] = median(np.array(times[label]) / np.array(times["specialised"]))
        print(line(row), flush=True)
    return rows


HEADER = table_head("scene", "kernel", "ns per mutation", "ratio", "cold build [s]", "binary [kB]", "private memory told [B]")


def line(row: dict[str, Any]) -> str:
    """A row of the table in Markdown."""
    return (
        f"| {row['scene']} | {row['kernel']} | {row['ns_per_mutation']:.0f} | {row['ratio']:.2f} "
        f"| {row['build_seconds']:.1f} | {row['binary_bytes'] / 1000:.0f} | {row['private_bytes']} |"
    )


def plot(rows: list[dict[str, Any]], report: Report) -> None:
    """Specialised against general by scene, and the box's kernel with each feature."""
    with report.figure("lean", 1, 2, figsize=(12, 4.5), width_ratios=(1, 1.4)) as (_, (left, right)):
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


def main() -> None:
    parser = arguments(__doc__, "docs/trade")
    parser.add_argument("--rounds", type=int, default=7, help="measurements of each kernel (default 7)")
    args = parser.parse_args()
    report = Report(args.out, args.device)
    print(HEADER, flush=True)
    rows = [row for name in SCENES for row in measure(name, args.rounds, args.device)]
    report.json("lean", rows)
    report.markdown("lean", "\n".join([HEADER, *map(line, rows)]))
    plot(rows, report)


if __name__ == "__main__":
    main()
