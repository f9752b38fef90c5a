"""Chains that start far apart meet: the mixture of small and large steps is ergodic, and small steps alone are not."""

from __future__ import annotations

import numpy as np
import pytest
from invariance import Outcome, Resumed, Start, compare
from invariance_cases import ALPHA, FAULTY, LONG_STEPS, start

STEPS = {"caustic": 512, "skewed": 512, "glints": 512, "keyhole": 4096}  # large steps find its hole seldom


def film_x(chains: np.ndarray, start: Start) -> np.ndarray:
    right, _, forward = start.scene.camera.axes()
    v = chains["vertex"]["v"][:, 0].astype(np.float64)
    return (v @ right) / (v @ forward)


def gathered(start: Start, side: int, share: float) -> np.ndarray:
    """Every group's chains in the states of the ``share`` of them that is furthest to one side of the film; 0: in one state."""
    chains, rng = start.chains.copy(), np.random.default_rng(side + 7)
    x = film_x(chains, start) * side
    for group in start.sampler.groups:
        members = np.arange(group.first, group.first + group.chains)
        furthest = members[np.argsort(x[members])[-max(int(share * group.chains), 1) :]]
        chains[members] = start.chains[rng.choice(furthest, group.chains)]
    return chains


def p_values(a: np.ndarray, b: np.ndarray, start: Start) -> Outcome:
    return Outcome(compare(start.described(a), start.described(b), start.take, start.scene))


def run(scene: str, share: float, steps: int, **settings: float) -> tuple[Outcome, list[Outcome]]:
    """The two sides before, and after: one against the other, and each against the target."""
    begin, ends = start(scene), []
    sides = [gathered(begin, side, share) for side in (-1, 1)]
    for number, chains in enumerate(sides):
        sampler = Resumed(begin, seed=number, chains=chains, **LONG_STEPS, **settings)
        sampler.step(steps)
        ends.append(sampler.raw())
    target = begin.fresh
    against = [Outcome(compare(target, begin.described(end), begin.take, begin.scene)) for end in ends]
    return p_values(*sides, begin), [p_values(*ends, begin), *against]


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
