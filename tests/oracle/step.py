"""One Markov step given its random numbers (theory.md, 3 and 6): proposal, log densities, acceptance, resulting state.

``fault`` breaks one step of the derivation on purpose, so that tests can show that they would notice.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pylmc.settings import Settings

from .charts import Charts
from .constraints import proposal_factor
from .displaced import displaced, joint_log_jacobian, keeps_off, visible
from .draw import draw_path, settled
from .independent import light_chances, log_p
from .integrand import log_pi
from .paths import CONNECT, Paths, complete, surface
from .random import Streams
from .rounding import Rounding
from .sampling import sample_light
from .scene import World
from .tangents import Tangents
from .vectors import Array, any_tangent

DRIFT_LIMIT = 1.0  # in units of ξ; drift.cl
FAULTS = ("no determinant", "sign of the reverse drift", "T of the old state")


@dataclass(frozen=True)
class Numbers:
    """What chance decides of a step, for paths of one length: the block m, h, and ξ (n, 2 K).

    A block of 0 is a large step, one longer than any path another light.
    """

    move: Array
    h: Array
    xi: Array


@dataclass(frozen=True)
class Step:
    """Proposals and their log densities, full ones per solid angle of the directions that moved; acceptance in logs.

    ``exists``: whether there is a proposal that carries light; the rest means nothing where there is none.
    """

    proposal: Paths
    exists: Array
    log_forward: Array
    log_reverse: Array
    log_pi: Array
    log_acceptance: Array


def block_allowed(world: World, paths: Paths, m: int, settings: Settings) -> Array:
    """Whether directions 1 … m may move alone: where the path can be joined again between two wide nodes."""
    n = len(paths.light)
    if m == paths.free:
        return np.ones(n, bool)
    if not settings.blocks or settings.coordinates != "target":
        return np.zeros(n, bool)
    wide_next = m + 1 == paths.length or ~surface(world, paths, m + 1).narrow
    return ~surface(world, paths, m).narrow & wide_next


def choose_block(world: World, paths: Paths, settings: Settings, u: Array) -> Array:
    """One of the allowed blocks, all alike."""
    allowed = np.stack([block_allowed(world, paths, m, settings) for m in range(1, paths.free + 1)], axis=1)
    count = allowed.sum(axis=1)
    wanted = np.minimum((u * count).astype(int), count - 1)
    return 1 + np.argmax(allowed & (np.cumsum(allowed, axis=1) == wanted[:, None] + 1), axis=1)


def draw_numbers(world: World, paths: Paths, settings: Settings, streams: Streams) -> Numbers:
    """A step's random numbers from the chains' streams; a large step's own are drawn by draw_path."""
    everyone = np.ones(len(paths.light), bool)
    several = len(world.arrays["lights"]) > 1
    large, relit = settings.large_steps, settings.light_steps * (1 - settings.large_steps) * several
    u = streams.uniform(everyone)
    small = (u >= np.float32(large)) & (u < np.float32(1 - relit) if relit else True)
    move = np.where(small, choose_block(world, paths, settings, streams.uniform(small)), 0)
    move = np.where(~small & (u >= np.float32(large)), settings.max_depth + 1, move)
    low, high = np.log(settings.step_length).astype(np.float32).astype(float)  # as the kernels get them
    h = np.exp(low + (high - low) * streams.uniform(small))
    xi = np.zeros((len(move), 2 * paths.length))
    for k in range(paths.free):
        use = small & (move > k)
        xi[use, 2 * k : 2 * k + 2] = streams.normal2(use)[use]
    return Numbers(move, h, xi)


def drift(charts: Charts, factor: Array, tangents: Tangents, h: Array) -> Array:
    """a δt in units of ξ: (h/2) Tᵀ∇log π, no longer than DRIFT_LIMIT."""
    if not charts.settings.drift:
        return np.zeros((len(h), 2 * charts.m))
    gradient = tangents.gradient()
    a = h[:, None] / 2 * np.linalg.solve(factor, gradient[..., None])[..., 0]
    length = np.linalg.norm(a, axis=1, keepdims=True)
    return np.where(np.isfinite(length), a / np.maximum(length / DRIFT_LIMIT, 1), 0)


def log_gauss(xi: Array) -> Array:
    """log of the standard normal density."""
    return -0.5 * (xi**2).sum(axis=1) - 0.5 * xi.shape[1] * np.log(2 * np.pi)


def small_step(
    world: World,
    paths: Paths,
    m: int,
    settings: Settings,
    h: Array,
    xi: Array,
    fault: str = "",
    onto: Array | None = None,
    rounding: Rounding | None = None,
) -> Step:
    """δX = a δt + h T ξ in the charts of X, xi (n, 2 m), and the density of the way back from X̂ with its own charts.

    Rays look for the proposal's nodes, unless their triangles (n, K+1) are known: ``onto``. rounding: moves
    derivatives and the proposal's nodes.
    """
    charts = Charts(world, paths, m, settings, any_tangent(paths.v[:, 1]))
    tangents = Tangents(charts, rounding)
    factor = proposal_factor(charts, tangents)
    shift = xi + drift(charts, factor, tangents, h)
    delta = h[:, None] * np.linalg.solve(np.swapaxes(factor, 1, 2), shift[..., None])[..., 0]
    moved = displaced(charts, delta, onto is None, onto)
    proposal = moved.paths if rounding is None else rounding.nodes(world, moved.paths)
    log_determinant = np.log(np.einsum("nii->ni", factor)).sum(axis=1)  # of 1 / T
    log_forward = log_gauss(xi) - 2 * m * np.log(h) - moved.log_jacobian - joint_log_jacobian(proposal, m)

    back = Charts(world, proposal, m, settings, moved.frame)
    exists = moved.exists & np.isfinite(log_pi(world, proposal)) & np.all(back.kinds == charts.kinds, axis=1)
    deltas, jacobians = zip(
        *(back.delta(j, paths.x[:, j - 1], paths.v[:, j], charts.omega[:, j]) for j in range(1, m + 1)), strict=True
    )
    delta_back, log_jacobian_back = np.concatenate(deltas, axis=1), np.sum(jacobians, axis=0)
    exists &= np.all(np.isfinite(delta_back), axis=1) & np.isfinite(log_jacobian_back)
    exists &= np.all(np.isfinite(back.omega + charts.omega), axis=(1, 2))
    # the rest on proposals that exist, the others' own paths standing in for them
    sound = exists[:, None, None]
    here = replace(
        proposal,
        **{
            name: np.where(
                exists.reshape(-1, *[1] * (getattr(paths, name).ndim - 1)), getattr(proposal, name), getattr(paths, name)
            )
            for name in ("triangle", "x", "v", "t", "ng", "ns", "tint")
        },
    )
    back = Charts(world, here, m, settings, np.where(exists[:, None], moved.frame, charts.p))
    back_tangents = Tangents(back, rounding)
    back_factor = proposal_factor(back, back_tangents)
    used = factor if fault == "T of the old state" else back_factor
    back_drift = drift(back, used, back_tangents, h)
    if fault == "sign of the reverse drift":
        back_drift = -back_drift
    xi_back = np.einsum("nij,ni->nj", used, np.where(sound[..., 0], delta_back, 0) / h[:, None]) - back_drift
    log_reverse = log_gauss(xi_back) - 2 * m * np.log(h) - log_jacobian_back - joint_log_jacobian(paths, m)
    if fault != "no determinant":
        log_forward = log_forward + log_determinant
        log_reverse = log_reverse + np.log(np.einsum("nii->ni", used)).sum(axis=1)
    new = log_pi(world, proposal)
    log_acceptance = np.where(exists, new + log_reverse - log_pi(world, paths) - log_forward, -np.inf)
    return Step(proposal, exists, log_forward, log_reverse, new, log_acceptance)


def large_step(world: World, paths: Paths, streams: Streams) -> Step:
    """An independent path in place of the state's."""
    proposal, exists = draw_path(world, paths.length, paths.ending, streams)
    stand_in = proposal.take(exists)
    new, forward = np.full((2, len(exists)), -np.inf)
    new[exists], forward[exists] = log_pi(world, stand_in), log_p(world, stand_in)
    reverse = log_p(world, paths)
    with np.errstate(invalid="ignore"):
        log_acceptance = np.where(exists, new - forward - log_pi(world, paths) + reverse, -np.inf)
    return Step(proposal, exists, forward, reverse, new, log_acceptance)


def relit_step(world: World, paths: Paths, streams: Streams) -> Step:
    """The same path, joined to a light that is drawn anew."""
    everyone = np.ones(len(paths.light), bool)
    light = sample_light(world, streams, everyone) if paths.ending == CONNECT else paths.light
    exists = light != paths.light
    proposal = settled(world, complete(world, paths.length, paths.ending, light, paths.triangle, paths.lobe, paths.x))
    new = log_pi(world, proposal)
    exists &= np.isfinite(new) & keeps_off(world, proposal, paths.length) & visible(world, proposal, paths.length)
    chances = np.log(light_chances(world))
    forward, reverse = chances[light], chances[paths.light]
    log_acceptance = np.where(exists, new - forward - log_pi(world, paths) + reverse, -np.inf)
    return Step(proposal, exists, forward, reverse, new, log_acceptance)


def accepted(step: Step, streams: Streams) -> tuple[Array, Array]:
    """(acceptance, whether the proposal becomes the state): the step's last random number decides."""
    acceptance = np.exp(np.minimum(step.log_acceptance, 0))
    possible = acceptance > 0
    return acceptance, possible & (streams.uniform(possible) < acceptance)
