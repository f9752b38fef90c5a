"""Lights without area against closed forms: a diffuse floor under each, drawn by every integrator."""

from __future__ import annotations

import numpy as np
import pytest
from studies.closed_forms import pixel_means
from studies.comparison.evidence import confirm
from studies.comparison.verdict import judge
from studies.known import INTEGRATORS, Array, hits, runs_of

from pylmc.scene import Camera, Diffuse, DirectionalLight, Light, Portal, Scene, Shape, SpotLight
from pylmc.scene.builtin._meshes import rectangle

REFLECTANCE, INTENSITY = np.array([0.8, 0.5, 0.2]), np.array([3.0, 4.0, 5.0])
CAMERA = Camera((0.5, 2.0, 2.5), (0, 0, -0.3), fov=50, width=18, height=12)
SPOT = SpotLight((0.3, 2.0, -0.2), (0.1, -1.0, 0.2), INTENSITY, 10, 30)
LIGHTS: dict[str, list[Light]] = {
    "spot": [SPOT],
    "spot-with-a-hard-rim": [SpotLight((0.0, 2.0, 0.0), (0.0, -2.0, 0.0), INTENSITY, 22, 22)],
    "spot-wider-than-half": [SpotLight((-0.2, 1.0, 0.1), (0.0, -1.0, 0.0), INTENSITY, 90, 160)],
    "directional-and-spot": [DirectionalLight((0.3, -1.0, 0.2), INTENSITY / 10), SPOT],
}
# aimed at by the light, off its axis: the density of its draws is then a mixture
PORTAL = Portal((0.1, 0.8, 0.2), (0.1, 1.0, 0.0), (1, 0, 0), (0.2, 0.1))
WRONG = 1.15  # the factor of a wrong answer that each must tell from the right one
CASES = [(name, portal) for name in LIGHTS for portal in (False, True)]


def irradiance(light: Light, at: Array) -> Array:
    """RGB on the floor (n, 3) by the definition of each light."""
    if isinstance(light, DirectionalLight):
        return np.broadcast_to(-light.direction[1] * np.array(light.irradiance), at.shape)
    assert isinstance(light, SpotLight)
    towards = at - light.position
    r = np.linalg.norm(towards, axis=-1)
    inner, outer = np.cos(np.radians([light.inner_angle, light.outer_angle]))
    c = towards @ light.direction / r
    share = np.clip((c - outer) / (inner - outer), 0, 1) ** 2 if inner > outer else (c >= outer).astype(float)
    return (share * -towards[:, 1] / r**3)[:, None] * light.intensity


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("name,portal", CASES)
def test_floor_under_a_light(name: str, portal: bool, integrator: str) -> None:
    """rho / pi times the irradiance, pixel by pixel; a brighter light is seen to be another."""
    floor = Shape(rectangle((-20, 0, -20), (0, 0, 40), (40, 0, 0)), Diffuse(REFLECTANCE))
    scene = Scene(CAMERA, [floor], LIGHTS[name], portals=[PORTAL] if portal else ())

    def radiance(directions: Array) -> Array:
        at = hits(CAMERA, directions, 1, 0.0)
        return sum(irradiance(light, at) for light in LIGHTS[name]) * REFLECTANCE / np.pi

    runs, known = runs_of(scene, 2, integrator, work=1), pixel_means(CAMERA, radiance, nodes=40)
    confirm(judge(runs, known, 3 * len(CASES)), f"lights/{name}-{integrator}{'-aimed' * portal}")
    assert not judge(runs, WRONG * known, 3 * len(CASES)).passed
