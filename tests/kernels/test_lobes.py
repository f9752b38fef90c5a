"""Lobes: value, density and sampling of the kernels against float64 formulas, and the laws that they must obey.

Quadratures are products of Gauss-Legendre in cos θ and the midpoint rule in φ, good to 1e-3 for the widths
used. Known totals come from integrals over microfacet normals, not over directions: another way to the same number.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest
from oracle.lobes import (
    DIELECTRIC_REFLECT,
    DIFFUSE,
    REFLECT,
    TRANSMIT,
    Surface,
    half_vectors,
    lobe_density,
    lobe_value,
)
from oracle.materials import side_by_side
from oracle.microfacet import fresnel, ggx_d_at, smith_lambda
from oracle.vectors import Array, dot, mirror, unit
from scipy import stats
from studies.probes import build_probe

from pylmc.device.device_scene import DeviceScene
from pylmc.sampling.compiled import CompiledScene, compile_scene
from pylmc.scene import (
    Camera,
    Diffuse,
    MetallicRoughness,
    PointLight,
    RoughConductor,
    RoughDielectric,
    Scene,
    Shape,
)
from pylmc.settings import Settings

ALPHA = 1e-4  # chance that all χ² tests together fail a right sampler (Šidák)
EPS = float(np.finfo(np.float32).eps)

MATERIALS = [
    Diffuse((0.2, 0.5, 0.8)),
    *(
        RoughConductor(alpha, (0.9, 0.8, 0.7), masking)
        for alpha in (1.0, 0.3, 0.05, 1e-3)
        for masking in ("height-correlated", "separable")
    ),
    *(
        RoughDielectric(alpha, ior, masking)
        for alpha, ior in ((0.5, 1.5), (0.2, 1.5), (0.3, 0.75), (0.05, 1.33))
        for masking in ("height-correlated", "separable")
    ),
    MetallicRoughness((0.9, 0.4, 0.1), 0.3, 0.6),
    MetallicRoughness((0.9, 0.4, 0.1), 1.0, 0.8),
]

SOURCE = """
#include "number/vectors.cl"
#include "lobes/lobes.cl"

Vertex probe_vertex(const Scene *scene, int material, int lobe, int i, __global const float *normal_pairs) {
    Vertex vertex;
    vertex.x = (float3)(0.0f);
    vertex.ng = load3(normal_pairs, 2 * i);
    vertex.ns = load3(normal_pairs, 2 * i + 1);
    vertex.tint = (float3)(1.0f);
    vertex.material = material;
    vertex.lobe = lobe_like(scene, material, lobe);
    return vertex;
}

__kernel void probe_values(SCENE_PARAMETERS, int count, int material, int lobe, __global const float *normal_pairs,
                           __global const float *wi, __global const float *wo, __global float *value,
                           __global float *density) {
    int i = get_global_id(0);
    if (i >= count) return;
    Scene scene = SCENE_BUNDLE;
    Vertex vertex = probe_vertex(&scene, material, lobe, i, normal_pairs);
    float scale;
    float3 colour = lobe_value(&scene, &vertex, load3(wi, i), load3(wo, i), &scale);
    vstore3(colour * scale, i, value);
    density[i] = lobe_density(&scene, &vertex, load3(wi, i), load3(wo, i));
}

__kernel void probe_samples(SCENE_PARAMETERS, int count, int material, int lobe, __global const float *normal_pairs,
                            __global const float *known, uint seed, __global float *other, __global int *lobes_out) {
    int i = get_global_id(0);
    if (i >= count) return;
    Scene scene = SCENE_BUNDLE;
    Vertex vertex = probe_vertex(&scene, material, lobe, 0, normal_pairs);
    Rng rng = rng_open(seed, i, 0, 77u);
    float3 direction;
    bool ok = lobe_sample(&scene, &vertex, load3(known, 0), &rng, &direction);
    vstore3(direction, i, other);
    lobes_out[i] = ok ? scene.lobes[vertex.lobe].signature : -1;
}
"""


class Lobes:
    """The kernels' lobe functions over arrays, in a scene that has every material."""

    def __init__(self) -> None:
        triangle = np.eye(3)
        shapes = [Shape((triangle + i, [[0, 1, 2]]), material) for i, material in enumerate(MATERIALS)]
        scene = Scene(Camera((0, 0, 9), (0, 0, 0)), shapes, [PointLight((0, 5, 0))], portals=())
        self.compiled: CompiledScene = compile_scene(scene)
        self.device = DeviceScene(self.compiled, Settings(max_depth=2))
        # no targets: the lobes' own sampling, without aiming
        self._values = build_probe(self.device, SOURCE, "probe_values", NUM_TARGETS=0)
        self._samples = build_probe(self.device, SOURCE, "probe_samples", NUM_TARGETS=0)

    def surface(self, material: int, lobe: int, n: int, ng: Array, ns: Array) -> Surface:
        arrays = self.compiled.arrays
        record = side_by_side(arrays["materials"], arrays["lobes"])[arrays["triangles"]["material"][material]]
        ng, ns = np.broadcast_to(ng, (n, 3)), np.broadcast_to(ns, (n, 3))
        return Surface(np.zeros((n, 3)), ng, ns, np.ones((n, 3)), np.full(n, record), np.full(n, lobe))

    def index(self, material: int) -> np.int32:
        return np.int32(self.compiled.arrays["triangles"]["material"][material])

    def evaluate(self, material: int, lobe: int, ng: Array, ns: Array, wi: Array, wo: Array) -> tuple[Array, Array]:
        """(f |cos| as RGB, density) from the kernels; directions broadcast."""
        n = max(len(np.atleast_2d(wi)), len(np.atleast_2d(wo)))
        wi, wo, ng, ns = (np.broadcast_to(a, (n, 3)).astype(np.float32) for a in (wi, wo, ng, ns))
        device = self.device
        value, density = device.zeros(12 * n), device.zeros(4 * n)
        inputs = [device.upload(a) for a in (np.stack([ng, ns], axis=1), wi, wo)]
        device.launch(self._values, n, np.int32(n), self.index(material), np.int32(lobe), *inputs, value, density)
        return device.read(value, np.float32, (n, 3)).astype(float), device.read(density, np.float32, n).astype(float)

    def sample(self, material: int, lobe: int, ns: Array, known: Array, n: int, seed: int) -> tuple[Array, Array]:
        """(directions, lobes; lobe -1 where the draw failed)."""
        device = self.device
        other, lobes = device.zeros(12 * n), device.zeros(4 * n)
        normals = np.stack([ns, ns]).astype(np.float32)
        device.launch(
            self._samples,
            n,
            np.int32(n),
            self.index(material),
            np.int32(lobe),
            device.upload(normals),
            device.upload(known.astype(np.float32)),
            np.uint32(seed),
            other,
            lobes,
        )
        return device.read(other, np.float32, (n, 3)).astype(float), device.read(lobes, np.int32, n)


@pytest.fixture(scope="module")
def lobes() -> Lobes:
    return Lobes()


def lobes_of(material: object) -> tuple[int, ...]:
    if isinstance(material, Diffuse):
        return (DIFFUSE,)
    if isinstance(material, RoughConductor):
        return (REFLECT,)
    if isinstance(material, RoughDielectric):
        return (DIELECTRIC_REFLECT, TRANSMIT)
    return (REFLECT,) if getattr(material, "metallic", 0) == 1 else (DIFFUSE, REFLECT)


CASES = [(index, lobe) for index, material in enumerate(MATERIALS) for lobe in lobes_of(material)]
WIDE = [case for case in CASES if getattr(MATERIALS[case[0]], "alpha", 1.0) >= 0.2]
NORMAL = unit(np.array([0.3, -0.2, 0.9])).astype(np.float32).astype(float)
NORMAL = unit(NORMAL)


def name_of(case: tuple[int, int]) -> str:
    return f"{MATERIALS[case[0]]}-{('diffuse', 'reflect', 'dielectric reflect', 'transmit')[case[1]]}".replace(" ", "")


def sphere(n_cos: int, n_phi: int, n: Array) -> tuple[Array, Array]:
    """Directions and weights of a quadrature over the sphere about the axis n; the equator falls between nodes."""
    z, weight = np.polynomial.legendre.leggauss(n_cos)
    z, weight = np.concatenate([(z - 1) / 2, (z + 1) / 2]), np.concatenate([weight, weight]) / 2
    phi = (np.arange(n_phi) + 0.5) * 2 * np.pi / n_phi
    sine = np.sqrt(1 - z**2)[:, None]
    tangent = unit(np.cross(n, [1.0, 0.0, 0.0]))
    frame = np.stack([tangent, np.cross(n, tangent), n])
    local = np.stack([sine * np.cos(phi), sine * np.sin(phi), np.broadcast_to(z[:, None], (len(z), n_phi))], axis=-1)
    return local.reshape(-1, 3) @ frame, np.repeat(weight * 2 * np.pi / n_phi, n_phi)


def incoming(cosine: float, n: Array, phi: float = 0.7) -> Array:
    """A direction at an angle to n."""
    tangent = unit(np.cross(n, [1.0, 0.0, 0.0]))
    across = np.cos(phi) * tangent + np.sin(phi) * np.cross(n, tangent)
    return (cosine * n + np.sqrt(1 - cosine**2) * across).astype(np.float32).astype(float)


# --- values --------------------------------------------------------------------------------------------------------


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
    eta = surface.index_ratio(wi)[:, None]
    cosine = dot(wi, facet)[:, None]
    below = np.sqrt(np.maximum(1 - (1 - cosine**2) / eta**2, 0))
    peak = -wi / eta + (cosine / eta - below) * facet if lobe == TRANSMIT else -mirror(wi, facet)
    if lobe == DIFFUSE:
        peak = unit(rng.normal(size=(n, 3)))
    wo = single(np.where(np.arange(n)[:, None] % 2, unit(peak), unit(rng.normal(size=(n, 3)))))
    value, density = lobes.evaluate(index, lobe, ng, ns, wi, wo)
    expected, expected_density = lobe_value(surface, wi, wo), lobe_density(surface, wi, wo)
    # Relative error: the microfacet normal is a sum of unit vectors, so its rounding is EPS / |m|; log D turns by at
    # most 4 / α per radian; cosines in denominators carry EPS / cos. Thirty-two of each for some fifty operations.
    bend = eta if lobe == TRANSMIT else 1.0
    m = wi + bend * wo
    size = np.linalg.norm(m, axis=-1)
    facet = m / np.maximum(size, 1e-9)[:, None]
    near = np.abs(np.stack([dot(ns, wi), dot(ns, wo), dot(facet, wi), dot(facet, wo), dot(facet, ns)]))
    least = np.min(np.stack([*near, np.abs(dot(ng, wi)), np.abs(dot(ng, wo))]), axis=0)
    # the Jacobian's denominator in refraction is |m| (n_i im + n_o om) and vanishes nowhere else
    bound = 32 * EPS * (1 + (4 / alpha if lobe != DIFFUSE else 0) / np.maximum(size, 1e-9)) / least
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
    if lobe == TRANSMIT:
        ior = MATERIALS[index].ior
        # the normal's side is outside, of index one: index of w_i's medium squared, for both orders
        scale = np.where(ci > 0, 1.0, ior) ** 2 / np.where(co > 0, 1.0, ior) ** 2
    f, g = forth / np.abs(co)[:, None], back * scale[:, None] / np.abs(ci)[:, None]
    lit = (f > 0).any(axis=1)
    assert lit.mean() > 0.02 and np.array_equal(f > 0, g > 0)
    surface = lobes.surface(index, lobe, len(wi), NORMAL, NORMAL)
    _, m, _ = half_vectors(surface, wi, wo)
    # near the critical angle 1 - F is the root of a difference
    least = np.minimum(np.abs(dot(m, wi)), np.abs(dot(m, wo))) if lobe == TRANSMIT else np.ones(len(wi))
    alpha = max(getattr(MATERIALS[index], "alpha", 1.0), 1e-3)
    assert np.all(np.abs(f - g)[lit] <= (2e-5 / alpha / least**2)[lit, None] * f[lit])


# --- integrals -----------------------------------------------------------------------------------------------------


class FacetIntegrals(NamedTuple):
    reflected: float  # probability that a drawn facet reflects, to a direction on the right side
    refracted: float
    reflected_power: float  # the same times G2 / G1: what comes out, per unit of light
    refracted_power: float


def facet_integrals(record: np.void, n: Array, wi: Array) -> FacetIntegrals:
    """Integrals over visible microfacet normals, density G1 D max(w_i.h, 0) / cos θ_i, in float64."""
    h, weight = sphere(160, 320, n)
    keep = dot(h, n) > 0
    h, weight = h[keep], weight[keep]
    alpha = float(record["alpha"])
    n = n if n @ wi > 0 else -n
    h = h if h[0] @ n > 0 else -h
    ki = h @ wi
    g1 = 1 / (1 + smith_lambda(wi, n, np.float64(alpha)))
    visible = weight * g1 * ggx_d_at(h, np.broadcast_to(n, h.shape), alpha) * np.maximum(ki, 0) / (n @ wi)
    r = -mirror(np.broadcast_to(wi, h.shape), h)
    ior = float(record["ior"])
    eta = (ior if NORMAL @ wi > 0 else 1 / ior) if ior else 1.0
    share = fresnel(np.clip(ki, 0, 1), np.float64(eta)) if ior else np.ones(len(h))
    across = np.maximum(1 - (1 - ki**2) / eta**2, 0)
    t = (ki / eta - np.sqrt(across))[:, None] * h - wi / eta

    def masked(w: Array) -> Array:
        i, o = smith_lambda(wi, n, np.float64(alpha)), smith_lambda(w, n, np.float64(alpha))
        return (1 / (1 + o)) if record["separable"] else (1 + i) / (1 + i + o)

    up, down = (ki > 0) & (r @ n > 0), (ki > 0) & (t @ n < 0)
    return FacetIntegrals(
        float((visible * share)[up].sum()),
        float((visible * (1 - share))[down].sum()),
        float((visible * share * masked(r))[up].sum()),
        float((visible * (1 - share) * masked(t))[down].sum()),
    )


@pytest.mark.parametrize("case", WIDE, ids=name_of)
@pytest.mark.parametrize("cosine", [0.9, 0.3, -0.5])
def test_totals(lobes: Lobes, case: tuple[int, int], cosine: float) -> None:
    """The density's and the value's integrals over the sphere: sampled mass and albedo, known and never above one."""
    index, lobe = case
    material = MATERIALS[index]
    wi = incoming(cosine, NORMAL)
    wo, weight = sphere(160, 320, NORMAL)
    value, density = lobes.evaluate(index, lobe, NORMAL, NORMAL, wi, wo)
    mass, albedo = density @ weight, weight @ value
    if lobe == DIFFUSE:
        record = lobes.surface(index, lobe, 1, NORMAL, NORMAL).material[0]
        assert mass == pytest.approx(1, abs=1e-4) and albedo == pytest.approx(record["diffuse"], rel=1e-4)
        return
    record = lobes.surface(index, lobe, 1, NORMAL, NORMAL).material[0]
    known = facet_integrals(record, NORMAL, wi)
    assert mass == pytest.approx(known.refracted if lobe == TRANSMIT else known.reflected, abs=2e-3)
    assert mass <= 1 + 1e-3
    if isinstance(material, MetallicRoughness):
        f0 = record["specular"] + record["specular_tinted"]
        assert np.all(albedo <= 1) and np.all(albedo >= known.reflected_power * f0 - 2e-3)
        return
    if lobe == TRANSMIT:
        # radiance is stretched by η² on the way in; what is conserved is power
        eta = material.ior if cosine > 0 else 1 / material.ior
        assert albedo[0] * eta**2 == pytest.approx(known.refracted_power, abs=2e-3)
        return
    colour = np.ones(3) if lobe == DIELECTRIC_REFLECT else np.array(material.reflectance)
    assert albedo == pytest.approx(known.reflected_power * colour, abs=2e-3)


@pytest.mark.parametrize("index", [i for i, m in enumerate(MATERIALS) if getattr(m, "ior", 0) and m.alpha >= 0.2])
def test_dielectric_shares_out_all_light(lobes: Lobes, index: int) -> None:
    """White furnace: reflected and refracted power together fall short of one by what single scattering loses."""
    for cosine in (0.95, 0.4, -0.8):
        wi = incoming(cosine, NORMAL)
        wo, weight = sphere(160, 320, NORMAL)
        reflected, p_reflect = lobes.evaluate(index, DIELECTRIC_REFLECT, NORMAL, NORMAL, wi, wo)
        refracted, p_refract = lobes.evaluate(index, TRANSMIT, NORMAL, NORMAL, wi, wo)
        eta = MATERIALS[index].ior if cosine > 0 else 1 / MATERIALS[index].ior
        known = facet_integrals(lobes.surface(index, TRANSMIT, 1, NORMAL, NORMAL).material[0], NORMAL, wi)
        total = weight @ reflected[:, 0] + eta**2 * weight @ refracted[:, 0]
        assert total <= 1 and total == pytest.approx(known.reflected_power + known.refracted_power, abs=4e-3)
        mass = weight @ (p_reflect + p_refract)
        assert mass <= 1 + 1e-3 and mass == pytest.approx(known.reflected + known.refracted, abs=4e-3)


# --- sampling ------------------------------------------------------------------------------------------------------

# one case a material: a dielectric's two lobes are one draw, and masking does not enter the sampling
SAMPLED = [
    (i, lobes_of(m)[-1 if isinstance(m, RoughConductor | MetallicRoughness) else 0])
    for i, m in enumerate(MATERIALS)
    if getattr(m, "alpha", 1.0) >= 0.2 and getattr(m, "masking", "") != "separable"
]
COSINES = (0.8, 0.25, -0.6)


@pytest.mark.parametrize("case", SAMPLED, ids=name_of)
def test_samples_follow_the_density(lobes: Lobes, case: tuple[int, int]) -> None:
    """χ² of sampled directions over cells of the sphere, for each lobe a draw may end in; failures are a cell too."""
    index, lobe = case
    n, cells_z, cells_phi = 200_000, 20, 16
    dielectric = isinstance(MATERIALS[index], RoughDielectric)
    outcomes = (DIELECTRIC_REFLECT, TRANSMIT) if dielectric else (lobe,)
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
    for number, cosine in enumerate(COSINES):
        wi = incoming(cosine, NORMAL)
        directions, drawn = lobes.sample(index, lobe, NORMAL, wi, n, 40 + number)
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
    directions, drawn = lobes.sample(index, REFLECT, NORMAL, NORMAL, 50_000, 5)
    assert np.all(drawn == REFLECT)
    facet = unit(directions + NORMAL)
    slope = np.linalg.norm(np.cross(facet, NORMAL), axis=-1) / dot(facet, NORMAL)
    # at normal incidence visible normals have density D cos θ: P(tan θ < s) = s² / (s² + α²)
    cdf: Callable[[Array], Array] = lambda s: s**2 / (s**2 + 1e-6)  # noqa: E731
    assert stats.kstest(slope, cdf).pvalue > ALPHA
