"""Pictures of scenes whose radiance is known in closed form: runs by every integrator, and where the camera's rays go."""

from __future__ import annotations

import numpy as np

from pylmc.scene import Camera, Scene

from .comparison.to_pylmc import bdpt_runs, lmc_runs, path_runs

Array = np.ndarray
RUNS = 24
# the factor of a wrong answer that each must tell from the right one: chains are the noisiest in scenes as easy as these
INTEGRATORS = {"lmc": 1.06, "path": 1.02, "bdpt": 1.02}


def runs_of(scene: Scene, depth: int, integrator: str, work: int = 1) -> Array:
    """Independent pictures (runs, height, width, 3); ``work`` multiplies the samples."""
    if integrator == "lmc":
        return lmc_runs(scene, depth, RUNS, 64 * work)
    if integrator == "path":
        return path_runs(scene, depth, RUNS, 32 * work)
    return bdpt_runs(scene, depth, 16, work)


def hits(camera: Camera, directions: Array, axis: int, at: float) -> Array:
    """Where rays from the camera meet the plane coordinate[axis] = at."""
    return camera.origin + directions * ((at - camera.origin[axis]) / directions[:, axis])[:, None]
