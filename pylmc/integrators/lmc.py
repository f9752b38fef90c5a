"""integrator="lmc": constraint-preconditioned Markov chains over light paths."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyopencl as cl

from ..colour import LUMINANCE
from ..picture.estimators import Estimator
from ..sampling.chains import STEPS_PER_LAUNCH
from ..sampling.films import places
from ..sampling.mean_error import mean_variance
from ..sampling.traces import Trace
from .integrator import Integrator

CHAINS_CPU, CHAINS_GPU = 4096, 65536


class LangevinMonteCarlo(Integrator):
    """Runs a Sampler's chains and turns its films and counters into a picture, its error, and diagnostics."""

    unit = "mutations"

    def prepare(self, seed: int, quick: bool, candidates: int | None = None) -> None:
        gpu = self.sampler.device_scene.device.type & cl.device_type.GPU
        chosen = self.sampler.settings
        candidates = candidates or chosen.candidates or (1 << 16 if quick else 1 << 18)
        self.sampler.init(seed, chosen.chains or (CHAINS_GPU if gpu else CHAINS_CPU), candidates)
        self.traces = [Trace(group.chains) for group in self.sampler.groups]

    def launch(self) -> None:
        self.sampler.step(STEPS_PER_LAUNCH)
        self.done += STEPS_PER_LAUNCH * self.sampler.chains
        counters = self.sampler.counters()
        self.rays += counters.rays
        self.not_finite += counters.not_finite
        for trace, group in zip(self.traces, self.sampler.groups, strict=True):
            trace.add(counters.trace[group.first : group.first + group.chains])

    def estimators(self) -> list[Estimator]:
        return self.sampler.estimators()

    def variance(self) -> np.ndarray | None:
        found = super().variance()
        if found is None:
            return None
        groups, state = (*self.sampler.groups, *self.sampler.dark_groups), self.sampler.state
        placed = places((*state.groups, *state.dark), self.sampler.film.slots)
        b = placed.together(np.array([group.b for group in groups]))
        errors = np.sqrt(placed.together(np.array([0.0 if group.streams else group.b_error**2 for group in groups])))
        for estimator, relative in zip(self.estimators(), errors / np.maximum(b, np.finfo(float).tiny), strict=True):
            # besides the splats' own noise, that of the normalisation, which all batches share
            found = found + (relative * (estimator.read() @ LUMINANCE)) ** 2
        return found

    def mean_error(self) -> float | None:
        variance = mean_variance(self.sampler.state)
        return None if variance is None else self._radiance(np.sqrt(variance))

    def note(self) -> dict[str, str]:
        chains, counted = self.sampler.chains, self.sampler.state.counted
        return {"acceptance": f"{counted.acceptance[:chains].sum() / max(counted.proposed[:chains].sum(), 1):.2f}"}

    def diagnostics(self) -> dict[str, Any]:
        groups, state = {}, self.sampler.state
        counts = (state.counted.proposed, state.counted.acceptance)
        proposed, acceptance = (state.by_group(count)[: len(state.groups)] for count in counts)
        total_ess, worst_rhat = 0.0, 1.0
        for i, group in enumerate(self.sampler.groups):
            rates = acceptance[i] / np.maximum(proposed[i], 1)
            kinds = {
                name: round(float(rate), 4)
                for name, rate, count in zip(self.sampler.device_scene.moves.columns(), rates, proposed[i], strict=True)
                if count > 0
            }
            entry: dict[str, Any] = {
                "chains": group.chains,
                "acceptance": kinds,
                "proposed": int(proposed[i].sum()),
                "b": self._radiance(group.b),
                "b_error": self._radiance(group.b_error),
            }
            mixed = self.traces[i].mixing()
            if mixed is not None:
                entry["ess"], entry["rhat"] = round(mixed[0], 1), round(mixed[1], 4)
                total_ess, worst_rhat = total_ess + mixed[0], max(worst_rhat, mixed[1])
            groups[group.name] = entry
        for group in self.sampler.dark_groups:
            errors = {"b": self._radiance(group.b), "b_error": self._radiance(group.b_error)}
            groups[group.name] = {"streams": group.chains, **errors}
        everyone = (*self.sampler.groups, *self.sampler.dark_groups)
        b = sum(group.b for group in everyone)
        error = float(np.sqrt(sum(group.b_error**2 for group in everyone)))
        return {
            "groups": groups,
            "groups_without_light": [group.name for group in self.sampler.dark_groups],  # as the start found them
            "b": self._radiance(b),
            "b_error": self._radiance(error),
            "acceptance": round(float(acceptance.sum() / max(proposed.sum(), 1)), 4),
            "ess": round(total_ess, 1),
            "rhat": round(worst_rhat, 4),
            "chains": self.sampler.chains,
            "rays": self.rays,
            "not_finite_rejected": self.not_finite,
        }

    def _radiance(self, value: float) -> float:
        return float(value * self.sampler.compiled.radiance_scale)
