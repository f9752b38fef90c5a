"""Pictures with a closed form: pylmc's integrators against them, pixel by pixel, with errors from independent runs.

Levels are those of ``comparison/verdict.py``: a family of tests in which nothing is wrong fails with probability ALPHA. Every
family has a negative control. What fails leaves its pictures in out/comparison.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from studies.closed_forms import ggx_albedo, pixel_means
from studies.comparison.evidence import confirm
from studies.comparison.to_pylmc import path_runs
from studies.comparison.verdict import judge
from studies.known import INTEGRATORS, RUNS, Array, hits, runs_of

from pylmc.sampling.sampler import Sampler
from pylmc.scene import Camera, Diffuse, Material, Plastic, PointLight, RoughConductor, RoughDielectric, Scene, Shape
from pylmc.scene.builtin._meshes import box, rectangle

# --- a point light over a diffuse plane -------------------------------------------------------------------------------

REFLECTANCE, INTENSITY, LIGHT = np.array([0.8, 0.5, 0.2]), np.array([3.0, 4.0, 5.0]), np.array([0.4, 1.5, -0.3])


def plane_scene() -> Scene:
    floor = rectangle((-20, 0, -20), (0, 0, 40), (40, 0, 0))
    camera = Camera((0.5, 2.0, 2.5), (0, 0, -0.3), fov=50, width=18, height=12)
    return Scene(camera, [Shape(floor, Diffuse(REFLECTANCE))], [PointLight(LIGHT, INTENSITY)])


def plane_radiance(camera: Camera, reflectance: Array = REFLECTANCE) -> Array:
    """ρ / π times I cos θ / d², averaged over each pixel."""

    def radiance(directions: Array) -> Array:
        towards = LIGHT - hits(camera, directions, 1, 0.0)
        distance2 = (towards**2).sum(axis=1)
        return (towards[:, 1] / distance2**1.5)[:, None] * reflectance * INTENSITY / np.pi

    return pixel_means(camera, radiance)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_point_light_over_a_plane(integrator: str) -> None:
    scene = plane_scene()
    runs = runs_of(scene, 3, integrator)
    confirm(judge(runs, plane_radiance(scene.camera), len(INTEGRATORS)), f"plane/{integrator}")
    wrong = plane_radiance(scene.camera, INTEGRATORS[integrator] * REFLECTANCE)
    assert not judge(runs, wrong, len(INTEGRATORS)).passed


# --- a closed diffuse enclosure ---------------------------------------------------------------------------------------

ALBEDO, EMITTED = np.array([0.5, 0.3, 0.1]), np.array([1.0, 2.0, 0.5])
LONGEST = 6


def enclosure(albedo: Array = ALBEDO, width: int = 18, height: int = 12) -> Scene:
    """A box whose walls all emit and reflect; the camera is inside."""
    vertices, faces = box((0.1, -0.2, 0.3), (2.0, 2.5, 3.0))
    camera = Camera((0.6, 0.3, 1.2), (-0.3, -0.4, -0.5), fov=75, width=width, height=height)
    return Scene(camera, [Shape((vertices, faces[:, ::-1]), Diffuse(albedo), emission=EMITTED)])


def partial_sum(depth: int, albedo: Array = ALBEDO) -> Array:
    """E (1 + ρ + ... + ρ^(d-1)), exact for paths of at most d segments."""
    return EMITTED * (albedo ** np.arange(depth)[:, None]).sum(axis=0)


def everywhere(colour: Array, runs: Array) -> Array:
    """One colour in every pixel of a film like those of ``runs``."""
    return np.broadcast_to(colour, runs.shape[1:])


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_enclosure(integrator: str) -> None:
    """The partial sum to the longest path, the same from every pixel."""
    runs = runs_of(enclosure(), LONGEST, integrator)
    confirm(judge(runs, everywhere(partial_sum(LONGEST), runs), len(INTEGRATORS)), f"enclosure/{integrator}")
    for wrong in (partial_sum(LONGEST, INTEGRATORS[integrator] * ALBEDO), partial_sum(LONGEST - 1)):
        assert not judge(runs, everywhere(wrong, runs), len(INTEGRATORS)).passed


def test_enclosure_at_its_limit() -> None:
    """E / (1 - ρ): of the brightest channel the paths of up to twelve segments leave out ρ^12 = 5e-7. Roulette is on."""
    albedo = np.array([0.3, 0.2, 0.1])
    runs = path_runs(enclosure(albedo), 12, RUNS, 32)
    confirm(judge(runs, everywhere(EMITTED / (1 - albedo), runs)), "enclosure/limit")


def test_enclosure_by_path_length() -> None:
    """Each length k by itself: chains of k segments bring E ρ^(k-1). The film is small, for the last have few chains."""
    sampler = Sampler(enclosure(width=6, height=6), max_depth=LONGEST)
    films: dict[int, list[Array]] = {}
    for seed in range(RUNS):
        sampler.init(seed=300 + seed, chains=1024, candidates=1 << 13)
        sampler.step(64)
        sampler.counters()
        for slot, group in enumerate(sampler.groups):
            share = group.b * sampler.film_pixels / (group.steps * group.chains) * sampler.compiled.radiance_scale
            films.setdefault(group.length, []).append(sampler.film.read(slot) * share)
    assert sorted(films) == list(range(1, LONGEST + 1))
    for length, pictures in films.items():
        runs = np.stack(pictures)
        confirm(judge(runs, everywhere(EMITTED * ALBEDO ** (length - 1), runs), LONGEST), f"enclosure/length-{length}")


# --- lobes in a white furnace -----------------------------------------------------------------------------------------

LOBES: dict[str, Material] = {
    "diffuse": Diffuse(REFLECTANCE),
    "conductor": RoughConductor(0.3, REFLECTANCE),
    "conductor, separable masking": RoughConductor(0.8, REFLECTANCE, "separable"),
    "dielectric, from outside": RoughDielectric(0.4, 1.5),
    "dielectric, from inside": RoughDielectric(0.4, 1 / 1.5, "separable"),
    "plastic": Plastic(REFLECTANCE, 0.3, 1.5),
}
STRIP = 6  # columns of the film that show one material
FURNACE = len(LOBES) * len(INTEGRATORS)


def furnace_camera() -> Camera:
    """Sees a floor from 53 to 9 degrees above it."""
    return Camera((0, 0.9, 3.4), (0, 0, 1.9), fov=44, width=STRIP * len(LOBES), height=18)


@cache
def furnace() -> Scene:
    """A black closed box whose walls have radiance one, and in it a floor of strips that are seen as columns of the film."""
    vertices, faces = box((0, 0, 0), (16, 4, 10))
    shapes = [Shape((vertices, faces[:, ::-1]), Diffuse(0.0), emission=1.0)]
    camera = furnace_camera()
    right, up, forward = camera.axes()
    half = np.tan(np.radians(camera.fov) / 2)
    edges = np.linspace(-1, 1, len(LOBES) + 1)
    edges[[0, -1]] *= 1.02
    for left, beyond, material in zip(edges[:-1], edges[1:], LOBES.values(), strict=True):
        corners = np.array([[left, 1.02], [left, -1.02], [beyond, -1.02], [beyond, 1.02]]) * half
        corners[:, 0] *= camera.width / camera.height
        floor = hits(camera, forward + corners[:, :1] * right + corners[:, 1:] * up, 1, 0.0)
        shapes.append(Shape((floor, [[0, 1, 2], [0, 2, 3]]), material))
    return Scene(camera, shapes)


@cache
def furnace_runs(integrator: str) -> Array:
    return runs_of(furnace(), 2, integrator, work=6 if integrator == "lmc" else 3)


def strip(name: str) -> slice:
    first = STRIP * list(LOBES).index(name)
    return slice(first, first + STRIP)


def furnace_radiance(name: str, masking: str = "", compress: bool = True) -> Array:
    """The lobe's albedo where the camera's rays meet its strip.

    A dielectric's convention: radiance that comes out of a medium of index n_t, refracted towards a camera in index n_i, is
    multiplied by (n_i / n_t)² = 1 / η². From surroundings of radiance one the pixel so gets R + T / η², with R and T the
    powers, reflected and refracted, of a beam sent from the camera. ``compress=False`` leaves η² out, wrongly.
    """
    material = LOBES[name]
    grid = np.linspace(0.1, 1.0, 91)
    colour, whole = np.array(getattr(material, "reflectance", np.ones(3))), np.ones((len(grid), 1))
    if isinstance(material, Plastic):
        # what enters the coat is spread by the base and leaves by the coat again; of diffuse light inside, the coat throws
        # back what its inner side reflects, whose mean is taken as in the material
        outside = ggx_albedo(grid, material.alpha, material.ior, False)
        coarse = np.maximum(np.linspace(0, 1, 64), 1e-3)
        thrown_back = 2 * np.mean(ggx_albedo(coarse, material.alpha, 1 / material.ior, False).reflected * coarse)
        nodes, weight = np.polynomial.legendre.leggauss(32)
        mu = (nodes + 1) / 2
        leaves = (ggx_albedo(mu, material.alpha, material.ior, False).refracted * mu * weight).sum()
        base = outside.refracted * leaves / (material.ior**2 * (1 - thrown_back))
        whole, colour = outside.reflected[:, None] + base[:, None] * colour, 1.0
    elif not isinstance(material, Diffuse):
        eta = getattr(material, "ior", None)
        albedo = ggx_albedo(grid, material.alpha, eta, (masking or material.masking) == "separable")
        whole = (albedo.reflected + albedo.refracted / ((eta or 1.0) ** 2 if compress else 1.0))[:, None]

    def radiance(directions: Array) -> Array:
        cosine = -directions[:, 1]
        assert cosine.min() > grid[0]
        return np.stack([np.interp(cosine, grid, channel) for channel in (whole * colour).T], axis=-1)

    return pixel_means(furnace_camera(), radiance)[:, strip(name)]


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("name", LOBES)
def test_lobe_in_a_furnace(name: str, integrator: str) -> None:
    """What a lobe sends to the camera from surroundings of radiance one: its albedo, by angle."""
    runs, expected = furnace_runs(integrator)[:, :, strip(name)], furnace_radiance(name)
    confirm(judge(runs, expected, FURNACE), f"furnace/{integrator}-{name.replace(', ', '-').replace(' ', '-')}")
    assert not judge(runs, INTEGRATORS[integrator] * expected, FURNACE).passed


def test_furnace_tells_conventions_apart() -> None:
    """The other masking term, and a dielectric whose refracted part is not divided by eta squared, are seen."""
    runs = furnace_runs("path")
    name = "conductor, separable masking"
    assert not judge(runs[:, :, strip(name)], furnace_radiance(name, "height-correlated"), FURNACE).passed
    for name in ("dielectric, from outside", "dielectric, from inside"):
        assert not judge(runs[:, :, strip(name)], furnace_radiance(name, compress=False), FURNACE).passed


@pytest.mark.parametrize("eta", [1.5, 1 / 1.5, 1.33, 3.0])
@pytest.mark.parametrize("alpha", [0.02, 0.2, 0.6, 1.0])
@pytest.mark.parametrize("separable", [False, True])
def test_albedos_never_exceed_one(alpha: float, eta: float, separable: bool) -> None:
    """Reflected and refracted power together: at most one, and nearly one where the facets are nearly flat."""
    cosine = np.array([0.1, 0.3, 0.6, 0.9, 1.0])
    albedo = ggx_albedo(cosine, alpha, eta, separable)
    mirror = ggx_albedo(cosine, alpha, None, separable).reflected
    total = albedo.reflected + albedo.refracted
    assert np.all(total <= 1 + 1e-4) and np.all(mirror <= 1 + 1e-4)
    if alpha == 0.02:
        assert np.all(total > 0.97) and np.all(mirror > 0.97)
