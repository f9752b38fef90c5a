"""integrator="path": a unidirectional path tracer, the baseline that every renderer has."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from ..colour import LUMINANCE
from ..device.arrays import Records
from ..picture.statistics import BatchMeans
from ..sampling.sampler import Sampler

PIXELS_PER_LAUNCH = 1 << 18  # keeps a launch short on large films, for the progress bar and Ctrl-C


class PathTracer:
    """One sample per pixel and pass; the picture is the mean over whole passes."""

    unit = "samples"

    def __init__(self, sampler: Sampler) -> None:
        self.sampler = sampler
        self.done = self.rays = self.passes = self.not_finite = 0

    @property
    def seconds(self) -> dict[str, float]:
        return self.sampler.seconds

    def prepare(self, seed: int, quick: bool) -> None:
        device = self.sampler.device_scene
        self.seed = seed
        self.sampler.weigh(1 << 12 if quick else 1 << 14, seed)  # refuses a scene in which no light path can be found
        self._film = device.zero_reals(self.sampler.film_pixels * 3)
        streams = min(self.sampler.film_pixels, PIXELS_PER_LAUNCH)
        self._counters = Records(device, "ChainCounters", streams)
        # a plain path tracer does not aim at holes
        self._kernel = device.kernel("entry/path_tracer.cl", "render_paths", NUM_TARGETS=0)
        with device.compiling():
            self._launch(0, 1, 0)
        self.batches = BatchMeans()
        self._sum = np.zeros((self.sampler.scene.camera.height, self.sampler.scene.camera.width, 3))
        self._last, self._last_passes, self._pending = np.zeros(1), 0, 0

    def _launch(self, first: int, count: int, passes: int) -> None:
        self.sampler.device_scene.launch(
            self._kernel,
            count,
            np.uint32(self.seed),
            np.uint64(self.passes),
            np.int32(passes),
            np.int32(self.sampler.settings.max_depth),
            np.int32(first),
            np.int32(count),
            self._counters.buffer,
            self._film,
        )

    def advance(self) -> None:
        device = self.sampler.device_scene
        start = time.perf_counter()
        pixels = self.sampler.film_pixels
        for first in range(0, pixels, PIXELS_PER_LAUNCH):
            count = min(PIXELS_PER_LAUNCH, pixels - first)
            self._launch(first, count, 1)
        device.queue.finish()
        self.passes += 1
        self.done += pixels
        self._pending += 1
        if self._pending == 64:
            self._collect()
        self.seconds["run"] += time.perf_counter() - start

    def _collect(self) -> None:
        """Move the device's float32 sums to the host's float64 ones before they lose digits."""
        device = self.sampler.device_scene
        self._sum += device.read_reals(self._film, self._sum.shape)
        device.clear(self._film)
        counts = self._counters.read()
        self._counters.clear()
        self.rays += int(counts["rays"].sum(dtype=np.int64))
        self.not_finite += int(counts["not_finite"].sum(dtype=np.int64))
        self._pending = 0

    def end_batch(self) -> None:
        if self.passes > self._last_passes:
            self._collect()
            total = self._sum @ LUMINANCE * self.sampler.compiled.radiance_scale
            work = self.passes - self._last_passes
            self.batches.add((total - self._last) / work, work)
            self._last, self._last_passes = total, self.passes

    def image(self) -> np.ndarray:
        self._collect()
        return self._sum * (self.sampler.compiled.radiance_scale / max(self.passes, 1))

    def variance(self) -> np.ndarray | None:
        return self.batches.variance_of_mean()

    def note(self) -> dict[str, str]:
        return {"passes": str(self.passes)}

    def diagnostics(self) -> dict[str, Any]:
        return {"samples_per_pixel": self.passes, "rays": self.rays, "not_finite_rejected": self.not_finite}
