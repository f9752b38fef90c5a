"""Lobes: what the kernels draw follows the density that they state."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from oracle.lobes import lobe_density, number
from oracle.lobes.surface import PAIR_OF
from oracle.vectors import Array, dot, unit
from scipy import stats
from studies.lobes import CASES, MATERIALS, NORMAL, Lobes, incoming, is_wide, name_of

from pylmc.scene import RoughConductor

ALPHA = 1e-4  # chance that all χ² tests together fail a right sampler (Šidák)
# a pair's two lobes are one draw, and masking does not enter the sampling
SAMPLED = [
    (index, lobe)
    for index, lobe in CASES
    if is_wide((index, lobe)) and PAIR_OF[lobe] >= 0 and getattr(MATERIALS[index], "masking", "") != "separable"
]


@pytest.fixture(scope="module")
def lobes() -> Lobes:
    return Lobes()


COSINES = (0.8, 0.25, -0.6)


@pytest.mark.parametrize("case", SAMPLED, ids=name_of)
def test_samples_follow_the_density(lobes: Lobes, case: tuple[int, int]) -> None:
    """χ² of sampled directions over cells of the sphere, for each lobe a draw may end in; failures are a cell too."""
    index, lobe = case
    n, cells_z, cells_phi = 200_000, 20, 16
    # of a pair's draw, either of its lobes may come
    outcomes = [other for case, other in CASES if case == index and (other == lobe or (PAIR_OF[lobe] and PAIR_OF[other]))]
    tangent = unit(np.cross(NORMAL, [1.0, 0.0, 0.0]))
    frame = np.stack([tangent, np.cross(NORMAL, tangent), NORMAL])

    def cell(w: Array) -> Array:
        local = w @ frame.T
        z = np.minimum(((local[:, 2] + 1) / 2 * cells_z).astype(int), cells_z - 1)
        phi = ((np.arctan2(local[:, 1], local[:, 0]) / (2 * np.pi)) % 1 * cells_phi).astype(int) % cells_phi
        return z * cells_phi + phi

    # nodes of a midpoint rule inside the cells: their edges are the grid's
    fine = 24
    z = (np.arange(cells_z * fine) + 0.5) / (cells_z * fine) * 2 - 1
    phi = (np.arange(cells_phi * fine) + 0.5) / (cells_phi * fine) * 2 * np.pi
    sine = np.sqrt(1 - z**2)[:, None]
    grid = np.stack([sine * np.cos(phi), sine * np.sin(phi), np.broadcast_to(z[:, None], (len(z), len(phi)))], axis=-1)
    grid = grid.reshape(-1, 3) @ frame
    area = 4 * np.pi / len(grid)
    for draw, cosine in enumerate(COSINES):
        wi = incoming(cosine, NORMAL)
        directions, drawn = lobes.sample(index, lobe, NORMAL, wi, n, 40 + draw)
        assert np.allclose(np.linalg.norm(directions[drawn >= 0], axis=-1), 1, atol=1e-5)
        observed, expected = [], []
        for outcome in outcomes:
            surface = lobes.surface(index, outcome, len(grid), NORMAL, NORMAL)
            density = lobe_density(surface, np.broadcast_to(wi, grid.shape), grid)
            expected.append(np.bincount(cell(grid), density * area, cells_z * cells_phi) * n)
            observed.append(np.bincount(cell(directions[drawn == outcome]), minlength=cells_z * cells_phi))
        expected.append(np.array([max(n - sum(e.sum() for e in expected), 0)]))
        observed.append(np.array([(drawn < 0).sum()]))
        o, e = np.concatenate(observed), np.concatenate(expected)
        assert o.sum() == n
        rare = e < 25
        o, e = np.append(o[~rare], o[rare].sum()), np.append(e[~rare], max(e[rare].sum(), 1.0))
        p = stats.chi2.sf(((o - e) ** 2 / e).sum(), len(e) - 1)
        level = -np.expm1(np.log1p(-ALPHA) / (len(SAMPLED) * len(COSINES)))
        assert p > level, (cosine, p)


def test_narrow_lobe_samples(lobes: Lobes) -> None:
    """At α = 1e-3 the slopes of the sampled microfacet normals follow GGX: its exact CDF at normal incidence."""
    index = next(i for i, m in enumerate(MATERIALS) if isinstance(m, RoughConductor) and m.alpha == 1e-3)
    reflect = number("reflect")
    directions, drawn = lobes.sample(index, reflect, NORMAL, NORMAL, 50_000, 5)
    assert np.all(drawn == reflect)
    facet = unit(directions + NORMAL)
    slope = np.linalg.norm(np.cross(facet, NORMAL), axis=-1) / dot(facet, NORMAL)
    # at normal incidence visible normals have density D cos θ: P(tan θ < s) = s² / (s² + α²)
    cdf: Callable[[Array], Array] = lambda s: s**2 / (s**2 + 1e-6)  # noqa: E731
    assert stats.kstest(slope, cdf).pvalue > ALPHA
