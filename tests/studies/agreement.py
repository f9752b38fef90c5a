"""Films of one scene by path length, from each integrator, and what tells whether they agree.

Families of tests are held together by Šidák's correction: ALPHA is the chance that a family of right results fails.
"""

from __future__ import annotations

import numpy as np
from oracle.paths import CONNECT
from scipy import stats
from scipy.ndimage import uniform_filter

import pylmc
from pylmc.colour import LUMINANCE
from pylmc.device.arrays import Records
from pylmc.integrators.bdpt import Bidirectional
from pylmc.sampling.chains import STEPS_PER_LAUNCH
from pylmc.sampling.sampler import Sampler
from pylmc.scene import Scene

from .probes import spotlit_scene, sunlit_scene, textured_scene, varnished_scene

ALPHA = 1e-4
SCENES: dict[str, tuple[str, dict[str, float]]] = {
    "box": ("box", {}),
    "caustic": ("caustic", {"alpha": 0.2}),
    "glints": ("glints", {"size": 0.2, "alpha": 0.2}),
    "keyhole": ("keyhole", {"hole": 0.4, "alpha": 0.2}),
    "textured": ("", {}),
    "varnished": ("", {}),
    "spotlit": ("", {}),
    "sunlit": ("", {}),
}
MADE = {"textured": textured_scene, "varnished": varnished_scene, "spotlit": spotlit_scene, "sunlit": sunlit_scene}


def scene_of(name: str) -> Scene:
    builtin, parameters = SCENES[name]
    return pylmc.load(builtin, **parameters).with_size(24, 18) if builtin else MADE[name]()


def sidak(alpha: float, tests: int) -> float:
    """The level of each of ``tests`` tests that together fail with probability ``alpha``."""
    return -np.expm1(np.log1p(-alpha) / tests)


# --- densities -----------------------------------------------------------------------------------------------------


def bdpt_batches(name: str, seeds: int, launches: int, depth: int) -> dict[tuple[int, int], np.ndarray]:
    """Luminance films (batches, height, width) of each (length, ending), one batch a launch."""
    out: dict[tuple[int, int], list[np.ndarray]] = {}
    sampler = Sampler(scene_of(name), max_depth=depth)
    for seed in range(seeds):
        worker = Bidirectional(sampler)
        worker.prepare(100 + seed, True)
        before = [np.zeros(worker.film.shape)] * len(worker.groups)
        for _ in range(launches):
            worker.advance()
            now = [worker.film.read(slot) for slot in range(len(worker.groups))]
            for group, film, last, scale in zip(worker.groups, now, before, worker.scales, strict=True):
                share = sampler.film_pixels / (scale * group.chains * STEPS_PER_LAUNCH)
                out.setdefault((group.length, group.ending), []).append((film - last) @ LUMINANCE * share)
            before = now
    return {key: np.stack(films) for key, films in out.items()}


def path_batches(name: str, ending: int, batches: int, passes: int, depth: int) -> np.ndarray:
    """Luminance films (batches, depth, height, width) of the path tracer by path length, for one kind of light.

    A pass of depth k repeats that of depth k - 1 and adds the paths of length k: the same random numbers.
    """
    scene = scene_of(name)
    sampler = Sampler(scene, max_depth=depth)
    device, pixels = sampler.device_scene, sampler.film_pixels
    only = {"HAS_EMITTERS": 0} if ending == CONNECT else {"HAS_LIGHTS": 0}
    kernel = device.kernel("entry/path_tracer.cl", "render_paths", NUM_TARGETS=0, **only)
    counters = Records(device, "ChainCounters", pixels)
    out = np.zeros((batches, depth, scene.camera.height, scene.camera.width))
    for batch in range(batches):
        before = np.zeros((scene.camera.height, scene.camera.width, 3))
        for k in range(1, depth + 1):
            film = device.zero_reals(3 * pixels)
            device.launch(
                kernel,
                pixels,
                np.uint32(900 + batch % 4),
                np.uint64(batch * passes),
                np.int32(passes),
                np.int32(k),
                np.int32(0),
                np.int32(pixels),
                counters.buffer,
                film,
            )
            now = device.read_reals(film, before.shape).astype(float) / passes
            out[batch, k - 1] = (now - before) @ LUMINANCE
            before = now
    return out


def same_means(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Two-sided p-values that films a and b (batches first) have the same mean, pixel by pixel.

    A pixel whose rare bright samples happened to stay away shows too small a variance of its own (light's distribution
    is skewed); it is given that of its 5 x 5 neighbourhood where that is larger.
    """
    variance = a.var(axis=0, ddof=1) / len(a) + b.var(axis=0, ddof=1) / len(b)
    if variance.ndim == 2:
        variance = np.maximum(variance, uniform_filter(variance, (5, 5), mode="nearest"))
    difference = np.abs(a.mean(axis=0) - b.mean(axis=0))
    lit = variance > 0
    t = np.divide(difference, np.sqrt(variance), where=lit, out=np.where(difference > 0, np.inf, 0.0))
    return 2 * stats.t.sf(t, len(a) + len(b) - 2)
