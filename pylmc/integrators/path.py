"""integrator="path": a unidirectional path tracer, the baseline that every renderer has."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..colour import LUMINANCE
from ..device.arrays import Records
from ..picture.estimators import Estimator
from ..picture.statistics import BatchMeans
from .integrator import Integrator

PIXELS_PER_LAUNCH = 1 << 18  # keeps a launch short on large films, for the progress bar and Ctrl-C


class _Sum:
    """A film on the host."""

    def __init__(self, height: int, width: int) -> None:
        self.sum = np.zeros((height, width, 3))

    def read(self) -> np.ndarray:
        return self.sum.copy()


class PathTracer(Integrator):
    """One sample per pixel and pass; the picture is the mean over whole passes."""

    unit = "samples"

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
        self.film = _Sum(self.sampler.scene.camera.height, self.sampler.scene.camera.width)
        self._means = BatchMeans()  # of passes' luminance: they are independent

    def _launch(self, first: int, count: int, passes: int) -> None:
        self.sampler.device_scene.launch(
            self._kernel,
            count,
            np.uint32(self.seed),
            np.uint64(self.launches),
            np.int32(passes),
            np.int32(self.sampler.settings.max_depth),
            np.int32(first),
            np.int32(count),
            self._counters.buffer,
            self._film,
        )

    def launch(self) -> None:
        device, pixels = self.sampler.device_scene, self.sampler.film_pixels
        for first in range(0, pixels, PIXELS_PER_LAUNCH):
            self._launch(first, min(PIXELS_PER_LAUNCH, pixels - first), 1)
        # a pass at a time: the device's float32 sums lose digits as they grow
        passed = device.read_reals(self._film, self.film.sum.shape)
        self.film.sum += passed
        self._means.add((passed @ LUMINANCE).mean(), 1)
        device.clear(self._film)
        counts = self._counters.read()
        self._counters.clear()
        self.rays += int(counts["rays"].sum(dtype=np.int64))
        self.not_finite += int(counts["not_finite"].sum(dtype=np.int64))
        self.done += pixels

    def estimators(self) -> list[Estimator]:
        return [Estimator("path", self.film, self.sampler.compiled.radiance_scale, self.launches)]

    def mean_error(self) -> float | None:
        variance = self._means.variance_of_mean()
        return None if variance is None else float(np.sqrt(variance)) * self.sampler.compiled.radiance_scale

    def note(self) -> dict[str, str]:
        return {"passes": str(self.launches)}

    def diagnostics(self) -> dict[str, Any]:
        return {"samples_per_pixel": self.launches, "rays": self.rays, "not_finite_rejected": self.not_finite}
