"""The bias of the preprint's unit Jacobian against roughness (theory.md, 2, Correction).

Chains that start in the target are moved by small steps alone, in deviation coordinates, in a box whose walls are GGX of one
roughness. What they no longer agree with is read off the film: the root mean square, over cells, of the relative deviation
of the chains' film positions from those of chains with the exact Jacobian.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import pylmc
from pylmc.sampling.sampler import Sampler
from pylmc.scene import Diffuse, RoughConductor, Scene, Shape

ROUGHNESS = (0.01, 0.03, 0.1, 0.3, 0.6, 1.0)
CELLS, CHAINS, STEPS, RUNS = 6, 16384, 400, 8


def glossy_box(alpha: float) -> Scene:
    """The built-in box with all of its walls and blocks of GGX roughness ``alpha``; its light stays as it is."""
    scene = pylmc.load("box", width=64, height=64)
    metal = RoughConductor(alpha, 0.7)
    shapes = [s if s.emission else Shape(s.mesh, metal, name=s.name) for s in scene.shapes]
    return Scene(scene.camera, [*shapes, Shape(_panel(), Diffuse(0.7), name="panel")], scene.lights, scene.portals)


def _panel() -> tuple[np.ndarray, list[list[int]]]:
    """A diffuse panel in the back, so that every roughness has paths of more than one lobe."""
    return np.array([[0.2, 0.2, 0.02], [0.8, 0.2, 0.02], [0.8, 0.8, 0.02], [0.2, 0.8, 0.02]]), [[0, 1, 2], [0, 2, 3]]


def measure_unit_jacobian(device: Any = None) -> list[dict[str, float]]:
    """A row for each roughness: the bias of ``orthographic-unit``, and the same figure for the exact chart as its noise."""
    rows = []
    for alpha in ROUGHNESS:
        scene = glossy_box(alpha)
        counts = {}
        for chart in ("orthographic", "orthographic-unit"):
            sampler = Sampler(
                scene,
                device=device,
                chart=chart,
                coordinates="deviation",
                large_steps=0.0,
                max_depth=3,
                step_length=(0.3, 1.0),
                even=False,
            )
            counts[chart] = [_film_cells(sampler, seed) for seed in range(RUNS)]
        truth = np.mean(counts["orthographic"], axis=0)
        half = np.mean(counts["orthographic"][RUNS // 2 :], axis=0)
        rows.append(
            {
                "alpha": alpha,
                "unit": _deviation(counts["orthographic-unit"], truth),
                "exact": _deviation(counts["orthographic"][: RUNS // 2], half),
            }
        )
        print(f"roughness {alpha:g}: unit Jacobian {rows[-1]['unit']:.3f}, exact {rows[-1]['exact']:.3f}", flush=True)
    return rows


def _film_cells(sampler: Sampler, seed: int) -> np.ndarray:
    """Where on the film the chains are in the second half of the steps: shares of the cells."""
    sampler.init(seed=seed, chains=CHAINS)
    total = np.zeros((CELLS, CELLS))
    for part in range(16):
        sampler.step(STEPS // 16)
        if part >= 8:
            at = np.clip((sampler.counters().trace * CELLS).astype(int), 0, CELLS - 1)
            np.add.at(total, (at[:, 1], at[:, 0]), 1)
    return total / total.sum()


def _deviation(shares: list[np.ndarray], truth: np.ndarray) -> float:
    filled = truth > 0.2 / CELLS**2
    return float(np.sqrt(np.mean((np.mean(shares, axis=0)[filled] / truth[filled] - 1) ** 2)))
