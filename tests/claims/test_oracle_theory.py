"""The oracle against what does not come from it: known numbers, central differences, closed recursions, and integrals."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from oracle.charts import DEVIATION, NODE, PROJECTION, Charts, deviation
from oracle.constraints import preconditioner, proposal_factor
from oracle.displaced import Moved, log_climbed, visible
from oracle.draw import draw_path
from oracle.independent import camera_density, emitter_emission_density, log_p, scatter_density
from oracle.integrand import film_direction, importance, log_pi
from oracle.lights import emission_density
from oracle.lobes import AIMS, lobe_density
from oracle.paths import CONNECT, HIT, Paths, complete, surface
from oracle.random import BOOTSTRAP, CHAIN, Streams, philox
from oracle.scene import World
from oracle.step import FAULTS, drift, small_step
from oracle.tangents import Tangents, differences
from oracle.vectors import Array, any_tangent, dot, turn_minimally
from scipy import stats
from studies.probes import textured_scene

import pylmc
from pylmc.sampling.compiled import compile_scene
from pylmc.settings import Settings

SCENES: dict[str, dict[str, float]] = {
    "keyhole": {"hole": 0.3, "alpha": 0.2},
    "glints": {"size": 0.2, "alpha": 0.2},
    "caustic": {"alpha": 0.2},
    "box": {},
    "textured": {},
}


@cache
def world_of(name: str) -> World:
    scene = textured_scene() if name == "textured" else pylmc.load(name, **SCENES[name]).with_size(24, 18)
    return World(compile_scene(scene, "double"))


@cache
def paths_of(name: str, length: int, ending: int, tries: int = 800) -> Paths:
    """Independent paths that carry light, off the edges where a lobe or segment degenerates."""
    world = world_of(name)
    paths, exists = draw_path(world, length, ending, Streams(1, np.arange(tries), length, BOOTSTRAP, False))
    paths = paths.take(exists)
    steep = np.ones(len(paths.light), bool)
    for i in range(1, length + 1):
        steep &= paths.t[:, i] > 0.02
        for j in (i, min(i + 1, length)):
            steep &= (np.abs(dot(paths.ng[:, i], paths.v[:, j])) > 0.1) | (paths.triangle[:, i] < 0)
    return paths.take(steep)


# --- random numbers ------------------------------------------------------------------------------------------------


def test_philox_known_answers() -> None:
    """Random123's own test vectors for philox4x32-10 (kat_vectors)."""
    counters = np.array([[0] * 4, [0xFFFFFFFF] * 4, [0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344]], np.uint32)
    keys = np.array([[0] * 2, [0xFFFFFFFF] * 2, [0xA4093822, 0x299F31D0]], np.uint32)
    known = [
        [0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8],
        [0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD],
        [0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1],
    ]
    assert np.array_equal(philox(counters, keys), np.array(known, np.uint32))


@pytest.mark.parametrize("single", [True, False])
def test_streams_are_uniform_and_normal(single: bool) -> None:
    streams = Streams(3, np.arange(20_000), 7, CHAIN, single)
    everyone = np.ones(20_000, bool)
    assert stats.kstest(streams.uniform(everyone), "uniform").pvalue > 1e-4
    assert stats.kstest(streams.normal2(everyone).ravel(), "norm").pvalue > 1e-4
    only = np.arange(20_000) < 3
    before = streams.used.copy()
    streams.uniform(only)
    assert np.array_equal(streams.used - before, np.where(only, 1 if single else 2, 0))


# --- tangents ------------------------------------------------------------------------------------------------------

SETTINGS = [
    Settings(),
    Settings(coordinates="deviation"),
    Settings(coordinates="deviation", chart="orthographic", projection="orthographic"),
]
CASES = [("keyhole", 4, CONNECT), ("caustic", 4, HIT), ("textured", 3, CONNECT), ("textured", 4, HIT), ("glints", 3, CONNECT)]


def charts_for(name: str, length: int, ending: int, settings: Settings, m: int = 0) -> Charts:
    paths = paths_of(name, length, ending)
    charts = Charts(world_of(name), paths, m or paths.free, settings, any_tangent(paths.v[:, 1]))
    edge = 3.0 if settings.chart == "equal-area" else 0.8  # the charts' are 4 and 1
    inside = np.all(np.nan_to_num((charts.omega**2).sum(axis=-1), nan=9) < edge, axis=1)
    return charts.take(inside)


@pytest.mark.parametrize("settings", SETTINGS, ids=["target", "deviation", "orthographic"])
@pytest.mark.parametrize("name,length,ending", CASES)
def test_tangents_match_central_differences(name: str, length: int, ending: int, settings: Settings) -> None:
    """Five-point differences of step s: truncation s⁴ f⁽⁵⁾ and rounding 2⁻⁵³ / s, 1e-12 at s = 1e-4 where f is mild.

    Derivatives grow as widths shrink: a lobe of α = 0.2 has f⁽⁵⁾ / f' of (1/α)⁴ = 600 and a grazing cosine of 0.1 as
    much again, which makes 1e-10; a wrong term is of order one.
    """
    for m in {0, 1}:
        charts = charts_for(name, length, ending, settings, m)
        assert len(charts.p) > 8
        tangents = Tangents(charts)

        def all_of(moved: Moved) -> Array:
            paths = moved.paths
            parts = [paths.x, paths.v, paths.ns, moved.s]
            return np.concatenate([part.reshape(len(part), -1) for part in parts], axis=1)

        functions = [all_of, lambda moved, charts=charts: log_climbed(charts, moved)]
        for function in functions[: 1 if name == "textured" else 2]:  # the drift leaves textures' slopes out
            exact, measured = tangents.of(function), differences(charts, function, 1e-4)
            own = tuple(range(1, exact.ndim))
            error = np.abs(exact - measured).max(axis=own) / (1 + np.abs(exact).max(axis=own))
            assert np.median(error) < 1e-9 and np.quantile(error, 0.9) < 1e-6, (m, np.quantile(error, [0.5, 0.9, 1]))


@pytest.mark.parametrize("name,length,ending", CASES)
def test_tangents_obey_section_4(name: str, length: int, ending: int) -> None:
    """dx_k = (1 - v nᵀ/(v·n)) (dx_{k-1} + t dv_k); at the end of *connect* dv_{N+1} = -(1 - v vᵀ) dx_N / r, eq. (15)."""
    charts = charts_for(name, length, ending, Settings(coordinates="deviation"))
    tangents, base = Tangents(charts), charts.base
    dx, dv = tangents.of(lambda moved: moved.paths.x), tangents.of(lambda moved: moved.paths.v)
    for k in range(1, base.free + 1):
        v, n, t = base.v[:, k], base.ng[:, k], base.t[:, k]
        moved = dx[:, k - 1] + t[:, None, None] * dv[:, k]
        along = np.einsum("ni,nik->nk", n, moved) / dot(v, n)[:, None]
        assert np.allclose(dx[:, k], moved - v[..., None] * along[:, None], rtol=1e-9, atol=1e-9)
    if ending == CONNECT:
        v, arriving = base.v[:, -1], dx[:, -2]
        across = arriving - v[..., None] * np.einsum("ni,nik->nk", v, arriving)[:, None]
        assert np.allclose(dv[:, -1], -across / base.t[:, -1, None, None], rtol=1e-9, atol=1e-9)


def test_factor_is_that_of_q() -> None:
    """L from a QR factorisation of the rows and Q from their products are one thing, for every rule."""
    for rule in ("sum", "mean", "rms"):
        charts = charts_for("keyhole", 4, CONNECT, Settings(rule=rule))
        factor, q = proposal_factor(charts), preconditioner(charts)
        size = np.sqrt(np.einsum("nii->ni", q))
        error = (factor @ np.swapaxes(factor, 1, 2) - q) / size[:, :, None] / size[:, None]
        assert np.abs(error).max() < 1e-12


# --- integrals -----------------------------------------------------------------------------------------------------


def sphere(n: int) -> tuple[Array, Array]:
    """Unit vectors all round and their weights: Gauss and Legendre in cos θ, midpoints in φ."""
    z, w = np.polynomial.legendre.leggauss(n)
    phi = (np.arange(n) + 0.5) * 2 * np.pi / n
    flat = np.sqrt(1 - z**2)[:, None, None] * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    v = np.concatenate([flat, np.broadcast_to(z[:, None, None], (n, n, 1))], axis=-1)
    return v.reshape(-1, 3), np.repeat(w * 2 * np.pi / n, n)


def integral(density: Callable[[Array], Array], axis: Array, half_angle: float = np.pi, n: int = 150) -> float:
    """∫ density dσ over the cone about a unit axis, finer towards the axis."""
    z, w = np.polynomial.legendre.leggauss(n)
    u = (z + 1) / 2
    theta, slope = half_angle * u**2, half_angle * u * w  # dθ = 2 half u du, du = w / 2
    phi = (np.arange(n) + 0.5) * 2 * np.pi / n
    tangent = any_tangent(axis[None])[0]
    frame = np.stack([tangent, np.cross(axis, tangent), axis])
    flat = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    v = np.concatenate([np.sin(theta)[:, None, None] * flat, np.broadcast_to(np.cos(theta)[:, None, None], (n, n, 1))], axis=-1)
    weights = np.repeat(slope * np.sin(theta) * 2 * np.pi / n, n)
    return float(np.nansum(density(v.reshape(-1, 3) @ frame) * weights))


def repeated(paths: Paths, which: int, times: int) -> Paths:
    return paths.take(np.full(times, which))


@pytest.mark.parametrize("settings", SETTINGS, ids=["target", "deviation", "orthographic"])
@pytest.mark.parametrize("name,length,ending", [("keyhole", 3, CONNECT), ("caustic", 3, HIT)])
def test_small_step_density_integrates_to_one(name: str, length: int, ending: int, settings: Settings) -> None:
    """∫ p(v̂_j | X, the directions before it) dσ(v̂_j) over the sphere, with the state's own T, for each free direction.

    One direction moves alone: the others' ξ are zero, and the j-th pair has the density that its own block of L gives it.
    Charts that reach part of the sphere only lose what ξ carries beyond: nothing at this h.
    """
    charts = charts_for(name, length, ending, settings)
    seen = set()
    h = 0.2
    for j in range(1, charts.m + 1):
        for kind in np.unique(charts.kinds[:, j]):
            which = int(np.flatnonzero(charts.kinds[:, j] == kind)[0])
            block = proposal_factor(charts)[which][2 * j - 2 : 2 * j, 2 * j - 2 : 2 * j]
            axis = charts.base.v[which, j]

            def density(v: Array, j: int = j, which: int = which, block: Array = block) -> Array:
                many = charts.take(np.full(len(v), which))
                s, frame = many.anchor[:, j], many.e1[:, j]
                from_node = many.base.x[:, j - 1]
                deviates = many.kinds[0, j] == DEVIATION
                omega = deviation(v, s, frame, settings.chart) if deviates else np.zeros((len(v), 2))
                delta, log_jacobian = many.delta(j, from_node, v, omega)
                xi = np.einsum("ij,ni->nj", block, delta) / h
                with np.errstate(over="ignore", invalid="ignore"):
                    return np.exp(-0.5 * (xi**2).sum(axis=1) - log_jacobian) * np.linalg.det(block) / (2 * np.pi * h**2)

            assert integral(density, axis) == pytest.approx(1, abs=2e-3), (j, kind)
            seen.add(int(kind))
    assert seen >= ({PROJECTION} if settings.coordinates == "deviation" else {NODE})


@pytest.mark.parametrize("name", ["keyhole", "glints", "textured", "caustic"])
def test_independent_densities_integrate_to_one(name: str) -> None:
    """Camera, light and nodes, aiming included: what each draws from is a density on the sphere of directions.

    The film and the rectangles that are aimed at have edges, which a product rule of n² directions sees to about 1 / n.
    """
    world = world_of(name)
    ending = HIT if name == "caustic" else CONNECT
    paths = paths_of(name, 3, ending)
    v, weight = sphere(400)
    assert (camera_density(world, v) * weight).sum() == pytest.approx(1, abs=2e-2)
    if ending == CONNECT:
        density = emission_density(world, np.zeros(len(v), int), paths.x[0, -1] + v, v)
    else:
        density = emitter_emission_density(world, *(np.broadcast_to(a[0, -1], v.shape) for a in (paths.x, paths.ng)), v)
    assert (density * weight).sum() == pytest.approx(1, abs=2e-2)
    wanted = AIMS[surface(world, paths, 1).lobe]
    for portal in world.arrays["portals"]:  # from its own plane a portal is nowhere
        wanted &= np.abs((paths.x[:, 1] - portal["centre"]) @ portal["normal"]) > 0.05
    node = repeated(paths, int(np.flatnonzero(wanted)[0]), len(v))
    assert (scatter_density(world, node, 1, -node.v[:, 1], v) * weight).sum() == pytest.approx(1, abs=2e-2)


@pytest.mark.parametrize("name,length,ending", [("keyhole", 3, CONNECT), ("caustic", 4, HIT), ("textured", 3, CONNECT)])
def test_lobe_densities_integrate_to_one(name: str, length: int, ending: int) -> None:
    """Lobes' own sampling: one for a diffuse lobe; at most one for the others, which lose what ends below the surface."""
    world, paths = world_of(name), paths_of(name, length, ending)
    seen = set()
    for which, lobe in enumerate(paths.lobe[:, 1]):
        if lobe in seen:
            continue
        seen.add(lobe)

        def density(v: Array, which: int = which) -> Array:
            here = surface(world, repeated(paths, which, len(v)), 1)
            return lobe_density(here, np.broadcast_to(-paths.v[which, 1], v.shape), v)

        total = integral(density, paths.v[which, 2])
        assert total < 1 + 2e-3 and (not AIMS[lobe] or total > 1 - 2e-3)
    assert any(AIMS[lobe] for lobe in seen) and len(seen) > 1


def test_drawn_paths_have_the_density_log_p() -> None:
    """E[I / p_ind] over drawn paths is ∫ I, found on a grid over the film: one node between camera and lamp."""
    world, n, side = world_of("textured"), 6000, 60
    paths, exists = draw_path(world, 2, CONNECT, Streams(5, np.arange(n), 0, BOOTSTRAP, False))
    weights = np.zeros(n)
    weights[exists] = np.exp(log_pi(world, paths.take(exists)) - log_p(world, paths.take(exists)))
    assert exists.mean() > 0.3
    cells = (np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2) + 0.5) / side
    v = film_direction(world, cells)
    t, hit = world.cast(np.broadcast_to(world.origin, v.shape), v)
    v, t, hit = v[hit >= 0], t[hit >= 0], hit[hit >= 0]
    x = np.zeros((len(hit), 3, 3))
    x[:, 0], x[:, 1] = world.origin, world.origin + t[:, None] * v
    triangle = np.full((len(hit), 3), -1)
    triangle[:, 1] = hit
    total = 0.0
    for lobe in range(len(AIMS)):
        grid = complete(world, 2, CONNECT, np.zeros(len(hit), int), triangle, np.where(triangle >= 0, lobe, -1), x)
        seen = surface(world, grid, 1).has_lobe
        if not seen.any():
            continue
        seen &= visible(world, grid, 2)
        total += np.where(seen, np.exp(log_pi(world, grid)) / importance(world, v), 0).sum() / len(cells)
    z = (weights.mean() - total) / np.hypot(weights.std() / np.sqrt(n), 0.01 * total)  # cells on shadows' edges: 1 %
    assert 2 * stats.norm.sf(abs(z)) > 1e-4, (weights.mean(), total)


# --- the step ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("drifts", [False, True])
@pytest.mark.parametrize("coordinates", ["target", "deviation"])
def test_step_back_is_the_reverse(coordinates: str, drifts: bool) -> None:
    """The step from X̂ that leads to X, as a step forward from X̂ in its own frame, has the density that was its reverse's."""
    world, settings = world_of("keyhole"), Settings(drift=drifts, coordinates=coordinates)
    paths = paths_of("keyhole", 4, CONNECT)
    m = paths.free
    xi = np.random.default_rng(2).normal(size=(len(paths.light), 2 * m))
    forth = small_step(world, paths, m, settings, np.full(len(xi), 0.05), xi)
    start, there = paths.take(forth.exists), forth.proposal.take(forth.exists)
    h, p = np.full(len(start.light), 0.05), any_tangent(there.v[:, 1])
    charts = Charts(world, there, m, settings, p)
    aligned = Charts(world, start, m, settings, turn_minimally(p, there.v[:, 1], start.v[:, 1]))
    way = [charts.delta(j, start.x[:, j - 1], start.v[:, j], aligned.omega[:, j])[0] for j in range(1, m + 1)]
    factor = proposal_factor(charts)
    shift = np.einsum("nij,ni->nj", factor, np.concatenate(way, axis=1)) / h[:, None]
    back = small_step(world, there, m, settings, h, shift - drift(charts, factor, Tangents(charts), h))
    assert len(h) > 8 and back.exists.all()
    assert np.abs(back.proposal.x - start.x).max() < 1e-8
    assert np.abs(back.log_forward - forth.log_reverse[forth.exists]).max() < 1e-6
    assert np.abs(back.log_reverse - forth.log_forward[forth.exists]).max() < 1e-6
    assert np.abs(back.log_acceptance + forth.log_acceptance[forth.exists]).max() < 1e-6


@pytest.mark.parametrize("fault", FAULTS)
def test_faults_are_faults(fault: str) -> None:
    """Each switch changes the acceptance of most steps."""
    world, settings = world_of("keyhole"), Settings(drift=True)
    paths = paths_of("keyhole", 4, CONNECT)
    xi = np.random.default_rng(3).normal(size=(len(paths.light), 2 * paths.free))
    h = np.full(len(xi), 0.2)
    right, wrong = (small_step(world, paths, paths.free, settings, h, xi, f) for f in ("", fault))
    assert right.exists.sum() > 8 and np.array_equal(right.exists, wrong.exists)
    chosen = right.exists
    assert np.median(np.abs(right.log_acceptance[chosen] - wrong.log_acceptance[chosen])) > 1e-3
