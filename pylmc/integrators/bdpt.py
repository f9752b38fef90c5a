"""integrator="bdpt": the bidirectional independent sampler alone, a baseline without chains."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyopencl as cl

from ..device import tables
from ..device.arrays import Records
from ..picture.estimators import Estimator
from ..sampling.chains import STEPS_PER_LAUNCH
from ..sampling.films import film_for, places
from ..sampling.groups import Group
from ..sampling.mean_error import variance_of_mean
from .integrator import Integrator

STREAMS_CPU, STREAMS_GPU = 4096, 65536


class Bidirectional(Integrator):
    """Shares its streams of samples among path lengths in proportion to the spread of their weights, from a pilot."""

    unit = "samples"

    def prepare(self, seed: int, quick: bool) -> None:
        device, camera = self.sampler.device_scene, self.sampler.scene.camera
        self.seed = seed
        self.groups: list[Group] = self.sampler.weigh(1 << 14 if quick else 1 << 16, seed)
        streams = STREAMS_GPU if device.device.type & cl.device_type.GPU else STREAMS_CPU
        spreads = np.array([np.sqrt(group.weight_square_sum / group.weighed) for group in self.groups])
        parts = []
        first, most = 0, max(group.b for group in self.groups)
        # a group that the pilot found empty may still hold light: it keeps a few streams, or the picture were biased
        floor = 0.01 * spreads.max()
        shares = np.maximum(spreads, floor)
        for group, share in zip(self.groups, shares / shares.sum(), strict=True):
            group.first, group.chains = first, max(round(float(streams * share)), 8)
            part = np.zeros(group.chains, tables.CHAIN_START)
            part["length"], part["ending"], part["slot"] = group.length, group.ending, group.slot
            group.unit, group.streams = max(group.b, 1e-6 * most), True
            part["scale"] = 1 / group.unit
            parts.append(part)
            first += group.chains
        self.streams = first
        self.scales = np.array([part["scale"][0] for part in parts], dtype=np.float64)
        self._table = Records.of(device, "ChainStart", np.concatenate(parts))
        self._counters, self._splatted = Records(device, "ChainCounters", first), np.zeros(first)
        self.film = film_for(device, len(self.groups), camera.height, camera.width)
        self.places = places(self.groups, self.film.slots)
        self._places = self.places.table(device, self.groups)
        self._kernel = device.kernel("entry/bdpt.cl", "render_independent")
        with device.compiling():
            self._launch(0)

    def _launch(self, steps: int) -> None:
        self.sampler.device_scene.launch(
            self._kernel,
            self.streams,
            np.uint32(self.seed),
            np.uint64(self.launches * STEPS_PER_LAUNCH),
            np.int32(steps),
            np.uint32(self.streams),
            np.uint32(0),
            self._table.buffer,
            self._places.buffer,
            self._counters.buffer,
            self.film.buffer,
            np.int32(self.sampler.film_pixels),
        )

    def launch(self) -> None:
        self._launch(STEPS_PER_LAUNCH)
        counts = self._counters.read()
        self._counters.clear()
        self._splatted += counts["splatted"]
        self.rays += int(counts["rays"].sum(dtype=np.int64))
        self.not_finite += int(counts["not_finite"].sum(dtype=np.int64))
        self.done += self.streams * STEPS_PER_LAUNCH

    def estimators(self) -> list[Estimator]:
        scale = self.sampler.film_pixels * self.sampler.compiled.radiance_scale
        return self.places.estimators(self.film, self.groups, scale, STEPS_PER_LAUNCH * self.launches)

    def mean_error(self) -> float | None:
        if not self.launches:
            return None
        streams = np.split(self._splatted, np.cumsum([group.chains for group in self.groups])[:-1])
        steps = STEPS_PER_LAUNCH * self.launches
        parts = (variance_of_mean(some) / (scale * steps) ** 2 for some, scale in zip(streams, self.scales, strict=True))
        return float(np.sqrt(sum(parts))) * self.sampler.compiled.radiance_scale

    def diagnostics(self) -> dict[str, Any]:
        scale = self.sampler.compiled.radiance_scale
        return {
            "groups": {
                group.name: {"streams": group.chains, "b": group.b * scale, "b_error": group.b_error * scale}
                for group in self.groups
            },
            "b": scale * sum(group.b for group in self.groups),
            "b_error": scale * float(np.sqrt(sum(group.b_error**2 for group in self.groups))),
            "rays": self.rays,
            "not_finite_rejected": self.not_finite,
        }
