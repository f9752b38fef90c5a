"""A kernel that models only what its scene requires moves the same chains as one for everything, bit for bit."""

import numpy as np
import pytest

from bench.lean import variants


@pytest.mark.parametrize("scene", ["glints", pytest.param("caustic", marks=pytest.mark.long)])
def test_what_is_not_compiled_is_not_missed(scene: str) -> None:
    found = variants(scene, None)
    pictures = []
    for name in ("specialised", "general"):
        sampler, constants = found[name]
        sampler.step(16, **constants)
        pictures.append(sampler.image())
    assert pictures[0].any()
    np.testing.assert_array_equal(*pictures)
