"""Every usable device finds the same light: a compiler that mistakes control flow shows here and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest

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
