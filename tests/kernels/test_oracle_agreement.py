"""Kernels against the oracle (tests/oracle), per quantity, in units of what their number type can hold.

Bounds. An error is measured in roundings: units of ε (1 + |q| + κ), where ε is the number type's unit roundoff (2⁻²⁴ single,
2⁻⁵³ double and mixed, 2⁻⁴⁴ float-float) and κ is how fast the quantity q changes as nodes, directions and derivatives do,
measured for each path (oracle/rounding.py): it is large where a segment grazes a surface, a lobe is narrow or a segment
short. A quantity of a path is made by some tens of operations for each of up to eight nodes. If N = 500 of them matter, their
roundings add up to √N = 22 units when independent and to N when they conspire; most paths are shorter and most roundings do
not matter. PLAIN bounds median, 99 % quantile and maximum accordingly. What goes through the factor L takes its rows one by
one, each with a product of tangents over all nodes before it: N is a few thousand, and κ, measured by jostling rows once, does
not see the intermediate ones (FACTORED).

Which triangle a ray meets, and whether a path exists, are yes or no: STRAY is the share that may differ, since rays pass an
edge within rounding of the tree (float32 in single and mixed).

States: paths drawn from the target of every built-in scene and of the textured one, all lengths up to 8, both endings.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import pytest
from oracle.cases import CASES, DEPTH, DEVIATION, ENDS, LOBES, LONG, Case, only_long, scene_of, start_of, states_of
from oracle.chains import adopt, paths_of, read_paths, world_of
from oracle.charts import Charts
from oracle.constraints import proposal_factor
from oracle.displaced import displaced
from oracle.independent import log_p
from oracle.integrand import log_pi
from oracle.lobes import NAMES
from oracle.paths import Paths, surface
from oracle.random import CHAIN, Streams
from oracle.rounding import Rounding, condition
from oracle.scene import World
from oracle.step import FAULTS, draw_numbers, large_step, relit_step, small_step
from oracle.tangents import Tangents
from oracle.vectors import Array, any_tangent, dot

from pylmc.sampling.sampler import Sampler
from pylmc.sampling.states import States, Trial

PLAIN, FACTORED = (4, 32, 128), (16, 128, 512)  # roundings: median, 99 %, all
STRAY = {"single": 0.01, "mixed": 0.01, "double": 0.0, "float-float": 0.01}


class Laid(NamedTuple):
    """One case's chains, laid open by the kernels."""

    case: Case
    sampler: Sampler
    world: World
    groups: list[tuple[Array, Paths]]
    states: States
    trial: Trial

    @property
    def epsilon(self) -> float:
        return self.sampler.device_scene.precision.epsilon


STEP = 5  # the trial's number: any
LEAST = -60.0  # logarithms of acceptances below this are not told apart: float32 has no such numbers


@pytest.fixture(scope="module", params=CASES + only_long(LONG))
def laid(request: pytest.FixtureRequest) -> Laid:
    chosen: Case = request.param
    sampler = Sampler(scene_of(chosen.scene), precision=chosen.precision, max_depth=DEPTH, even=False, **chosen.settings)
    world = world_of(sampler)
    adopt(sampler, world, states_of(chosen.scene))
    groups = list(paths_of(world, sampler.state.arrays()).values())
    return Laid(chosen, sampler, world, groups, sampler.states(), sampler.trial(STEP))


class Tally:
    """Errors in roundings, by quantity."""

    def __init__(self) -> None:
        self.errors: dict[str, list[Array]] = {}

    def add(self, name: str, errors: Array) -> None:
        self.errors.setdefault(name, []).append(errors)

    def check(self, bounds: tuple[float, float, float], *names: str) -> None:
        for name in names:
            errors = np.concatenate(self.errors[name])
            assert np.all(np.isfinite(errors)), name
            found = np.quantile(errors, [0.5, 0.99, 1])
            print(f"{name}: {found[0]:.2g} {found[1]:.2g} {found[2]:.2g} of {bounds}")
            assert np.all(found <= bounds), (name, found)


def bent(world: World, paths: Paths) -> Array:
    """Whether a refraction is at the critical angle, where differentials.cl cuts off the pole of its tangent."""
    out = np.zeros(len(paths.light), bool)
    for i in range(1, paths.length):
        here, v = surface(world, paths, i), paths.v[:, i]
        cosine2 = 1 - (1 - dot(here.ns, v) ** 2) / here.index_ratio(-v) ** 2
        out |= here.refers_to("refracted") & (np.abs(cosine2) < 2e-4)
    return out


# --- states --------------------------------------------------------------------------------------------------------


def test_densities(laid: Laid) -> None:
    """log I and log p_ind of states."""
    tally = Tally()
    for which, paths in laid.groups:
        found = condition(lambda p, _: {"pi": log_pi(laid.world, p), "p": log_p(laid.world, p)}, laid.world, paths)
        tally.add("log pi", found["pi"].roundings(laid.states.log_pi[which], laid.epsilon))
        tally.add("log p", found["p"].roundings(laid.states.log_p[which], laid.epsilon))
    tally.check(PLAIN, "log pi", "log p")
    # every lobe, ending and length took part
    name = laid.case.scene
    assert {NAMES[lobe] for lobe in np.unique(laid.states.lobes) if lobe >= 0} == LOBES[name] and set(
        laid.states.ending
    ) == ENDS[name]
    assert set(range(3, DEPTH + 1)) <= set(laid.states.length)


@pytest.mark.parametrize("block", [0, 1])
def test_factor(laid: Laid, block: int) -> None:
    """Charts, Q = L Lᵀ, log |det T| and the drift's gradient, for whole paths and for a leading block."""
    tally = Tally()
    settings, states = laid.sampler.settings, laid.sampler.states(block) if block else laid.states
    for which, paths in laid.groups:
        m = block or paths.free
        if m > paths.free:
            continue
        charts = Charts(laid.world, paths, m, settings, any_tangent(paths.v[:, 1]))
        charted = np.all(np.isfinite(charts.omega), axis=(1, 2))  # else no small step moves it
        assert np.array_equal(np.where(charted[:, None], charts.kinds[:, 1:], -1), states.kinds[which][:, :m])
        assert np.all(states.factors[which][~charted] == 0)
        which, paths, charts = which[charted], paths.take(charted), charts.take(charted)
        if not len(which):
            continue
        inverse = np.linalg.inv(proposal_factor(charts))  # of L: makes coordinates alike in size

        def quantities(p: Paths, rounding: Rounding | None, m: int = m) -> dict[str, Array]:
            charts = Charts(laid.world, p, m, settings, any_tangent(p.v[:, 1]))
            tangents = Tangents(charts, rounding)
            own = np.tile(inverse, (len(p.light) // len(inverse), 1, 1))  # noqa: B023
            factor = proposal_factor(charts, tangents)
            half = own @ factor
            out = {"Q": half @ np.swapaxes(half, 1, 2), "det": np.log(np.einsum("nii->ni", factor)).sum(axis=1)}
            return out | {"gradient": np.einsum("nij,nj->ni", own, tangents.gradient())}

        found = condition(quantities, laid.world, paths)
        keep = ~bent(laid.world, paths)
        factor = states.factors[which][:, : 2 * m, : 2 * m].astype(float)
        assert np.all(np.triu(factor, 1) == 0)
        half = inverse @ factor
        kernel = {"Q": half @ np.swapaxes(half, 1, 2), "det": np.log(np.einsum("nii->ni", factor)).sum(axis=1)}
        if settings.drift:
            kernel["gradient"] = np.einsum("nij,nj->ni", inverse, states.gradients[which][:, : 2 * m].astype(float))
        for name, values in kernel.items():
            tally.add(name, found[name].roundings(values, laid.epsilon)[keep])
    tally.check(FACTORED, *tally.errors)


# --- steps ---------------------------------------------------------------------------------------------------------


def parts_of(laid: Laid) -> Iterator[tuple[Array, Paths, int]]:
    """(chains, paths, block) of the trial's small steps."""
    for which, paths in laid.groups:
        for m in np.unique(laid.trial.move[which]):
            if 0 < m <= DEPTH:
                chosen = np.flatnonzero(laid.trial.move[which] == m)
                yield which[chosen], paths.take(chosen), int(m)


def streams_of(laid: Laid, chains: Array) -> Streams:
    return Streams(laid.sampler.seed, chains, STEP, CHAIN, laid.case.precision == "single")


def test_random_numbers(laid: Laid) -> None:
    """Which step, block, h and ξ: the oracle draws them from its own Philox."""
    trial, epsilon = laid.trial, laid.epsilon
    for which, paths in laid.groups:
        numbers = draw_numbers(laid.world, paths, laid.sampler.settings, streams_of(laid, which))
        assert np.array_equal(numbers.move, trial.move[which])
        small = (numbers.move > 0) & (numbers.move <= DEPTH)
        # h = exp(u log h₂ / h₁ + log h₁): an exponent of a few units
        assert np.all(np.abs(numbers.h / trial.h[which] - 1)[small] < 32 * epsilon)
        # normals: log and root of a uniform near one lose digits of a small normal, not of one of size one
        xi = np.nan_to_num(trial.xi[which][:, : 2 * paths.length].astype(float))
        assert np.abs(numbers.xi - xi)[small].max(initial=0) < 64 * epsilon


def small_steps(laid: Laid, fault: str = "") -> tuple[Tally, int, int]:
    """(errors, proposals whose existence or triangles differ, proposals)."""
    tally, trial, world, settings = Tally(), laid.trial, laid.world, laid.sampler.settings
    stray = total = 0
    for chains, paths, m in parts_of(laid):
        h, xi = trial.h[chains].astype(float), trial.xi[chains][:, : 2 * m].astype(float)
        step = small_step(world, paths, m, settings, h, xi)
        met = np.all(step.proposal.triangle[:, 1:] == trial.triangles[chains][:, : paths.length], axis=1)
        both = step.exists & trial.exists[chains] & met
        total, stray = total + len(chains), stray + int((~both & (step.exists | trial.exists[chains])).sum())
        chosen = np.flatnonzero(both & ~bent(world, paths) & ~bent(world, step.proposal))
        if not len(chosen):
            continue

        def quantities(p: Paths, rounding: Rounding | None, h: Array, xi: Array, onto: Array, m: int = m) -> dict[str, Array]:
            step = small_step(world, p, m, settings, h, xi, fault, onto, rounding)
            return {
                "nodes": step.proposal.x[:, 1:],
                "directions": step.proposal.v[:, 1:],
                "log pi": step.log_pi,
                "log forward": step.log_forward,
                "log reverse": step.log_reverse,
                "log acceptance": np.clip(step.log_acceptance, LEAST, 0),
            }

        numbers = h[chosen], xi[chosen], step.proposal.triangle[chosen]
        found = condition(quantities, world, paths.take(chosen), *numbers)
        k, chains = paths.length, chains[chosen]
        with np.errstate(divide="ignore"):
            decided = np.maximum(np.log(trial.acceptance[chains]), LEAST)
        kernel = {
            "nodes": trial.nodes[chains][:, :k],
            "directions": trial.directions[chains][:, :k],
            "log pi": trial.log_pi[chains],
            "log forward": trial.log_forward[chains],
            "log reverse": trial.log_reverse[chains],
            "log acceptance": decided,
        }
        for name, values in kernel.items():
            tally.add(name, found[name].roundings(values, laid.epsilon))
    return tally, stray, total


def test_small_steps(laid: Laid) -> None:
    """Proposals, their densities forth and back, and acceptance, from X and the random numbers."""
    tally, stray, total = small_steps(laid)
    assert total > 0.6 * laid.sampler.chains and len(np.concatenate(tally.errors["nodes"])) > 0.4 * total
    assert stray <= STRAY[laid.case.precision] * total, (stray, total)
    tally.check(FACTORED, *tally.errors)


def test_large_steps(laid: Laid) -> None:
    """Independent paths drawn from the same random numbers, and their acceptance; the number that decides."""
    tally, trial, world = Tally(), laid.trial, laid.world
    stray = total = found = 0
    for which, paths in laid.groups:
        chosen = np.flatnonzero(trial.move[which] == 0)
        chains, paths = which[chosen], paths.take(chosen)
        streams = streams_of(laid, chains)
        streams.uniform(np.ones(len(chains), bool))  # the one that made the step large
        step = large_step(world, paths, streams)
        k = paths.length
        met = np.all(step.proposal.triangle[:, 1:] == trial.triangles[chains][:, :k], axis=1)
        both = step.exists & trial.exists[chains] & met
        total, found = total + len(chains), found + int(both.sum())
        stray += int((~both & (step.exists | trial.exists[chains])).sum())
        if not both.any():
            continue
        assert np.array_equal(step.proposal.lobe[both][:, 1:-1], trial.lobes[chains[both]][:, : k - 1])
        # nodes were drawn one from another: a rounding of one grows by length over cosine with each that follows
        error = np.abs(step.proposal.x[:, 1:] - trial.nodes[chains][:, :k])[both].max(axis=(1, 2))
        tally.add("nodes", error / laid.epsilon / 1e3)
        reached = condition(lambda p, _: {"pi": log_pi(world, p), "p": log_p(world, p)}, world, step.proposal.take(both))
        # κ of the densities as nodes move, times how far the kernel's nodes are
        away = np.maximum(error / laid.epsilon, 1)
        tally.add("log pi", reached["pi"].roundings(trial.log_pi[chains[both]], laid.epsilon) / away)
        tally.add("log forward", reached["p"].roundings(trial.log_forward[chains[both]], laid.epsilon) / away)
    assert found > 0 and stray <= max(STRAY[laid.case.precision] * total, 1), (found, stray, total)
    tally.check(PLAIN, "log pi", "log forward")


def test_other_lights(laid: Laid) -> None:
    """The same paths joined to another light, and their acceptance, where the scene has several."""
    tally, trial, world = Tally(), laid.trial, laid.world
    stray = total = found = 0
    for which, paths in laid.groups:
        chosen = np.flatnonzero(trial.move[which] == DEPTH + 1)
        if not len(chosen):
            continue
        chains, paths = which[chosen], paths.take(chosen)
        streams = streams_of(laid, chains)
        streams.uniform(np.ones(len(chains), bool))  # the one that chose the move
        step = relit_step(world, paths, streams)
        both = step.exists & trial.exists[chains]
        total, found = total + len(chains), found + int(both.sum())
        stray += int((step.exists != trial.exists[chains]).sum())
        if not both.any():
            continue
        reached = condition(lambda p, _: {"pi": log_pi(world, p)}, world, step.proposal.take(both))["pi"]
        tally.add("log pi", reached.roundings(trial.log_pi[chains[both]], laid.epsilon))
        for kernel, ours in ((trial.log_forward, step.log_forward), (trial.log_reverse, step.log_reverse)):
            assert np.all(np.abs(kernel[chains] - ours)[both] < 16 * laid.epsilon)
        assert np.array_equal(step.proposal.lobe[both][:, 1:-1], trial.lobes[chains[both]][:, : paths.length - 1])
    several = len(world.arrays["lights"]) > 1
    assert (found > 0) == (total > 0) == several and stray <= max(STRAY[laid.case.precision] * total, 1), (found, stray, total)
    if several:
        tally.check(PLAIN, "log pi")


def test_traced_displacements(laid: Laid) -> None:
    """Sampler.displaced, whose rays the tree finds, leads where the oracle's rays, which try every triangle, lead."""
    tally, stray, total = Tally(), 0, 0
    world, settings = laid.world, laid.sampler.settings
    rng = np.random.default_rng(1)
    deltas = np.zeros((laid.sampler.chains, 2 * DEPTH))
    for which, paths in laid.groups:
        n = 2 * paths.free
        which = which[laid.states.kinds[which, 0] >= 0]
        factor = laid.states.factors[which][:, :n, :n].astype(float)
        deltas[which, :n] = 0.1 * np.linalg.solve(np.swapaxes(factor, 1, 2), rng.normal(size=(len(which), n, 1)))[..., 0]
    nodes, _ = laid.sampler.displaced(deltas.astype(laid.states.nodes.dtype))
    deltas = deltas.astype(laid.states.nodes.dtype).astype(float)
    for which, paths in laid.groups:
        m = paths.free

        def moved(p: Paths, _: Any, delta: Array, onto: Array, m: int = m) -> dict[str, Array]:
            charts = Charts(world, p, m, settings, any_tangent(p.v[:, 1]))
            return {"nodes": displaced(charts, delta, onto=onto).paths.x[:, 1:]}

        delta = deltas[which][:, : 2 * m]
        charts = Charts(world, paths, m, settings, any_tangent(paths.v[:, 1]))
        traced = displaced(charts, delta, traced=True)
        kernel = nodes[which][:, : paths.length].astype(float)
        both = traced.exists & np.all(np.isfinite(kernel), axis=(1, 2))
        found = condition(moved, world, paths.take(both), delta[both], traced.paths.triangle[both])["nodes"]
        errors = found.roundings(kernel[both], laid.epsilon)
        near = errors < FACTORED[2]  # else it met another triangle
        total, stray = total + len(which), stray + int((~near).sum())
        tally.add("nodes", errors[near])
    assert len(np.concatenate(tally.errors["nodes"])) > 0.3 * total
    assert stray <= STRAY[laid.case.precision] * total
    tally.check(FACTORED, "nodes")


# --- the resulting state, and negative controls --------------------------------------------------------------------


@pytest.mark.parametrize("name", ["keyhole", "textured"])
def test_step_does_what_trial_says(name: str) -> None:
    """After a step a chain is its trial's proposal, or where it was; trials themselves move nothing."""
    sampler = start_of(name)
    before, trial = sampler.states(), sampler.trial()
    again = sampler.trial()
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(trial, again, strict=True))
    sampler.step(1)
    after = sampler.states()
    nodes = trial.nodes * sampler.compiled.scale + sampler.compiled.centre
    expected = np.where(trial.accepted[:, None, None], nodes, before.nodes)
    assert np.array_equal(after.nodes, expected, equal_nan=True)
    assert np.array_equal(after.log_pi, np.where(trial.accepted, trial.log_pi, before.log_pi))
    assert 0.1 < trial.accepted.mean() < 0.99
    assert np.array_equal(trial.accepted, trial.drawn < trial.acceptance)
    counters = sampler.counters()
    assert np.allclose(counters.acceptance.sum(axis=1), trial.acceptance, rtol=1e-12)
    assert sampler.groups and read_paths(sampler, world_of(sampler))


@pytest.mark.parametrize("fault", FAULTS)
def test_agreement_would_fail(fault: str) -> None:
    """Negative controls: an oracle that is wrong in one step of the derivation, beyond every bound above."""
    settings = {**DEVIATION, "rule": "mean", "drift": True}
    sampler = Sampler(scene_of("keyhole"), precision="single", max_depth=DEPTH, even=False, **settings)
    world = world_of(sampler)
    adopt(sampler, world, states_of("keyhole"))
    groups = list(paths_of(world, sampler.state.arrays()).values())
    chosen = Case("keyhole", "single", {})
    tally, _, _ = small_steps(Laid(chosen, sampler, world, groups, sampler.states(), sampler.trial(STEP)), fault)
    errors = np.concatenate(tally.errors["log reverse"])
    assert np.median(errors) > FACTORED[0] and np.quantile(errors, 0.99) > FACTORED[1]
