"""The kernels in pairs of floats against the same kernels in float64: densities, factors, nodes, candidates, pictures.

How near a result must be follows from how it depends on the state. A sound computation in pairs gives what an exact one
would give for data that are off by a few times 2^-44, so each quantity Q of a chain may be off by ``ALLOWED`` * 2^-44 times

    |Q| + max |dQ / d(relative change of the state's numbers)|,

where the second term is measured in float64, by changing every direction, length and barycentric coordinate at random.
"""

from __future__ import annotations

from typing import Any
from unittest.mock import patch

import numpy as np
import pytest

import pylmc
from pylmc import Sampler, load
from pylmc.device import program
from pylmc.device.survey import select
from pylmc.sampling.chains import resume
from pylmc.sampling.evenness import GRID
from pylmc.sampling.groups import Group
from pylmc.sampling.states import ChainArrays, States

CHANGE = 2.0**-30  # relative, of the state's numbers: far above float64's rounding, far below where Q bends
DRAWS = 8
ALLOWED = 4  # roundings of 2^-44 that a path's data and the scene's may add up to
QUANTITIES = ("nodes", "directions", "deviations", "log_pi", "log_p", "factors", "gradients")
SETTINGS: dict[str, Any] = {"even": False, "drift": True}

pytestmark = pytest.mark.skipif("cl_khr_fp64" not in select(None).extensions, reason="needs fp64 to compare with")


def by_chain(array: np.ndarray) -> np.ndarray:
    """The greatest magnitude of each chain's entries, those that do not exist left out."""
    return np.max(np.abs(np.nan_to_num(array.reshape(len(array), -1))), axis=1)


def states_of(sampler: Sampler, chains: ChainArrays, groups: list[Group]) -> States:
    """``sampler``'s view of chains that may be another one's."""
    sampler.resume(resume(sampler.device_scene, chains, groups, np.ones((GRID, GRID), np.float32)))
    return sampler.states()


def changed(chains: ChainArrays, rng: np.random.Generator) -> ChainArrays:
    """The chains with each of their numbers changed by CHANGE, up or down."""
    numbers = {name: getattr(chains, name) for name in ("v", "t", "barycentrics")}
    return chains._replace(**{name: x * (1 + CHANGE * rng.choice([-1.0, 1.0], x.shape)) for name, x in numbers.items()})


def check_states(pairs: Sampler, double: Sampler, chains: ChainArrays, groups: list[Group]) -> None:
    """The chains look the same from both."""
    got, exact = states_of(pairs, chains, groups), states_of(double, chains, groups)
    rng = np.random.default_rng(0)
    others = [states_of(double, changed(chains, rng), groups) for _ in range(DRAWS)]
    for name in ("length", "ending", "lobes", "kinds"):
        np.testing.assert_array_equal(getattr(got, name), getattr(exact, name), err_msg=name)
    worst = {}
    for name in QUANTITIES:
        reference, value = getattr(exact, name), getattr(got, name)
        np.testing.assert_array_equal(np.isnan(value), np.isnan(reference), err_msg=name)
        slope = np.max([by_chain(getattr(other, name) - reference) for other in others], axis=0) / CHANGE
        error = by_chain(value - reference)
        worst[name] = float(np.max(error / np.maximum(by_chain(reference) + slope, 1e-300))) * 2.0**44
        print(f"{name}: error at most {np.max(error):.2g}, which is {worst[name]:.2g} roundings of its data")
    assert max(worst.values()) <= ALLOWED, worst


def check_candidates(pairs: Sampler, double: Sampler) -> None:
    """The same random numbers draw the same paths, of the same weights, but for those on the edge of existence."""
    for ours, theirs in zip(pairs.weigh(4096, seed=3), double.weigh(4096, seed=3), strict=True):
        found = np.isfinite(ours.log_weights) & np.isfinite(theirs.log_weights)
        assert np.mean(np.isfinite(ours.log_weights) == np.isfinite(theirs.log_weights)) > 0.999, ours.name
        error = np.abs(ours.log_weights[found] - theirs.log_weights[found])
        if found.sum():
            print(f"{ours.name}: {found.sum()} paths, log weights off by {np.median(error):.2g}, at most {error.max():.2g}")
            assert np.median(error) <= 2.0**-40 and error.max() <= 2.0**-24, ours.name


def check_pictures(pairs: Sampler, double: Sampler) -> None:
    """Chains of the same seed take the same steps, since uniform numbers do not often fall between two roundings."""
    for sampler in (pairs, double):
        sampler.init(seed=2, chains=64, candidates=4096)
        sampler.step(32)
    ours, theirs = pairs.counters(), double.counters()
    np.testing.assert_array_equal(ours.proposed, theirs.proposed)
    np.testing.assert_allclose(ours.acceptance, theirs.acceptance, rtol=0, atol=1e-8)
    np.testing.assert_allclose(pairs.image(), double.image(), rtol=1e-5, atol=1e-5 * double.image().max())


def samplers(name: str, depth: int) -> tuple[Sampler, Sampler]:
    pairs, double = (Sampler(load(name), precision=p, max_depth=depth, **SETTINGS) for p in ("float-float", "mixed"))
    return pairs, double


def started(sampler: Sampler) -> tuple[ChainArrays, list[Group]]:
    """New chains, and whose they are."""
    groups = sampler.init(seed=1, chains=512, candidates=1 << 13)
    return sampler.state.arrays(), groups


def test_pairs_compute_what_float64_does():
    pairs, double = samplers("box", 3)
    check_candidates(pairs, double)
    check_pictures(pairs, double)
    chains, groups = started(pairs)
    check_states(pairs, double, chains, groups)

    # the control: with products' rounding lost it is no longer so
    original = program.source
    term = "FF_PRODUCT_ERROR(P, x.hi, y.hi, product) + cross"
    assert term in original("number/float_float.cl")
    broken = Sampler(load("box"), precision="float-float", max_depth=3, **SETTINGS)
    with patch.object(program, "source", lambda name, files=None: original(name, files).replace(term, "cross")):
        broken.device_scene.kernel("entry/inspect.cl", "describe_chains")
    with pytest.raises(AssertionError, match="'log_pi'"):
        check_states(broken, double, chains, groups)


@pytest.mark.long
@pytest.mark.parametrize("name", ["keyhole", "caustic", "glints"])
def test_pairs_compute_what_float64_does_in_every_scene(name):
    pairs, double = samplers(name, 5)
    check_candidates(pairs, double)
    check_pictures(pairs, double)
    check_states(pairs, double, *started(pairs))


@pytest.mark.long
@pytest.mark.parametrize("integrator", ["path", "bdpt"])
def test_baselines_draw_the_same_picture(integrator):
    """Sample by sample, up to the few paths that rounding puts on the other side of an edge."""
    scene = load("box", width=24, height=24)
    budget: dict[str, Any] = {"mutations_per_pixel": 8, "max_depth": 4, "progress": False}
    images = [pylmc.render(scene, integrator=integrator, precision=p, **budget).image for p in ("float-float", "mixed")]
    assert np.mean(np.isclose(images[0], images[1], rtol=1e-5, atol=1e-5 * images[1].max())) > 0.99
