"""Surfaces that lie on each other: every integrator sees the same one there, whatever the shapes' order in the scene.

A lamp that is flush with a ceiling, given twice, and back to back with another, against closed forms; glass that is given
twice against the same glass once.
"""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from studies.closed_forms import pixel_means
from studies.comparison.evidence import confirm
from studies.comparison.to_pylmc import bdpt_runs, lmc_runs, path_runs
from studies.comparison.verdict import judge

from pylmc.sampling.compiled import compile_scene
from pylmc.scene import Camera, Diffuse, RoughDielectric, Scene, Shape
from pylmc.scene.builtin._meshes import box, rectangle

RUNS = {"path": (path_runs, 16), "bdpt": (bdpt_runs, 1), "lmc": (lmc_runs, 64)}
TURN = trimesh.transformations.rotation_matrix(0.7, [0.1, 0.5, 0.8])[:3, :3]
RADIANCE, ALBEDO, HEIGHT = np.array([10.0, 5.0, 2.0]), np.array([0.8, 0.5, 0.2]), 1.0
Array = np.ndarray
Mesh = tuple[Array, Array]
FAMILY = 2 * 2 * len(RUNS)  # pictures of lamps that are judged


def runs_of(scene: Scene, integrator: str, depth: int, work: int = 1) -> Array:
    draw, amount = RUNS[integrator]
    return draw(scene, depth, 16, amount * work)


def reversed_(mesh: Mesh) -> Mesh:
    return mesh[0], mesh[1][:, ::-1]


def lamp_scene(turn: Array, order: tuple[int, ...], at_lamp: bool) -> Scene:
    """A ceiling with a lamp in its plane, there twice, in other triangles too, and back to back with one that shines up."""
    lamp = rectangle((-0.4, HEIGHT, -0.3), (0.8, 0, 0), (0, 0, 0.6))
    other = lamp[0], np.array([[1, 2, 3], [1, 3, 0]])
    ceiling, floor = rectangle((-2, HEIGHT, -2), (4, 0, 0), (0, 0, 4)), rectangle((-2, 0, -2), (0, 0, 4), (4, 0, 0))
    given = [
        (ceiling, Diffuse(0.0), None),
        (lamp, Diffuse(0.3), RADIANCE),
        (other, Diffuse(0.3), RADIANCE),
        (reversed_(lamp), Diffuse(0.6), 3 * RADIANCE),
        (floor, Diffuse(ALBEDO), None),
        (reversed_(floor), Diffuse(0.0), None),
    ]
    shapes = [Shape((corners @ turn.T, faces), material, emission) for (corners, faces), material, emission in given]
    target = (0.05, HEIGHT, 0.02) if at_lamp else (0.1, 0, 0)
    camera = Camera(turn @ (0.2, 0.4, 0.6), turn @ target, up=turn @ (0, 1, 0), fov=12 if at_lamp else 60, width=12, height=8)
    return Scene(camera, [shapes[i] for i in order])


def floor_radiance(camera: Camera, turn: Array) -> Array:
    """ρ / π ∫ L cos² / r² over the lamp, seen in each pixel: the lamp and the floor are parallel."""
    at, weight = np.polynomial.legendre.leggauss(24)
    x, z = np.meshgrid(0.4 * at, 0.3 * at, indexing="ij")
    area = np.outer(0.4 * weight, 0.3 * weight)

    def radiance(directions: Array) -> Array:
        origin, v = camera.origin @ turn, directions @ turn
        point = origin - v * (origin[1] / v[:, 1])[:, None]
        distance2 = (point[:, 0, None, None] - x) ** 2 + (point[:, 2, None, None] - z) ** 2 + HEIGHT**2
        return (area * HEIGHT**2 / distance2**2).sum(axis=(1, 2))[:, None] * ALBEDO * RADIANCE / np.pi

    return pixel_means(camera, radiance)


@pytest.mark.parametrize(
    ("turn", "order"), [(np.eye(3), (0, 1, 2, 3, 4, 5)), (TURN, (5, 3, 4, 2, 0, 1))], ids=["level", "turned"]
)
@pytest.mark.parametrize("integrator", RUNS)
def test_lamps_in_the_plane_of_a_ceiling(integrator: str, turn: Array, order: tuple[int, ...]) -> None:
    runs = runs_of(lamp_scene(turn, order, at_lamp=True), integrator, 1)
    confirm(judge(runs, np.broadcast_to(RADIANCE, runs.shape[1:]), FAMILY), f"coincident/{integrator}-{order[0]}-lamp")
    scene = lamp_scene(turn, order, at_lamp=False)
    runs, expected = runs_of(scene, integrator, 2), floor_radiance(scene.camera, turn)
    confirm(judge(runs, expected, FAMILY), f"coincident/{integrator}-{order[0]}-floor")
    assert not judge(runs, 1.1 * expected, FAMILY).passed


def glass_scene(times: int, order: int = 1) -> Scene:
    """A glass block, given some times over, on the floor of a room and back to back with another; a lamp in the ceiling."""
    corners, faces = box((0, 0, 0), (2, 2, 2))
    lamp = Shape(rectangle((-0.4, 1, -0.4), (0.8, 0, 0), (0, 0, 0.8)), Diffuse(0.0), emission=10.0)
    room = Shape((corners, faces[:, ::-1]), Diffuse(0.5))
    block = box((-0.3, -0.7, 0), (0.6, 0.6, 0.6))
    glass = [Shape(block, RoughDielectric(0.4, 1.5)) for _ in range(times)]
    beside = Shape(box((0.3, -0.7, 0), (0.6, 0.6, 0.6)), RoughDielectric(0.5, 1.3))
    camera = Camera((0.2, -0.2, 0.95), (0, -0.6, 0), fov=60, width=12, height=8)
    return Scene(camera, [room, lamp, *glass, beside][::order])


def test_glass_on_glass() -> None:
    reference = runs_of(glass_scene(1), "bdpt", 3, 2)
    for integrator, order in (("path", 1), ("bdpt", -1), ("lmc", 1)):
        runs = runs_of(glass_scene(2, order), integrator, 3)
        verdict = judge(runs, reference, 3)
        confirm(verdict, f"coincident/glass-{integrator}")
        print(integrator, verdict.ratio, verdict.ratio_error)
        assert verdict.ratio_error < 0.03


def test_what_is_met_does_not_depend_on_the_order() -> None:
    """What is met in each triangle's place, from either side, is the same in three orders of one scene."""

    def met(order: tuple[int, ...]) -> set[tuple[object, ...]]:
        scene = lamp_scene(TURN, order, at_lamp=True)
        compiled = compile_scene(scene)
        ties, mesh = compiled.arrays["ties"], compiled.mesh
        centres = mesh.vertices[mesh.faces].mean(axis=1).round(6) + 0.0

        def look(triangle: int) -> tuple[object, ...]:
            shape = scene.shapes[mesh.shape_of_face[triangle]]
            return repr(shape.material), shape.emission, *centres[triangle]

        return {
            (look(i), side, tuple(look(k) for k in ties[ties[2 * i + side] : ties[2 * i + side + 1]]))
            for i in range(len(mesh.faces))
            for side in (0, 1)
        }

    assert met((0, 1, 2, 3, 4, 5)) == met((5, 3, 4, 2, 0, 1)) == met((4, 0, 5, 1, 3, 2))


@pytest.mark.parametrize("kind", ["inside out", "face to face", "face to face, displaced"])
def test_one_shape_owns_all_that_it_shares_with_another(kind: str) -> None:
    """Whichever comes first in the scene; of a block of glass and the same inside out it is the block."""
    block = box((0, 0, 0), (1, 1, 1))
    others = {"inside out": reversed_(block), "face to face": box((1, 0, 0), (1, 1, 1))}
    other = others.get(kind, box((1, 0.1, 0.2), (1, 1, 1)))
    one, two = (Shape(mesh, RoughDielectric(0.3), name=name) for name, mesh in (("block", block), ("other", other)))
    lamp = Shape(box((0, 5, 0), (1, 1, 1)), Diffuse(0.0), emission=1.0)
    winners = []
    for shapes in ([one, two, lamp], [two, one, lamp]):
        compiled = compile_scene(Scene(Camera((0, 0, 5), (0, 0, 0)), shapes))
        ties, shape_of = compiled.arrays["ties"], compiled.mesh.shape_of_face
        winners.append({shapes[i].name for i in shape_of[ties[ties[0] : ties[2 * len(shape_of)]]]})
    assert len(winners[0]) == 1
    assert winners[0] == winners[1]
    if kind == "inside out":
        assert winners[0] == {"block"}
