"""A description as a pylmc scene, and independent runs of pylmc's integrators on it."""

from __future__ import annotations

import numpy as np

from pylmc.integrators.bdpt import Bidirectional
from pylmc.integrators.path import PathTracer
from pylmc.sampling.sampler import Sampler
from pylmc.scene import Camera, Diffuse, PointLight, RoughConductor, RoughDielectric, Scene, Shape

from .description import Description, Glass, Matte, Metal

FIRST_SEED = 100  # of the runs; the same for every integrator, whose random numbers differ by purpose


def material(given: Matte | Metal | Glass, masking: str = "separable") -> Diffuse | RoughConductor | RoughDielectric:
    """pylmc's name for a material. ``masking`` other than the description's is for a negative control."""
    if isinstance(given, Matte):
        return Diffuse(given.reflectance)
    if isinstance(given, Metal):
        return RoughConductor(given.alpha, given.reflectance, masking)
    return RoughDielectric(given.alpha, given.ior, masking)


def pylmc_scene(description: Description, masking: str = "separable") -> Scene:
    """The description as a pylmc scene."""
    shapes = []
    for surface in description.surfaces:
        mesh = (surface.vertices, surface.faces)
        shapes.append(Shape(mesh, material(surface.material, masking), surface.emission, normals=surface.normals))
    view = description.view
    width, height = view.size
    camera = Camera(view.origin, view.target, view.up, view.fov, width, height)
    lights = [PointLight(point.position, point.intensity) for point in description.points]
    return Scene(camera, shapes, lights)


def lmc_runs(scene: Scene, depth: int, runs: int, steps: int, chains: int = 1024, candidates: int = 1 << 14) -> np.ndarray:
    """Pictures (runs, height, width, 3): ``steps`` steps of ``chains`` chains each, a seed and a start to every run."""
    sampler = Sampler(scene, max_depth=depth)
    pictures = []
    for seed in range(runs):
        sampler.init(seed=FIRST_SEED + seed, chains=chains, candidates=candidates)
        sampler.step(steps)
        sampler.counters()  # the large steps' weights refine b
        pictures.append(sampler.image())
    return np.stack(pictures)


def path_runs(scene: Scene, depth: int, runs: int, samples: int) -> np.ndarray:
    """Pictures (runs, height, width, 3) of ``samples`` samples per pixel each."""
    return _runs(PathTracer, scene, depth, runs, samples)


def bdpt_runs(scene: Scene, depth: int, runs: int, launches: int) -> np.ndarray:
    """Pictures (runs, height, width, 3) of ``launches`` launches of independent paths each."""
    return _runs(Bidirectional, scene, depth, runs, launches)


def _runs(kind: type, scene: Scene, depth: int, runs: int, launches: int) -> np.ndarray:
    sampler = Sampler(scene, max_depth=depth)
    pictures = []
    for seed in range(runs):
        worker = kind(sampler)
        worker.prepare(FIRST_SEED + seed, True)
        for _ in range(launches):
            worker.advance()
        pictures.append(worker.image())
    return np.stack(pictures)
