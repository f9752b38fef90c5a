"""Chains that start far apart meet: the mixture of small and large steps is ergodic, and small steps alone are not."""

from __future__ import annotations

import pytest
from studies.ergodicity import STEPS, run
from studies.invariance_cases import ALPHA, FAULTY

REST = [(scene, share) for scene in STEPS for share in (0.0, 0.25) if (scene, share) != ("caustic", 0.0)]


@pytest.mark.parametrize(("scene", "share"), [("caustic", 0.0), *(pytest.param(*r, marks=pytest.mark.long) for r in REST)])
def test_two_sides_of_the_film_meet(scene: str, share: float) -> None:
    before, after = run(scene, share, STEPS[scene], large_steps=0.5)
    assert before.smallest < FAULTY
    for outcome in after:
        assert outcome.corrected > ALPHA, f"{outcome.worst}: p = {outcome.smallest:.2g} of {outcome.tests} tests"


def test_small_steps_alone_do_not_meet() -> None:
    """Negative control: small steps keep a path's lobes, so that chains that start in one path never see the others'."""
    _, after = run("caustic", 0.0, 64, large_steps=0.0)
    assert all(outcome.smallest < FAULTY for outcome in after)
