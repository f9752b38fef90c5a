"""Shapes: what they look like follows what was asked for; every array is checked, and copied."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import trimesh

import pylmc
from pylmc import Camera, Diffuse, PointLight, Portal, PylmcError, Shape, Texture

VERTICES = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
FACES = np.array([[0, 1, 2], [0, 2, 3]])
NORMALS = np.tile([0.0, 3, 4], (4, 1))
UV = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
TEXTURED = Diffuse(Texture(np.full((2, 2, 3), 0.5)))


def square(**keywords: Any) -> Shape:
    return Shape((VERTICES, FACES), keywords.pop("material", Diffuse(0.5)), name="square", **keywords)


def spoilt(array: np.ndarray, value: float) -> np.ndarray:
    """The array with one wrong number in its third row."""
    wrong = array.copy()
    wrong[2, 1] = value
    return wrong


# --- smooth or faceted ------------------------------------------------------------------------------------------------


def test_given_normals_are_interpolated() -> None:
    shape = square(normals=NORMALS)
    assert shape.smooth is True
    np.testing.assert_allclose(shape.vertex_normals(), np.tile([0, 0.6, 0.8], (4, 1)))  # made unit
    assert square(normals=NORMALS, smooth=False).vertex_normals() is None


def test_faceted_unless_asked() -> None:
    assert square().vertex_normals() is None
    np.testing.assert_allclose(square(smooth=True).vertex_normals(), np.tile([0, 0, 1], (4, 1)))


def read(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """The mesh after somebody has looked at its normals, which it remembers."""
    assert len(mesh.vertex_normals) == len(mesh.vertices)
    return mesh


HANDLED: dict[str, Callable[[trimesh.Trimesh], trimesh.Trimesh]] = {
    "fresh": lambda mesh: mesh,
    "read": read,
    "copied": lambda mesh: mesh.copy(),
    "copied without its cache": lambda mesh: mesh.copy(include_cache=False),
    "submesh": lambda mesh: mesh.submesh([np.arange(len(mesh.faces))], append=True, repair=False),
    "with normals of its own": lambda mesh: trimesh.Trimesh(
        mesh.vertices, mesh.faces, vertex_normals=np.tile([0.0, 1, 0], (len(mesh.vertices), 1)), process=False
    ),
}


@pytest.mark.parametrize("name", HANDLED)
def test_what_trimesh_remembers_changes_nothing(name: str) -> None:
    mesh = HANDLED[name](trimesh.creation.box((2, 2, 2)))
    assert Shape(mesh, Diffuse()).vertex_normals() is None
    expected = Shape(trimesh.creation.box((2, 2, 2)), Diffuse(), smooth=True).vertex_normals()
    np.testing.assert_allclose(Shape(mesh, Diffuse(), smooth=True).vertex_normals(), expected, atol=1e-12)


def test_the_callers_arrays_are_copied() -> None:
    mesh = trimesh.Trimesh(VERTICES, FACES, process=False, visual=trimesh.visual.TextureVisuals(uv=UV.copy()))
    normals, pixels = NORMALS.copy(), np.full((2, 2, 3), 0.5, np.float32)
    origin = np.array([0.0, 0, 2])
    shape = Shape(mesh, Diffuse(Texture(pixels)), normals=normals)
    camera = Camera(origin, (0, 0, 0))
    mesh.apply_translation([5, 5, 5])
    mesh.visual.uv[:] = np.nan
    for array in (normals, pixels, origin):
        array[:] = np.nan
    np.testing.assert_array_equal(shape.vertices, VERTICES)
    np.testing.assert_array_equal(shape.mesh.vertices, VERTICES)
    np.testing.assert_array_equal(shape.uv, UV)
    np.testing.assert_allclose(shape.vertex_normals(), np.tile([0, 0.6, 0.8], (4, 1)))
    assert shape.material.reflectance.mean() == (0.5, 0.5, 0.5)
    np.testing.assert_array_equal(camera.origin, [0, 0, 2])
    for array in (shape.vertices, shape.faces, shape.uv, shape.normals, shape.material.reflectance.pixels, camera.origin):
        with pytest.raises(ValueError, match="read-only"):
            array[:] = 0


def test_a_shape_of_a_shapes_mesh_keeps_its_texture_coordinates() -> None:
    plain = Shape(square(material=TEXTURED, uv=UV).mesh, Diffuse(0.2))
    np.testing.assert_array_equal(Shape(plain.mesh, TEXTURED).uv, UV)


# --- refused by name --------------------------------------------------------------------------------------------------

BAD_NUMBERS = (np.nan, np.inf, -np.inf)
REFUSED: dict[str, tuple[Callable[[], Any], str]] = {
    "vertices short": (lambda: Shape((VERTICES[:, :2], FACES), Diffuse(), name="a"), r"'a'.*shape \(4, 2\)"),
    "vertices complex": (lambda: Shape((VERTICES * 1j, FACES), Diffuse(), name="a"), "'a'.*complex128"),
    "vertices text": (lambda: Shape((VERTICES.astype(str), FACES), Diffuse(), name="a"), "'a'.*real numbers"),
    "faces fractional": (lambda: Shape((VERTICES, FACES + 0.5), Diffuse(), name="a"), "'a'.*whole numbers"),
    "faces NaN": (lambda: Shape((VERTICES, FACES * np.nan), Diffuse(), name="a"), "'a'.*whole numbers"),
    "faces infinite": (lambda: Shape((VERTICES, FACES + np.inf), Diffuse(), name="a"), "'a'.*whole numbers"),
    "faces huge": (lambda: Shape((VERTICES, FACES + 1e300), Diffuse(), name="a"), "'a'.*whole numbers"),
    "faces of two": (lambda: Shape((VERTICES, FACES[:, :2]), Diffuse(), name="a"), r"'a'.*\(2, 2\)"),
    "faces ragged": (lambda: Shape((VERTICES, [[0, 1, 2], [0, 1]]), Diffuse(), name="a"), "'a'.*neither"),
    "faces beyond": (lambda: Shape((VERTICES, FACES + 1), Diffuse(), name="a"), "'a'.*vertex 4, but there are 4"),
    "faces negative": (lambda: Shape((VERTICES, FACES - 1), Diffuse(), name="a"), "'a'.*vertex -1"),
    "no faces": (lambda: Shape((VERTICES, []), Diffuse(), name="a"), "'a'.*empty"),
    "normals short": (lambda: square(normals=NORMALS[:3]), r"'square': normals have shape \(3, 3\)"),
    "normals flat": (lambda: square(normals=[0, 0, 1]), r"'square': normals have shape \(3,\)"),
    "normals text": (lambda: square(normals="up"), "'square': normals must be an array of numbers"),
    "normals zero": (lambda: square(normals=NORMALS * [[1], [0], [1], [1]]), "'square': the normal of vertex 1 .*length"),
    "normals unused but wrong": (lambda: square(normals=NORMALS * np.nan, smooth=False), "'square': the normal of vertex 0"),
    "uv short": (lambda: square(material=TEXTURED, uv=UV[:3]), r"'square': texture coordinates have shape \(3, 2\)"),
    "uv wide": (lambda: square(material=TEXTURED, uv=VERTICES), r"'square': texture coordinates have shape \(4, 3\)"),
    "uv absurd": (lambda: square(material=TEXTURED, uv=UV * 1e300), "'square': the texture coordinates of vertex 1"),
    "uv unused but wrong": (lambda: square(uv=UV * np.nan), "'square': the texture coordinates of vertex 0"),
    "uv missing": (lambda: square(material=TEXTURED), "'square'.*no texture coordinates"),
    "smooth in words": (lambda: square(smooth="no"), "'square': smooth='no'"),
    "emission short": (lambda: square(emission=(1, 2)), "'square': emission"),
    "emission complex": (lambda: square(emission=1j), "'square': emission"),
    "pixels grey": (lambda: Texture(np.zeros((2, 2))), r"pixels have shape \(2, 2\)"),
    "pixels complex": (lambda: Texture(np.zeros((2, 2, 3)) * 1j), "array of numbers"),
    "pixels a name": (lambda: Texture("wood.png"), "not a file name"),
    "pixels of bytes": (lambda: Texture(np.full((2, 2, 3), 128, np.uint8)), r"\[0, 1\]"),
    "camera complex": (lambda: Camera((0, 0, 1j), (0, 0, 0)), "Camera.origin"),
    "light text": (lambda: PointLight(("0", "1", "2")), "PointLight.position"),
    "portal half-sizes": (lambda: Portal((0, 0, 0), (0, 0, 1), (1, 0, 0), (1, 2, 3)), "half_size"),
    "portal axis": (lambda: Portal((0, 0, 0), (0, 0, 1), (0, 0, 1), 1), "axis is parallel"),
}


@pytest.mark.parametrize("name", REFUSED)
@pytest.mark.filterwarnings("error")
def test_what_cannot_be_is_refused_by_name(name: str) -> None:
    make, message = REFUSED[name]
    with pytest.raises(PylmcError, match=message):
        make()


@pytest.mark.parametrize("bad", BAD_NUMBERS)
@pytest.mark.filterwarnings("error")
def test_every_array_is_searched_for_numbers_that_are_none(bad: float) -> None:
    cases: list[tuple[Callable[[], Any], str]] = [
        (lambda: Shape((spoilt(VERTICES, bad), FACES), Diffuse(), name="a"), "'a': vertex 2 is NaN"),
        (lambda: square(normals=spoilt(NORMALS, bad)), "'square': the normal of vertex 2 is NaN"),
        (lambda: square(material=TEXTURED, uv=spoilt(UV, bad)), "'square': the texture coordinates of vertex 2 are NaN"),
        (lambda: square(emission=(1, bad, 1)), "'square': emission"),
        (lambda: Texture(np.full((2, 2, 3), bad)), r"pixels must lie in \[0, 1\]"),
        (lambda: Diffuse((bad, 0, 0)), "Diffuse.reflectance"),
        (lambda: Camera((0, bad, 1), (0, 0, 0)), "Camera.origin"),
        (lambda: Camera((0, 0, 1), (0, 0, 0), (0, bad, 0)), "Camera.up"),
        (lambda: PointLight((0, bad, 0)), "PointLight.position"),
        (lambda: PointLight((0, 0, 0), (1, bad, 1)), "PointLight.intensity"),
        (lambda: Portal((bad, 0, 0), (0, 0, 1), (1, 0, 0), 1), "Portal.centre"),
        (lambda: Portal((0, 0, 0), (0, bad, 1), (1, 0, 0), 1), "Portal.normal"),
        (lambda: Portal((0, 0, 0), (0, 0, 1), (bad, 0, 0), 1), "Portal.axis"),
        (lambda: Portal((0, 0, 0), (0, 0, 1), (1, 0, 0), (1, bad)), "Portal.half_size"),
    ]
    for make, message in cases:
        with pytest.raises(PylmcError, match=message):
            make()


@pytest.mark.parametrize("uv", [UV[:3], UV * np.nan, np.full((4, 2), np.inf), np.zeros((4, 3))])
def test_a_meshs_own_texture_coordinates_are_checked_where_they_are_looked_at(uv: np.ndarray) -> None:
    mesh = trimesh.Trimesh(VERTICES, FACES, process=False, visual=trimesh.visual.TextureVisuals(uv=uv))
    with pytest.raises(PylmcError, match=r"'a'.*texture coordinates"):
        Shape(mesh, TEXTURED, name="a")
    assert Shape(mesh, Diffuse(0.5)).uv is None


def test_a_portals_axis_may_be_of_any_length() -> None:
    portal = Portal((0, 0, 0), (0, 0, 2), (1e-12, 0, 1e-12), 1)
    np.testing.assert_allclose(portal.axis, [1, 0, 0])


def test_quads_are_split() -> None:
    assert len(pylmc.Shape((VERTICES, [[0, 1, 2, 3]]), Diffuse()).faces) == 2
