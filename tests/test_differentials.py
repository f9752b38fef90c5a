"""The factor L and the drift's gradient against the oracle's derivatives of whole displaced paths.

Tangents cannot be read from the kernels, but L Lᵀ is the sum of the constraints' rows, each a tangent over a width.
Here every row is the derivative of the function that it bounds (tests/oracle) and the rows meet in
pylmc.preconditioner.combine.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest
from oracle.chains import read_paths
from oracle.charts import Charts
from oracle.constraints import preconditioner
from oracle.displaced import displaced
from oracle.lobes import TRANSMIT
from oracle.paths import Paths, surface
from oracle.scene import World
from oracle.tangents import Tangents
from oracle.vectors import any_tangent, dot

import pylmc
from pylmc.preconditioner import proposal_factor
from pylmc.sampler import Sampler

# What float32 leaves of a product of path tangents. One rounding is 6e-8; a node's position divides it by cosines (down
# to 1e-2 at grazing incidence) and by the shortest segment (about 1e-2 of the scene's radius), and a path has up to
# six. Seen: medians of 1e-7 to 4e-5, worst of all paths 8e-3. A wrong term is of order one.
MEDIAN, WORST = 2e-4, 3e-2


class Case(NamedTuple):
    scene: str
    parameters: dict[str, float]
    settings: dict[str, Any]
    depth: int
    blocks: tuple[int, ...]

    def __str__(self) -> str:
        return "-".join([self.scene, *map(str, self.settings.values())])


KEYHOLE, CAUSTIC, GLINTS = {"hole": 0.1, "roughness": 0.05}, {"roughness": 0.1}, {"size": 0.1, "roughness": 0.1}
CASES = [
    Case("keyhole", KEYHOLE, {"coordinates": "target", "rule": "sum"}, 6, (0, 1, 2)),
    Case("keyhole", KEYHOLE, {"coordinates": "deviation", "rule": "mean"}, 5, (0,)),
    Case("keyhole", KEYHOLE, {"coordinates": "deviation", "rule": "rms", "chart": "orthographic"}, 4, (0,)),
    Case("caustic", CAUSTIC, {"coordinates": "target", "rule": "rms"}, 5, (0, 1, 2)),
    Case("caustic", CAUSTIC, {"coordinates": "deviation", "rule": "sum"}, 4, (0,)),
    Case("glints", GLINTS, {"coordinates": "target", "rule": "mean"}, 4, (0, 2)),
]


def near_total_reflection(world: World, paths: Paths, m: int) -> np.ndarray:
    """Whether a refraction within or after the block is at the critical angle, where its reference has a kink."""
    out = np.zeros(len(paths.light), bool)
    for i in range(1, min(m + 2, paths.length)):
        here = surface(world, paths, i)
        v = paths.v[:, i]
        sine2 = (1 - dot(here.ns, v) ** 2) / here.index_ratio(-v) ** 2
        out |= (here.lobe == TRANSMIT) & (np.abs(sine2 - 1) < 0.02)
    return out


@pytest.mark.parametrize("case", CASES, ids=str)
def test_factor_and_gradient_match_differences_of_paths(case: Case) -> None:
    scene = pylmc.load(case.scene, **case.parameters).with_size(24, 18)
    sampler = Sampler(scene, max_depth=case.depth, drift=True, even=False, **case.settings)
    sampler.init(3, chains=200, candidates=1 << 15)
    world = World(sampler.compiled)
    compared: dict[str, list[np.ndarray]] = {"Q": [], "log det T": [], "gradient": []}
    paths_seen = lengths_seen = excluded = 0
    every = {block: sampler.states(block) for block in case.blocks}
    for which, paths in read_paths(sampler, world).values():
        lengths_seen += 1
        for block, states in every.items():
            m = block or paths.free
            if m > paths.free:
                continue
            frame = any_tangent(states.v_1[which].astype(float))
            kinds = Charts(world, paths, m, sampler.settings, frame).kinds
            assert np.array_equal(kinds[:, 1:], states.kinds[which][:, :m])
            keep = ~near_total_reflection(world, paths, m)
            paths_seen, excluded = paths_seen + len(keep), excluded + int((~keep).sum())
            charts = Charts(world, paths.take(keep), m, sampler.settings, frame[keep])
            tangents = Tangents(charts)
            q = preconditioner(charts, tangents)
            t, log_det_t = proposal_factor(q)
            factor = states.factors[which][keep][:, : 2 * m, : 2 * m].astype(float)
            assert np.all(np.triu(factor, 1) == 0)
            # each coordinate in the unit in which its own constraints have size one
            unit = 1 / np.sqrt(np.einsum("nii->ni", q))
            difference = np.abs(factor @ np.swapaxes(factor, 1, 2) - q) * unit[:, :, None] * unit[:, None, :]
            compared["Q"].append(difference.max(axis=(1, 2)))
            diagonal = np.einsum("nii->ni", factor)
            compared["log det T"].append(np.abs(-np.log(diagonal).sum(axis=1) - log_det_t))
            # the gradient as the drift uses it, Tᵀ g, over its own size where that exceeds one
            expected = np.einsum("nij,ni->nj", t, tangents.gradient())
            gradient = np.einsum("nij,ni->nj", t, states.gradients[which][keep][:, : 2 * m].astype(float))
            size = 1 + np.abs(expected).max(axis=1)
            compared["gradient"].append(np.abs(gradient - expected).max(axis=1) / size)
    assert lengths_seen >= case.depth - 1 and excluded <= 0.05 * paths_seen
    for what, parts in compared.items():
        errors = np.concatenate(parts)
        assert np.all(np.isfinite(errors)), what
        assert np.median(errors) < MEDIAN, (what, np.median(errors))
        assert errors.max() < WORST, (what, errors.max())


def test_displaced_paths_follow_the_charts() -> None:
    """Sampler.displaced, which traces in float32, leads where the float64 charts say, for steps within constraints."""
    sampler = Sampler(pylmc.load("keyhole", **KEYHOLE).with_size(24, 18), max_depth=4, even=False)
    sampler.init(5, chains=300, candidates=1 << 14)
    world = World(sampler.compiled)
    states = sampler.states()
    rng = np.random.default_rng(1)
    deltas = np.zeros((sampler.chains, 8))
    for chain, (length, ending) in enumerate(zip(states.length, states.ending, strict=True)):
        n = 2 * (length - (ending == 0))
        t, _ = proposal_factor(states.factors[chain, :n, :n] @ states.factors[chain, :n, :n].T)
        deltas[chain, :n] = 0.05 * t @ rng.normal(size=n)
    nodes, directions = sampler.displaced(deltas)
    checked = 0
    for which, paths in read_paths(sampler, world).values():
        m = paths.free
        charts = Charts(world, paths, m, sampler.settings, any_tangent(states.v_1[which].astype(float)))
        moved = displaced(charts, deltas[which][:, : 2 * m]).paths
        expected = moved.x[:, 1:]
        # the reference stays on the old triangles' planes: compare where the traced path did not change plane
        error = np.abs(nodes[which][:, : paths.length] - expected).max(axis=(1, 2))
        checked += int((error < 1e-3).sum())
        turned = np.abs(directions[which][:, : paths.length] - moved.v[:, 1:]).max(axis=(1, 2))
        assert np.all(turned[error < 1e-3] < 2e-2)
    assert checked > 0.8 * sampler.chains
