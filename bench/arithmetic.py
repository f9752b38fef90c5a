"""What log, exp, sin, cos and vectors' products of our own (cl_kernels/number) cost against the implementation's.

    python -m bench.arithmetic                 every usable device, the built-in scenes, chains in exact single precision
    python -m bench.arithmetic --rounds 5 --scenes keyhole --integrators lmc bdpt path

The two take turns; a row gives the time of a mutation (sample) with our own over that with built-in ones, and with ours for
the vectors only: medians over the rounds.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any
from unittest.mock import patch

import numpy as np

import pylmc
from pylmc.device import program, survey
from pylmc.integrators import INTEGRATORS
from pylmc.sampling.sampler import Sampler

from .report import arguments, circumstances, table_head, words
from .running import prepared

FUNCTIONS = tuple(
    line for name in ("exp", "log", "sin", "cos") for line in (f"#undef {name}\n", f"#define {name} {name}_float\n")
)
VECTORS = (
    *(f"#undef {name}\n" for name in ("dot", "cross", "mix", "length", "normalize", "distance")),
    "#undef rsqrt\n#define rsqrt(x) (1.0 / sqrt(x))\n",
    *(f"#define {name} real_{name}\n" for name in ("dot", "cross", "mix", "normalize")),
    *(f"#define {name} real_{name}\n" for name in ("length(v)", "distance(a, b)")),
)
VARIANTS = {"built-in": (*FUNCTIONS, *VECTORS), "own vectors": FUNCTIONS, "own": ()}
SCENES = ("keyhole", "glints", "caustic", "box")
HEADER = table_head("scene", "integrator", "built-in [ns]", "own vectors", "own")
SIZE, DEPTH = 64, 6
ADVANCES = 4  # of a worker, to one measurement


@contextmanager
def without(lines: Sequence[str]) -> Iterator[None]:
    """Kernels are built without these lines of the number types."""
    original = program.source

    def source(name: str, files: Any = None) -> str:
        text = original(name, files)
        if name == "number/real.cl":
            for line in lines:
                assert line in text, line
                text = text.replace(line, "\n" * line.count("\n"))
        return text

    with patch.object(program, "source", source):
        yield


def seconds(worker: Any) -> float:
    """Of a mutation (sample)."""
    start, done = time.perf_counter(), worker.done
    for _ in range(ADVANCES):
        worker.advance()
    return (time.perf_counter() - start) / (worker.done - done)


def measured(scene: str, integrator: str, device: str, rounds: int) -> dict[str, tuple[float, float]]:
    """By variant: (ns of a mutation or sample, its ratio to the first variant's)."""
    workers = []
    for lines in VARIANTS.values():
        with without(lines):
            sampler = Sampler(pylmc.load(scene, width=SIZE, height=SIZE), max_depth=DEPTH, device=device)
            workers.append(prepared(sampler, integrator, 0))
            seconds(workers[-1])
    times = np.array([[seconds(worker) for worker in workers] for _ in range(rounds)])
    ratios = np.median(times / times[:, :1], axis=0)
    return dict(zip(VARIANTS, zip(1e9 * np.median(times, axis=0), ratios, strict=True), strict=True))


def main() -> None:
    parser = arguments(__doc__, device=False)
    parser.add_argument("--rounds", type=int, default=15, help="measurements of each (default 15)")
    parser.add_argument("--scenes", nargs="+", default=SCENES, choices=SCENES)
    parser.add_argument("--integrators", nargs="+", default=["lmc"], choices=list(INTEGRATORS))
    args = parser.parse_args()
    for index in range(len(survey.usable())):
        print(f"{words(circumstances(str(index)))}\n\n{HEADER}", flush=True)
        for scene in args.scenes:
            for integrator in args.integrators:
                found = measured(scene, integrator, str(index), args.rounds)
                ratios = " | ".join(f"{ratio:.2f}" for _, ratio in list(found.values())[1:])
                print(f"| {scene} | {integrator} | {found['built-in'][0]:.0f} | {ratios} |", flush=True)


if __name__ == "__main__":
    main()
