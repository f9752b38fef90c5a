"""Lights and their directions, and indices of media: what cannot be is refused by name."""

from typing import Any

import numpy as np
import pytest

from pylmc import DirectionalLight, Plastic, PylmcError, RoughDielectric, SpotLight


@pytest.mark.parametrize("scale", [1e-170, 1e-161, 1.0, 1e14])
def test_directions_have_length_one_however_they_are_given(scale: float) -> None:
    direction = DirectionalLight((scale, 2 * scale, 0)).direction
    np.testing.assert_allclose(direction, np.array([1, 2, 0]) / np.sqrt(5), atol=1e-15)


@pytest.mark.parametrize(
    "make,message",
    [
        (lambda: SpotLight((0, 0, 0), (0, 0, 0)), "SpotLight.direction has length zero"),
        (lambda: SpotLight((0, 0, 0), (0, 1, 0), inner_angle=30, outer_angle=20), r"SpotLight\.inner_angle=30"),
        (lambda: SpotLight((0, 0, 0), (0, 1, 0), 0.0), r"SpotLight\.intensity is zero"),
        (lambda: DirectionalLight((0, float("nan"), 0)), r"DirectionalLight\.direction"),
        (lambda: DirectionalLight((0, 1, 0), -1.0), r"DirectionalLight\.irradiance"),
        (lambda: Plastic(ior=1e300), "Plastic: ior=1e"),
        (lambda: Plastic(ior=0.9), r"Plastic: ior=0\.9"),
        (lambda: RoughDielectric(ior=1e300), "RoughDielectric: ior=1e"),
    ],
)
def test_what_cannot_be_is_refused_by_name(make: Any, message: str) -> None:
    with pytest.raises(PylmcError, match=message):
        make()
