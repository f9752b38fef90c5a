"""Devices agree: to the bit in exact single precision, and on the same light in any case.

A compiler that mistakes control flow shows here and nowhere else.
"""

from __future__ import annotations

import numpy as np
import pytest
from studies.devices import alike

import pylmc
from pylmc.device import survey
from pylmc.sampling.sampler import Sampler
from pylmc.scene.loading import load


@pytest.mark.parametrize("name", ["keyhole", "caustic", "glints"])
def test_candidates_weigh_the_same_on_every_device(name: str) -> None:
    """The same random numbers make the same paths, but for a few on the edge of existence."""
    if len(survey.usable()) < 2:
        pytest.skip("only one OpenCL device is usable here")
    found = {}
    for index, device in enumerate(survey.usable()):
        groups = Sampler(load(name), max_depth=4, device=str(index)).weigh(1 << 14, seed=3)
        found[device.label] = np.stack([group.log_weights for group in groups])
    (first, reference), *others = found.items()
    for label, weights in others:
        same = np.isclose(weights, reference, rtol=0, atol=0.05) | (np.isinf(weights) & np.isinf(reference))
        assert same.mean() > 0.999, f"{label} against {first}"


WORK = {"lmc": 60, "bdpt": 60, "path": 8}  # mutations (samples) per pixel
COUNTED = ("acceptance", "rays", "not_finite_rejected", "b")


@pytest.mark.parametrize("integrator", WORK)
@pytest.mark.parametrize("name", ["keyhole", "glints"])
def test_a_seed_gives_the_same_picture_on_every_device(name: str, integrator: str) -> None:
    """The same bits, and the same counters."""
    scene = load(name, width=32, height=32)
    work = {"mutations_per_pixel": WORK[integrator], "max_depth": 5, "integrator": integrator, "progress": False}
    devices = alike()
    first, *others = [pylmc.render(scene, seed=5, device=device, **work) for device in devices]
    assert first.image.max() > 0
    for device, other in zip(devices[1:], others, strict=True):
        np.testing.assert_array_equal(other.image, first.image, err_msg=device)
        for counted in COUNTED:
            assert other.diagnostics.get(counted) == first.diagnostics.get(counted), f"{counted} on {device}"
