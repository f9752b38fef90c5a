"""Lobes: value and density of the kernels against float64 formulas, reciprocity, and what is known of their integrals.

Quadratures are products of Gauss-Legendre in cos θ and the midpoint rule in φ, good to 1e-3 for the widths
used. Known totals come from integrals over microfacet normals, not over directions: another way to the same number.
"""

from __future__ import annotations

import numpy as np
import pytest
from oracle.lobes import KINDS, NAMES, lobe_density, lobe_value
from oracle.lobes.facets import half_vector
from oracle.lobes.surface import REFERENCE_OF
from oracle.vectors import Array, dot, sphere, unit
from studies.lobes import CASES, MATERIALS, NORMAL, Lobes, incoming, is_wide, name_of

EPS = float(np.finfo(np.float32).eps)
WIDE = [case for case in CASES if is_wide(case)]


@pytest.fixture(scope="module")
def lobes() -> Lobes:
    return Lobes()


def refracts(lobe: int) -> bool:
    return NAMES[lobe] == "dielectric_transmit"


@pytest.mark.parametrize("case", CASES, ids=name_of)
def test_values_and_densities(lobes: Lobes, case: tuple[int, int]) -> None:
    """f |cos| and the sampling density, on and off the lobe's peak, shading normals off the geometric one included."""
    index, lobe = case
    rng = np.random.default_rng(index * 10 + lobe)
    n = 4000

    def single(a: Array) -> Array:
        return a.astype(np.float32).astype(float)

    ng = single(unit(rng.normal(size=(n, 3))))
    ns = single(unit(ng + 0.2 * rng.normal(size=(n, 3))))
    wi = single(unit(rng.normal(size=(n, 3))))
    surface = lobes.surface(index, lobe, n, ng, ns)
    alpha = np.maximum(surface.material["alpha"].astype(float), 1e-3)
    side = np.sign(dot(ns, wi))[:, None]
    # half of the directions near the peak: about a microfacet normal that is a few α off
    facet = unit(side * ns + 2 * alpha[:, None] * rng.normal(size=(n, 3)))
    peak = unit(KINDS[lobe].peak(surface, wi, facet))
    wo = single(np.where(np.arange(n)[:, None] % 2, peak, unit(rng.normal(size=(n, 3)))))
    value, density = lobes.evaluate(index, lobe, ng, ns, wi, wo)
    expected, expected_density = lobe_value(surface, wi, wo), lobe_density(surface, wi, wo)
    # Relative error: the microfacet normal is a sum of unit vectors, so its rounding is EPS / |m|; log D turns by at
    # most 4 / α per radian; cosines in denominators carry EPS / cos. Thirty-two of each for some fifty operations.
    bend = surface.index_ratio(wi)[:, None] if refracts(lobe) else 1.0
    m = wi + bend * wo
    size = np.linalg.norm(m, axis=-1)
    facet = m / np.maximum(size, 1e-9)[:, None]
    near = np.abs(np.stack([dot(ns, wi), dot(ns, wo), dot(facet, wi), dot(facet, wo), dot(facet, ns)]))
    least = np.min(np.stack([*near, np.abs(dot(ng, wi)), np.abs(dot(ng, wo))]), axis=0)
    # the Jacobian's denominator in refraction is |m| (n_i im + n_o om) and vanishes nowhere else
    bound = 32 * EPS * (1 + (4 / alpha if REFERENCE_OF[lobe] != "normal" else 0) / np.maximum(size, 1e-9)) / least
    if refracts(lobe):  # near the critical angle 1 - F is the root of a difference
        bound /= least
    proper = least > 1e-3  # beyond it the side itself is a matter of rounding
    for got, want in ((value, expected), (density[:, None], expected_density[:, None])):
        error = np.abs(got - want)[proper]
        allowed = bound[proper, None] * np.abs(want[proper]) + 1e-30
        assert np.all(error <= allowed), (error / allowed).max()
    assert (expected.sum(axis=1) > 0).mean() > 0.1


@pytest.mark.parametrize("case", CASES, ids=name_of)
def test_reciprocity(lobes: Lobes, case: tuple[int, int]) -> None:
    """f(w_i, w_o) = f(w_o, w_i) in reflection; in refraction the same after division by the square of w_i's index."""
    index, lobe = case
    rng = np.random.default_rng(3)
    wi, wo = unit(rng.normal(size=(2, 3000, 3)))
    cosines = dot(NORMAL, wi), dot(NORMAL, wo)
    keep = np.all(np.abs(cosines) > 0.05, axis=0)
    wi, wo, ci, co = wi[keep], wo[keep], cosines[0][keep], cosines[1][keep]
    forth, _ = lobes.evaluate(index, lobe, NORMAL, NORMAL, wi, wo)
    back, _ = lobes.evaluate(index, lobe, NORMAL, NORMAL, wo, wi)
    scale = np.ones(len(wi))
    if refracts(lobe):
        ior = MATERIALS[index].ior
        # the normal's side is outside, of index one: index of w_i's medium squared, for both orders
        scale = np.where(ci > 0, 1.0, ior) ** 2 / np.where(co > 0, 1.0, ior) ** 2
    f, g = forth / np.abs(co)[:, None], back * scale[:, None] / np.abs(ci)[:, None]
    lit = (f > 0).any(axis=1)
    assert lit.mean() > 0.02 and np.array_equal(f > 0, g > 0)
    least = np.ones(len(wi))
    if refracts(lobe):  # near the critical angle 1 - F is the root of a difference
        surface = lobes.facing(index, lobe, len(wi))
        m = half_vector(surface.normal_towards(wi), wi, wo, surface.index_ratio(wi))
        least = np.minimum(np.abs(dot(m, wi)), np.abs(dot(m, wo)))
    alpha = max(getattr(MATERIALS[index], "alpha", 1.0), 1e-3)
    assert np.all(np.abs(f - g)[lit] <= (2e-5 / alpha / least**2)[lit, None] * f[lit])


@pytest.mark.parametrize("case", WIDE, ids=name_of)
@pytest.mark.parametrize("cosine", [0.9, 0.3, -0.5])
def test_totals(lobes: Lobes, case: tuple[int, int], cosine: float) -> None:
    """The density's and the value's integrals over the sphere: sampled mass and albedo, known and never above one."""
    index, lobe = case
    wi = incoming(cosine, NORMAL)
    wo, weight = sphere(160, 320, NORMAL)
    value, density = lobes.evaluate(index, lobe, NORMAL, NORMAL, wi, wo)
    known_mass, known_albedo = KINDS[lobe].totals(lobes.facing(index, lobe), wi)
    mass = density @ weight
    assert mass == pytest.approx(known_mass, abs=2e-3) and mass <= 1 + 1e-3
    assert weight @ value == pytest.approx(known_albedo, abs=2e-3)


@pytest.mark.parametrize(
    "index", sorted({index for index, _ in WIDE}), ids=lambda index: str(MATERIALS[index]).replace(" ", "")
)
def test_white_furnace(lobes: Lobes, index: int) -> None:
    """All lobes of a material together give out no more power than arrives, and draw with a probability of one at most."""
    wo, weight = sphere(160, 320, NORMAL)
    for cosine in (0.95, 0.4, -0.8):
        wi = incoming(cosine, NORMAL)
        power, drawn = np.zeros(3), 0.0
        for lobe in [lobe for case, lobe in CASES if case == index]:
            value, density = lobes.evaluate(index, lobe, NORMAL, NORMAL, wi, wo)
            surface = lobes.facing(index, lobe)
            # radiance is stretched by η² on the way into a medium; what is conserved is power
            power += weight @ value * (surface.index_ratio(wi[None])[0] ** 2 if refracts(lobe) else 1)
            drawn += surface.choice[0] * (weight @ density)
        assert np.all(power <= 1 + 2e-3) and drawn <= 1 + 2e-3
