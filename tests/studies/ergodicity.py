"""Chains that start in the states furthest to one side of the film, and what becomes of the two sides."""

from __future__ import annotations

import numpy as np

from pylmc.sampling.states import ChainArrays

from .invariance import Outcome, Resumed, Start, compare
from .invariance_cases import LONG_STEPS, start

STEPS = {"caustic": 512, "skewed": 512, "glints": 512, "keyhole": 4096}  # large steps find its hole seldom


def film_x(chains: ChainArrays, start: Start) -> np.ndarray:
    right, _, forward = start.scene.camera.axes()
    v = chains.v[:, 0].astype(np.float64)
    return (v @ right) / (v @ forward)


def gathered(start: Start, side: int, share: float) -> ChainArrays:
    """Every group's chains in the states of the ``share`` of them that is furthest to one side of the film; 0: in one state."""
    chosen, rng = np.arange(len(start.chains.length)), np.random.default_rng(side + 7)
    x = film_x(start.chains, start) * side
    for group in start.sampler.groups:
        members = np.arange(group.first, group.first + group.chains)
        furthest = members[np.argsort(x[members])[-max(int(share * group.chains), 1) :]]
        chosen[members] = rng.choice(furthest, group.chains)
    return start.chains.only(chosen)


def p_values(a: ChainArrays, b: ChainArrays, start: Start) -> Outcome:
    return Outcome(compare(start.described(a), start.described(b), start.take, start.scene))


def run(scene: str, share: float, steps: int, **settings: float) -> tuple[Outcome, list[Outcome]]:
    """The two sides before, and after: one against the other, and each against the target."""
    begin, ends = start(scene), []
    sides = [gathered(begin, side, share) for side in (-1, 1)]
    for number, chains in enumerate(sides):
        sampler = Resumed(begin, seed=number, chains=chains, **LONG_STEPS, **settings)
        sampler.step(steps)
        ends.append(sampler.state.arrays())
    target = begin.fresh
    against = [Outcome(compare(target, begin.described(end), begin.take, begin.scene)) for end in ends]
    return p_values(*sides, begin), [p_values(*ends, begin), *against]
