"""The scenes of the comparison. Each is there for something that renderers get wrong; none is hard to sample.

Lobes are wide (roughness 0.15 and more), so that both a path tracer and chains estimate every pixel well within seconds:
what is compared is the light transport, not the patience.
"""

from __future__ import annotations

import numpy as np
import trimesh

from pylmc.scene.builtin._meshes import box, rectangle

from .description import RGB, Description, Glass, Matte, Metal, Point, Surface, View

WHITE, RED, GREEN, BLUE = (0.75, 0.75, 0.75), (0.7, 0.15, 0.1), (0.15, 0.6, 0.2), (0.2, 0.3, 0.7)
GOLD = (0.9, 0.7, 0.35)


def plane(corner: RGB, edge1: RGB, edge2: RGB, material: Matte | Metal | Glass, emission: RGB | None = None) -> Surface:
    """A rectangle; its normal is edge1 × edge2."""
    return Surface(*rectangle(corner, edge1, edge2), material, emission=emission)


def solid(centre: RGB, size: RGB, turn: float, material: Matte | Metal | Glass) -> Surface:
    """A closed box, turned about the vertical, normals outward."""
    return Surface(*box(centre, size, turn), material)


def ball(centre: RGB, radius: float, subdivisions: int, material: Matte | Metal | Glass) -> Surface:
    """A sphere of triangles with the sphere's own normals at the vertices."""
    mesh = trimesh.creation.icosphere(subdivisions=subdivisions, radius=1.0)
    points = np.asarray(mesh.vertices, dtype=np.float64)
    return Surface(radius * points + np.array(centre), np.asarray(mesh.faces), material, normals=points)


def stage(floor: Matte | Metal = Matte(WHITE), wall: Matte | Metal = Matte(BLUE)) -> tuple[Surface, Surface]:  # noqa: B008
    """A floor at y = 0 and a wall behind it at z = -1.5."""
    return (
        plane((-2, 0, -1.5), (0, 0, 4), (4, 0, 0), floor),
        plane((-2, 0, -1.5), (4, 0, 0), (0, 3, 0), wall),
    )


def room() -> Description:
    surfaces = (
        *stage(),
        plane((-1.2, 0, -1.5), (0, 2, 0), (0, 0, 3), Matte(RED)),
        plane((1.2, 0, -1.5), (0, 0, 3), (0, 2, 0), Matte(GREEN)),
        plane((-1.2, 2, -1.5), (2.4, 0, 0), (0, 0, 3), Matte(WHITE)),
        solid((-0.4, 0.4, -0.6), (0.5, 0.8, 0.5), 25, Matte(WHITE)),
        plane((-0.4, 1.98, -0.9), (0.8, 0, 0), (0, 0, 0.8), Matte((0.3, 0.3, 0.3)), (6.0, 5.0, 3.5)),
    )
    return Description(
        "room", "diffuse interreflection, a visible area light", View((0.1, 1.0, 3.2), (0, 0.95, -0.5), 42), surfaces, depth=4
    )


def smooth_ball() -> Description:
    surfaces = (*stage(wall=Matte(RED)), ball((0.2, 0.6, 0), 0.6, 2, Matte((0.8, 0.7, 0.5))))
    return Description(
        "smooth-ball",
        "interpolated vertex normals on a coarse ball, a point light",
        View((0.3, 1.1, 3.0), (0.15, 0.6, 0), 27),
        surfaces,
        (Point((1.6, 2.2, 1.4), (9, 8, 7)),),
        3,
    )


def metal_ball() -> Description:
    surfaces = (
        *stage(Matte(WHITE), Matte(GREEN)),
        ball((-0.1, 0.6, 0), 0.6, 3, Metal(0.25, GOLD)),
        plane((-1.0, 2.2, -0.2), (1.2, 0, 0), (0, 0, 1.2), Matte((0.2, 0.2, 0.2)), (5.0, 5.0, 6.0)),
    )
    return Description(
        "metal-ball",
        "rough conductor with vertex normals under an area light",
        View((0.3, 1.1, 3.0), (0, 0.6, -0.2), 40),
        surfaces,
        depth=5,
    )


def metal_plates() -> Description:
    surfaces = (
        *stage(Metal(0.7, (0.85, 0.8, 0.9)), Metal(0.2, GOLD)),
        solid((0.3, 0.35, -0.3), (0.6, 0.7, 0.5), 30, Matte(RED)),
        plane((-1.6, 0.5, 0.2), (0, 0, -0.8), (0, 0.9, 0), Matte((0.2, 0.2, 0.2)), (4.0, 6.0, 5.0)),
    )
    return Description(
        "metal-plates",
        "two rough conductors that see each other, both kinds of light",
        View((0.2, 1.0, 2.9), (0, 0.55, -0.5), 42),
        surfaces,
        (Point((0.9, 1.9, 1.2), (4, 3, 2)),),
        4,
    )


PANE = Glass(0.3, 1.5)


def pane() -> Surface:
    """A slab of glass across the view, closed, normals outward: each side is crossed in both directions."""
    return solid((0.1, 0.75, 0.5), (1.2, 1.2, 0.12), 12, PANE)


def pane_lit_from_front() -> Description:
    surfaces = (*stage(Matte(WHITE), Matte(GREEN)), pane(), solid((-0.3, 0.3, -0.6), (0.5, 0.6, 0.5), 30, Matte(RED)))
    return Description(
        "pane-front",
        "a slab of rough glass, the light on the camera's side",
        View((0.1, 1.1, 3.4), (0, 0.75, 0), 36),
        surfaces,
        (Point((-0.9, 2.0, 2.6), (12, 11, 10)),),
        6,
    )


def pane_lit_from_behind() -> Description:
    surfaces = (
        *stage(Matte(WHITE), Matte(GREEN)),
        pane(),
        plane((-0.7, 0.5, -1.4), (1.4, 0, 0), (0, 1.0, 0), Matte((0.2, 0.2, 0.2)), (5.0, 3.0, 2.0)),
    )
    return Description(
        "pane-behind", "the same slab, an area light behind it", View((0.1, 1.1, 3.4), (0, 0.75, 0), 36), surfaces, depth=5
    )


WATER = Glass(0.3, 1.33)


def water(normal_up: bool = True) -> Surface:
    """One open interface at y = 1: the medium lies under it, so that a path may cross it an odd number of times."""
    edges: tuple[RGB, RGB] = ((0, 0, 4), (4, 0, 0)) if normal_up else ((4, 0, 0), (0, 0, 4))
    return plane((-2, 1.0, -2), *edges, WATER if normal_up else Glass(WATER.alpha, 1 / WATER.ior))


def lamp_in_water() -> Description:
    surfaces = (
        water(),
        plane((-2, 0, -2), (0, 0, 4), (4, 0, 0), Matte(WHITE)),
        plane((-2, 0, -2), (4, 0, 0), (0, 3, 0), Matte(BLUE)),
        solid((0.5, 0.2, 0), (0.5, 0.4, 0.5), 20, Matte(RED)),
    )
    return Description(
        "lamp-in-water",
        "one interface, seen from outside, the light in the medium",
        View((0.1, 2.3, 2.4), (0, 0.5, -0.2), 44),
        surfaces,
        (Point((-0.6, 0.5, 1.6), (4, 4, 4)),),
        4,
    )


def lamp_over_water() -> Description:
    surfaces = (
        water(normal_up=False),
        plane((-2, 2.6, -2), (4, 0, 0), (0, 0, 4), Matte(GREEN)),
        plane((-2, 0, -2), (4, 0, 0), (0, 2.6, 0), Matte(WHITE)),
        solid((0.3, 1.5, -0.3), (0.6, 0.6, 0.6), 20, Matte(RED)),
    )
    return Description(
        "lamp-over-water",
        "one interface, seen from the medium, the light outside",
        View((0.1, 0.25, 1.0), (0, 1.35, -0.5), 50),
        surfaces,
        (Point((-0.7, 1.8, 0.4), (3, 3, 3)),),
        4,
    )


def glass_ball() -> Description:
    surfaces = (
        *stage(Matte(WHITE), Matte(RED)),
        ball((0, 0.62, 0), 0.6, 4, Glass(0.25, 1.5)),
        plane((-1.2, 2.4, -1.0), (2.4, 0, 0), (0, 0, 2.4), Matte((0.2, 0.2, 0.2)), (3.0, 3.0, 2.5)),
    )
    return Description(
        "glass-ball",
        "rough glass with vertex normals, crossed twice and more, under an area light",
        View((0.3, 1.1, 3.0), (0, 0.6, -0.2), 40),
        surfaces,
        depth=6,
    )


SCENES: dict[str, Description] = {
    scene.name: scene
    for scene in (
        room(),
        smooth_ball(),
        metal_ball(),
        metal_plates(),
        pane_lit_from_front(),
        pane_lit_from_behind(),
        lamp_in_water(),
        lamp_over_water(),
        glass_ball(),
    )
}
