"""Materials and lights register themselves, and are offered and named wherever there is a list of them."""

import subprocess
import sys
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass

import pytest

import pylmc
from pylmc import Diffuse, PylmcError, Scene, Shape, Texture
from pylmc.scene import Light, Material
from pylmc.scene.kinds import Kind

SQUARE = ([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])


@pytest.fixture
def velvet() -> Iterator[type[Material]]:
    """A material of the test's own, registered as long as the test runs."""
    before = Material.kinds

    @dataclass(frozen=True)
    class Velvet(Material):
        weave: Texture | None = None
        alpha: float = 0.1

    yield Velvet
    Material.kinds = before


def test_a_subclass_is_known_by_being_defined(velvet: type[Material]) -> None:
    assert Material.kinds[-1] is velvet and velvet not in Light.kinds
    assert Shape(SQUARE, velvet()).textured is False
    with pytest.raises(PylmcError, match=r"shape 'cloth': material is a str, not a material; use .*RoughDielectric or Velvet"):
        Shape(SQUARE, "red", name="cloth")


def test_a_class_below_a_class_belongs_to_the_same_kind(velvet: type[Material]) -> None:
    class Plush(velvet):  # type: ignore[misc, valid-type]
        pass

    assert Material.kinds[-2:] == (velvet, Plush)
    assert Kind.kinds == ()


def test_a_texture_in_any_field_asks_for_coordinates(velvet: type[Material]) -> None:
    texture = Texture([[[0.5, 0.5, 0.5]]])
    assert velvet(texture).textures() == (texture,)  # type: ignore[call-arg]
    with pytest.raises(PylmcError, match="no texture coordinates"):
        Shape(SQUARE, velvet(texture))  # type: ignore[call-arg]


def test_everything_registered_is_offered() -> None:
    for kind in (*Material.kinds, *Light.kinds):
        assert getattr(pylmc, kind.__name__) is getattr(pylmc.scene, kind.__name__) is kind
        assert kind.__name__ in pylmc.__all__ and kind.__name__ in dir(pylmc)
        assert kind.__doc__ and kind.__name__ in kind.names()


def test_what_is_no_light_is_refused_with_those_there_are() -> None:
    with pytest.raises(PylmcError, match=r"add a .*PointLight"):
        Scene(pylmc.Camera((0, 0, 2), (0, 0, 0)), [Shape(SQUARE, Diffuse())])
    with pytest.raises(PylmcError, match=r"Scene.lights\[0\] is a int, not a light; use .*PointLight"):
        Scene(pylmc.Camera((0, 0, 2), (0, 0, 0)), [Shape(SQUARE, Diffuse())], [3])  # type: ignore[list-item]


def test_names_of_modules_do_not_load_the_scene() -> None:
    code = """
        import sys, pylmc
        from pylmc import errors
        try:
            from pylmc import nothing
        except ImportError:
            pass
        assert "numpy" not in sys.modules
        assert pylmc.PointLight and "numpy" in sys.modules
    """
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
