"""One cell of bench.extremes: a scene in one precision, with everything that is asked of it.

Chains start in the target, so that three identities hold whatever the scene, and each is a z-test:

* **b**: the mean of I / p_ind over independent paths, per group, is that of the double reference.
* **film**: chains, after some steps, lie on the film as the reference's weighted independent paths do (4 × 4 blocks).
* **balance**: detailed balance of the small step itself. With r the Hastings ratio of a trial, E[sign(log r) min(1, r)] = 0,
  and E[min(1, r) (g(X^) - g(X))] = 0 for every function g: log pi, v_1, and the sum of the directions here. The picture's
  mean is blind to a broken small step (theory.md, 6, Trap); these are not.

Sides have independent seeds. Paths are the units of b, chains those of the rest, with the start's own error added. Sidak's
correction makes one z of many.
"""

from __future__ import annotations

import time
import warnings
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.stats import norm

from pylmc import PylmcError, PylmcWarning, Sampler, Scene
from pylmc.colour import LUMINANCE

BLOCKS = 4  # per side of the film
BURN, ROUNDS, BETWEEN = 32, 6, 8  # steps of each chain before, and between, its trials
ENOUGH = 30  # effective independent paths (or chains inside a block and outside) below which a mean says nothing of its error
Z_LIMIT = 4.1  # two-sided, alpha = 0.01 over 250 cells
STUCK, FILM_LOSS = 0.01, 1e-3


@dataclass
class Cell:
    """What one precision did with one scene. ``b``: by group, (mean, standard error); ``places``: by group, shares of the
    film's blocks by the independent paths with their errors; ``chains``: the same by the chains; ``acceptance``: by group, sums
    of probabilities and numbers of small steps; ``balance``: by group, z of each identity."""

    refused: str = ""
    warned: bool = False
    seconds: float = 0.0
    bad_pixels: int = 0
    bad_states: int = 0
    bad_weights: int = 0
    not_finite: int = 0
    acceptance: dict[str, tuple[float, float]] = field(default_factory=dict)
    mean: float = 0.0
    film_loss: float = 0.0
    b: dict[str, tuple[float, float]] = field(default_factory=dict)
    effective: dict[str, float] = field(default_factory=dict)
    places: dict[str, tuple[np.ndarray, np.ndarray]] = field(default_factory=dict)
    chains: dict[str, tuple[np.ndarray, np.ndarray]] = field(default_factory=dict)
    chain_counts: dict[str, int] = field(default_factory=dict)
    balance: dict[str, list[float]] = field(default_factory=dict)


def sidak(zs: list[float]) -> float:
    """The two-sided z of the worst of several independent ones, corrected for their number; 0 for none."""
    if not zs:
        return 0.0
    log_p = float(np.log(2) + norm.logsf(np.max(np.abs(zs))))
    if log_p > -20:
        return float(norm.isf(max(-np.expm1(len(zs) * np.log1p(-min(np.exp(log_p), 1 - 1e-16))), 1e-300) / 2))
    return float(np.sqrt(max(-2 * (log_p + np.log(len(zs))), 0)))  # far out: the tail's leading term


def bias(cell: Cell, reference: Cell, groups: list[str] | None = None) -> dict[str, float]:
    """z of b, film and balance against the reference, and the relative difference of b with its error."""
    names = [g for g in reference.b if groups is None or g in groups]
    sound = [g for g in names if min(cell.effective.get(g, 0), reference.effective[g]) >= ENOUGH]
    # a group that one side finds and the other does not is as wrong as can be
    lost = [g for g in names if reference.effective[g] >= ENOUGH and cell.effective.get(g, 0) == 0]
    z_b = [(cell.b[g][0] - reference.b[g][0]) / np.hypot(cell.b[g][1], reference.b[g][1]) for g in sound]
    z_b += [-reference.b[g][0] / reference.b[g][1] for g in lost]
    z_film: list[float] = []
    for g in sound:
        if g in cell.chains:
            # the chains have not forgotten the paths that they began at: their error is in it too
            error = np.sqrt(cell.chains[g][1] ** 2 + cell.places[g][1] ** 2 + reference.places[g][1] ** 2)
            share = reference.places[g][0]
            used = (share * (1 - share) * cell.chain_counts[g] >= ENOUGH) & (error > 0)
            z_film += list((cell.chains[g][0] - share)[used] / error[used])
    total, total_error = summed(cell, names)
    expected, expected_error = summed(reference, names)
    z_balance = [z for g in names for z in cell.balance.get(g, [])]
    zs = {"b": sidak(z_b), "film": sidak(z_film), "balance": sidak(z_balance)}
    whole = expected or float("nan")
    return {
        **zs,
        "worst": sidak([*z_b, *z_film, *z_balance]),
        "judged": bool(sound or lost),
        "relative": (total - expected) / whole,
        "relative_error": float(np.hypot(total_error, expected_error)) / whole,
    }


def acceptance(cell: Cell, names: Any = None) -> float:
    """Mean acceptance of small steps over the named groups; NaN without any."""
    sums = np.zeros(2) + sum(np.array(value) for g, value in cell.acceptance.items() if names is None or g in names)
    return float(sums[0] / sums[1]) if sums[1] > 0 else float("nan")


def summed(cell: Cell, names: Any = None) -> tuple[float, float]:
    """The sum of b over groups, and its standard error."""
    values = [cell.b[g] for g in (cell.b if names is None else names) if g in cell.b]
    return float(sum(b for b, _ in values)), float(np.sqrt(sum(e**2 for _, e in values)))


def run(scene: Scene, precision: str, max_depth: int, seeds: range, candidates: int, chains: int, **settings: Any) -> Cell:
    """Measure one cell; a PylmcError becomes ``refused``. ``settings``: further arguments of Sampler."""
    start, cell = time.perf_counter(), Cell()
    try:
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always", PylmcWarning)
            sampler = Sampler(scene, precision=precision, max_depth=max_depth, even=False, **settings)
        cell.warned = any(issubclass(w.category, PylmcWarning) for w in warned)
        _measure(cell, sampler, seeds, candidates, chains)
    except PylmcError as error:
        cell.refused = str(error)
    cell.seconds = time.perf_counter() - start
    return cell


def _measure(cell: Cell, sampler: Sampler, seeds: range, candidates: int, chains: int) -> None:
    weights: dict[str, list[np.ndarray]] = {}
    positions: dict[str, list[np.ndarray]] = {}
    visits: dict[str, list[np.ndarray]] = {}
    flux: dict[str, list[np.ndarray]] = {}
    every = [group.name for group in sampler.path_groups()]
    for seed in seeds:
        groups = sampler.init(seed, chains, candidates)
        for name in every:
            found = [g for g in groups if g.name == name]
            log_w = found[0].log_weights if found else np.full(candidates, -np.inf)
            cell.bad_weights += int(np.sum(np.isnan(log_w) | (log_w == np.inf)))
            weights.setdefault(name, []).append(np.exp(log_w))
            positions.setdefault(name, []).append(found[0].positions if found else np.zeros((candidates, 2)))
        sampler.step(BURN)
        parts, places = [], []
        counts = np.zeros((2, sampler.chains))
        for _ in range(ROUNDS):
            sampler.step(BETWEEN)
            counters = sampler.counters()
            cell.not_finite += counters.not_finite
            counts += counters.acceptance[:, 1:].sum(axis=1), counters.proposed[:, 1:].sum(axis=1)
            places.append(_blocks(counters.trace))
            parts.append(_fluxes(sampler))
        small = np.isfinite(parts).all(axis=2).sum(axis=0)
        mean_flux = np.nansum(parts, axis=0) / np.where(small > 0, small, np.nan)[:, None]
        shares = np.mean([np.eye(BLOCKS**2 + 1)[place] for place in places], axis=0)[:, :-1]
        for group in groups:
            part = slice(group.first, group.first + group.chains)
            visits.setdefault(group.name, []).append(shares[part])
            flux.setdefault(group.name, []).append(mean_flux[part])
            before = cell.acceptance.get(group.name, (0.0, 0.0))
            cell.acceptance[group.name] = tuple(before + counts[:, part].sum(axis=1))
        image = sampler.image()
        cell.bad_pixels += int(np.sum(~np.isfinite(image)))
        luminance = float(np.mean(image @ LUMINANCE))
        cell.mean += luminance / len(seeds)
        expected = sum(group.b for group in groups) * sampler.compiled.radiance_scale
        cell.film_loss = max(cell.film_loss, abs(luminance / expected - 1))
        cell.bad_states += _bad_numbers(sampler)
    scale = sampler.compiled.radiance_scale
    for name, parts_of in weights.items():
        w = np.concatenate(parts_of)
        if not w.sum() > 0:
            continue
        cell.b[name] = (float(w.mean() * scale), float(w.std() / np.sqrt(len(w)) * scale))
        cell.effective[name] = float(w.sum() ** 2 / np.sum(w**2))
        cell.places[name] = _shares(_blocks(np.concatenate(positions[name])), w)
    for name, visited in visits.items():
        v = np.concatenate(visited)
        cell.chains[name], cell.chain_counts[name] = (v.mean(axis=0), np.sqrt(v.var(axis=0) / len(v))), len(v)
    for name, fluxes in flux.items():
        units = np.concatenate(fluxes)
        units = units[np.isfinite(units).all(axis=1)]
        # chains that all began at a handful of paths are not in their target: they say nothing of balance
        if cell.effective[name] >= ENOUGH and len(units) > ENOUGH:
            # where chains outnumber the effective paths that they began at, they are not independent
            error = units.std(axis=0) * np.sqrt(1 / len(units) + 1 / cell.effective[name])
            cell.balance[name] = [float(m / e) for m, e in zip(units.mean(axis=0), error, strict=True) if e > 0]


def _blocks(positions: np.ndarray) -> np.ndarray:
    """The block of the film that each position (n, 2) is in; BLOCKS² for none."""
    inside = np.isfinite(positions).all(axis=1)
    cells = np.clip(np.where(inside[:, None], positions, 0) * BLOCKS, 0, BLOCKS - 1).astype(int)
    return np.where(inside, cells[:, 1] * BLOCKS + cells[:, 0], BLOCKS**2)


def _shares(blocks: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Each block's share of the weights, and its standard error (a ratio of two means)."""
    sums = np.bincount(blocks, weights, BLOCKS**2 + 1)[:-1] / weights.sum()
    squares = np.bincount(blocks, weights**2, BLOCKS**2 + 1)[:-1]
    variance = (squares * (1 - 2 * sums) + sums**2 * np.sum(weights**2)) / weights.sum() ** 2
    return sums, np.sqrt(np.maximum(variance, 0))


def _fluxes(sampler: Sampler) -> np.ndarray:
    """(chains, 8): one trial's min(1, r) sign(log r) and min(1, r) (g(X^) - g(X)); zero without a proposal, NaN if large."""
    trial, states = sampler.trial(), sampler.states()
    length = states.length
    log_r = (trial.log_pi - states.log_pi) + trial.log_reverse - trial.log_forward
    there = trial.exists & np.isfinite(log_r)
    ratio = np.exp(np.minimum(np.where(there, log_r, -np.inf), 0))

    def observed(directions: np.ndarray, log_pi: np.ndarray) -> np.ndarray:
        inside = np.arange(directions.shape[1])[None, :] < length[:, None]
        total = np.where(inside[:, :, None], directions, 0).sum(axis=1)
        return np.column_stack([log_pi, directions[:, 0], total])

    change = observed(trial.directions, trial.log_pi) - observed(states.directions, states.log_pi)
    flux = np.column_stack([np.sign(log_r) * ratio, ratio[:, None] * change])
    flux[~there] = 0
    flux[trial.move == 0] = np.nan
    return flux


def _bad_numbers(sampler: Sampler) -> int:
    """NaN and infinities in the chains' arrays where there should be numbers, dark chains apart."""
    states, depth = sampler.states(), sampler.settings.max_depth
    lit = states.log_pi > -np.inf
    inside = (np.arange(depth)[None, :] < states.length[:, None]) & lit[:, None]
    inner = (np.arange(depth)[None, :] < states.length[:, None] - 1) & lit[:, None]
    bad = sum(
        int(np.sum(~np.isfinite(array[mask])))
        for array, mask in ((states.nodes, inside), (states.directions, inside), (states.deviations, inner))
    )
    bad += int(np.sum(~np.isfinite(states.factors[lit]))) + int(np.sum(np.isnan(states.log_pi) | (states.log_pi == np.inf)))
    return bad + int(np.sum(~np.isfinite(states.log_p[lit])))


def verdict(cell: Cell, judged: dict[str, Any], small_acceptance: float) -> str:
    """Why a mode has given up at a cell; empty where it has not."""
    if cell.refused:
        return "dark" if cell.refused.startswith("no light path") else "refused"
    if cell.bad_pixels or cell.bad_states or cell.bad_weights:
        return "not finite"
    if judged["worst"] > Z_LIMIT or cell.film_loss > FILM_LOSS:
        return "biased"
    if not judged["judged"]:
        return "unjudged"
    return "stuck" if small_acceptance < STUCK else ""
