"""integrator="lmc": constraint-preconditioned Markov chains over light paths."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyopencl as cl

from ..colour import LUMINANCE
from ..picture.statistics import BatchMeans
from ..sampling.chains import STEPS_PER_LAUNCH
from ..sampling.diagnostics import mixing
from ..sampling.sampler import Sampler

CHAINS_CPU, CHAINS_GPU = 4096, 65536


class LangevinMonteCarlo:
    """Runs a Sampler's chains and turns its films and counters into a picture, its error, and diagnostics."""

    unit = "mutations"

    def __init__(self, sampler: Sampler) -> None:
        self.sampler = sampler
        self.done = 0
        self.rays = self.not_finite = 0

    @property
    def seconds(self) -> dict[str, float]:
        return self.sampler.seconds

    def prepare(self, seed: int, quick: bool, candidates: int | None = None) -> None:
        gpu = self.sampler.device_scene.device.type & cl.device_type.GPU
        chosen = self.sampler.settings
        candidates = candidates or chosen.candidates or (1 << 16 if quick else 1 << 18)
        self.sampler.init(seed, chosen.chains or (CHAINS_GPU if gpu else CHAINS_CPU), candidates)
        depth = self.sampler.settings.max_depth
        self.proposed = np.zeros((len(self.sampler.groups), depth + 1))
        self.acceptance = np.zeros_like(self.proposed)
        self.traces: list[list[np.ndarray]] = [[] for _ in self.sampler.groups]
        self.batches = [BatchMeans() for _ in self.sampler.groups]
        self._last = [
            (np.zeros((self.sampler.scene.camera.height, self.sampler.scene.camera.width)), 0) for _ in self.sampler.groups
        ]

    def advance(self) -> None:
        self.sampler.step(STEPS_PER_LAUNCH)
        self.done += STEPS_PER_LAUNCH * self.sampler.chains
        counters = self.sampler.counters()
        self.rays += counters.rays
        self.not_finite += counters.not_finite
        for i, group in enumerate(self.sampler.groups):
            part = slice(group.first, group.first + group.chains)
            self.proposed[i] += counters.proposed[part].sum(axis=0)
            self.acceptance[i] += counters.acceptance[part].sum(axis=0, dtype=np.float64)
            self.traces[i].append(counters.trace[part])

    def end_batch(self) -> None:
        for i, group in enumerate(self.sampler.groups):
            splats, work = self.sampler.film.read(i) @ LUMINANCE, group.steps * group.chains
            before, before_work = self._last[i]
            if work > before_work:
                self.batches[i].add((splats - before) / (work - before_work), work - before_work)
                self._last[i] = (splats, work)

    def image(self) -> np.ndarray:
        return self.sampler.image()

    def variance(self) -> np.ndarray | None:
        total = np.zeros(1)
        pixels = self.sampler.film_pixels * self.sampler.compiled.radiance_scale
        for batch, (splats, work), group in zip(self.batches, self._last, self.sampler.groups, strict=True):
            spread = batch.variance_of_mean()
            if spread is None:
                return None
            # the group's own noise, and that of its normalisation
            total = total + (group.b * pixels) ** 2 * spread + (group.b_error * pixels * splats / max(work, 1)) ** 2
        return total

    def note(self) -> dict[str, str]:
        return {"acceptance": f"{self.acceptance.sum() / max(self.proposed.sum(), 1):.2f}"}

    def diagnostics(self) -> dict[str, Any]:
        groups = {}
        total_ess, worst_rhat = 0.0, 1.0
        for i, group in enumerate(self.sampler.groups):
            rates = self.acceptance[i] / np.maximum(self.proposed[i], 1)
            kinds = {
                "large" if m == 0 else f"small, first {m} directions": round(float(rates[m]), 4)
                for m in range(len(rates))
                if self.proposed[i, m] > 0
            }
            entry: dict[str, Any] = {
                "chains": group.chains,
                "acceptance": kinds,
                "proposed": int(self.proposed[i].sum()),
                "b": self._radiance(group.b),
                "b_error": self._radiance(group.b_error),
            }
            mixed = mixing(np.stack(self.traces[i], axis=1)) if self.traces[i] else None
            if mixed is not None:
                entry["ess"], entry["rhat"] = round(mixed[0], 1), round(mixed[1], 4)
                total_ess, worst_rhat = total_ess + mixed[0], max(worst_rhat, mixed[1])
            groups[group.name] = entry
        b = sum(group.b for group in self.sampler.groups)
        error = float(np.sqrt(sum(group.b_error**2 for group in self.sampler.groups)))
        return {
            "groups": groups,
            "groups_without_light": self.sampler.dark_groups,
            "b": self._radiance(b),
            "b_error": self._radiance(error),
            "acceptance": round(float(self.acceptance.sum() / max(self.proposed.sum(), 1)), 4),
            "ess": round(total_ess, 1),
            "rhat": round(worst_rhat, 4),
            "chains": self.sampler.chains,
            "rays": self.rays,
            "not_finite_rejected": self.not_finite,
        }

    def _radiance(self, value: float) -> float:
        return float(value * self.sampler.compiled.radiance_scale)
