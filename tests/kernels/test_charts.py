"""The charts between coordinates and directions: inverses, Jacobians by differences, total mass, and the frames.

Differences of float32 maps: a five-point rule with a step of 0.02 has a truncation error of 0.02⁴ times fifth
derivatives, and carries the rounding of unit vectors, 1e-7 / 0.02: both below 1e-4 away from a chart's edge. JACOBIAN
allows ten times that.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracle.lobes import number
from oracle.vectors import Array, dot, unit
from studies.probes import build_probe

from pylmc.device.device_scene import DeviceScene
from pylmc.sampling.compiled import compile_scene
from pylmc.scene import Camera, Diffuse, PointLight, RoughConductor, RoughDielectric, Scene, Shape
from pylmc.settings import Settings

JACOBIAN = 1e-3
STEP = 0.02
KINDS = {"projection": 0, "node": 2, "portal": 3}

SOURCE = """
#include "number/vectors.cl"
#include "charts/charts.cl"

// directions of deviations, the deviations found again from them, and log dsigma/dOmega
__kernel void probe_deviation(SCENE_PARAMETERS, int count, __global const float *frames, __global const float *omegas,
                              __global float *out) {
    int i = get_global_id(0);
    if (i >= count) return;
    float3 s = load3(frames, 2 * i), p = load3(frames, 2 * i + 1), v = (float3)(NAN);
    float2 omega = vload2(i, omegas), back = (float2)(NAN);
    bool ok = deviation_direction(omega, s, p, &v) && deviation_of(v, s, p, &back);
    vstore3(v, 0, out + 6 * i);
    vstore2(back, 0, out + 6 * i + 3);
    out[6 * i + 5] = ok ? deviation_log_jacobian(omega) : NAN;
}

// the same for the charts that move a point; x is the node left. forward: delta to v and back; else v is given.
__kernel void probe_chart(SCENE_PARAMETERS, int count, int forward, int kind, __global const float *planes,
                          __global const float *deltas, __global const float *given, __global float *out) {
    int i = get_global_id(0);
    if (i >= count) return;
    Chart chart;
    chart.kind = kind;
    chart.anchor = load3(planes, 4 * i);
    chart.normal = load3(planes, 4 * i + 1);
    chart.e1 = load3(planes, 4 * i + 2);
    chart.e2 = cross(chart.normal, chart.e1);
    chart.omega = (float2)(0.0f);
    float3 x = load3(planes, 4 * i + 3), v = load3(given, i);
    float2 back = (float2)(NAN);
    float log_forward = NAN, log_back = NAN;
    bool ok = !forward || chart_direction(&chart, vload2(i, deltas), x, v, v, &v, &log_forward);
    if (ok) ok = chart_delta(&chart, x, v, (float2)(0.0f), &back, &log_back);
    vstore3(ok ? v : (float3)(NAN), 0, out + 7 * i);
    vstore2(back, 0, out + 7 * i + 3);
    out[7 * i + 5] = log_forward;
    out[7 * i + 6] = log_back;
}

// a frame carried through a node and on to the direction taken; and minimal rotations there and back
__kernel void probe_frames(SCENE_PARAMETERS, int count, int lobe, int material, __global const float *vectors,
                           __global float *out) {
    int i = get_global_id(0);
    if (i >= count) return;
    Scene scene = SCENE_BUNDLE;
    Vertex vertex;
    vertex.ns = vertex.ng = load3(vectors, 4 * i);
    vertex.lobe = lobe_like(&scene, material, lobe);
    vertex.material = material;
    float3 v = load3(vectors, 4 * i + 1), p = load3(vectors, 4 * i + 2), next = load3(vectors, 4 * i + 3);
    float3 s = reference_direction(&scene, &vertex, v);
    float3 at_s = transport_frame(&scene, &vertex, v, p, s), turned = rotate_minimal(at_s, s, next);
    vstore3(s, 5 * i, out);
    vstore3(at_s, 5 * i + 1, out);
    vstore3(turned, 5 * i + 2, out);
    vstore3(rotate_minimal(turned, next, s), 5 * i + 3, out);
    vstore3(any_tangent(v), 5 * i + 4, out);
}
"""


def device_scene(**settings: Any) -> DeviceScene:
    """A scene with every kind of lobe and a portal."""
    wall = (np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float), [[0, 1, 2]])
    materials = [Diffuse(0.5), RoughConductor(0.1), RoughDielectric(0.1, 1.5)]
    shapes = [Shape((wall[0] + i, wall[1]), material) for i, material in enumerate(materials)]
    scene = Scene(Camera((0, 0, 9), (0, 0, 0)), shapes, [PointLight((0, 5, 0))], portals=())
    return DeviceScene(compile_scene(scene), Settings(max_depth=4, coordinates="deviation", **settings))


def run(device: DeviceScene, name: str, count: int, width: int, *arguments: Any) -> Array:
    """Launch a probe; arrays become float32 buffers. Returns (count, width) float64."""
    kernel = build_probe(device, SOURCE, name, NUM_PORTALS=1)
    out = device.zeros(4 * count * width)
    buffers = [device.upload(a.astype(np.float32)) if isinstance(a, np.ndarray) else a for a in arguments]
    device.launch(kernel, count, np.int32(count), *buffers, out)
    return device.read(out, np.float32, (count, width)).astype(float)


def frames_of(rng: np.random.Generator, n: int) -> tuple[Array, Array]:
    """Random unit vectors and one across each."""
    s, p = unit(rng.normal(size=(2, n, 3)))
    return s, unit(p - dot(p, s)[:, None] * s)


def stencil(points: Array, step: Array) -> Array:
    """(8 n, 2): ±step and ±2 step along both coordinates about each point."""
    offsets = np.array([[k, 0] for k in (-2, -1, 1, 2)] + [[0, k] for k in (-2, -1, 1, 2)], float)
    return (points[:, None] + offsets * step[:, None, None]).reshape(-1, 2)


def area_element(v: Array, step: Array) -> Array:
    """|∂v/∂a × ∂v/∂b| from the directions at a stencil."""
    v = v.reshape(-1, 2, 4, 3)
    slopes = np.einsum("k,ndki->ndi", np.array([1, -8, 8, -1]) / 12, v) / step[:, None, None]
    return np.linalg.norm(np.cross(slopes[:, 0], slopes[:, 1]), axis=-1)


# --- deviations ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("chart", ["equal-area", "orthographic", "orthographic-unit"])
def test_deviation_charts(chart: str) -> None:
    """Ω → v → Ω, and dσ/dΩ as stated; the preprint's unit Jacobian must be caught by the same check."""
    device, rng, n = device_scene(chart=chart), np.random.default_rng(2), 2000
    s, p = frames_of(rng, n)
    reach = 1.9 if chart == "equal-area" else 0.9
    radius, angle = reach * np.sqrt(rng.random(n)), 2 * np.pi * rng.random(n)
    omega = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1).astype(np.float32).astype(float)
    out = run(device, "probe_deviation", n, 6, np.stack([s, p], axis=1), omega)
    v, back, log_jacobian = out[:, :3], out[:, 3:5], out[:, 5]
    assert np.allclose(np.linalg.norm(v, axis=-1), 1, atol=1e-6)
    assert np.abs(back - omega).max() < 1e-5
    # v lies as far from s as the chart says
    rho2 = (omega**2).sum(axis=-1)
    along = 1 - rho2 / 2 if chart == "equal-area" else np.sqrt(1 - rho2)
    assert np.abs(dot(v, s) - along).max() < 2e-6

    step = np.full(n, STEP)
    if chart != "equal-area":
        step *= 1 - rho2  # its derivatives grow towards the edge
    frames = np.repeat(np.stack([s, p], axis=1), 8, axis=0)
    around = run(device, "probe_deviation", 8 * n, 6, frames, stencil(omega, step))
    measured = area_element(around[:, :3], step)
    inside = radius < (1.7 if chart == "equal-area" else 0.8)
    error = np.abs(np.log(measured) - log_jacobian)[inside]
    if chart == "orthographic-unit":
        assert np.median(error) > 100 * JACOBIAN  # the negative control
        assert np.all(log_jacobian == 0)
    else:
        assert error.max() < JACOBIAN


def test_deviations_beyond_a_chart_are_refused() -> None:
    """ρ past the edge gives no direction; a direction behind the orthographic chart's hemisphere has no deviation."""
    rng, n = np.random.default_rng(3), 200
    s, p = frames_of(rng, n)
    angle = 2 * np.pi * rng.random(n)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    for chart, edge in (("equal-area", 2.0), ("orthographic", 1.0)):
        device = device_scene(chart=chart)
        frames = np.stack([s, p], axis=1)
        assert np.all(np.isnan(run(device, "probe_deviation", n, 6, frames, 1.001 * edge * circle)[:, 5]))
        assert np.all(np.isfinite(run(device, "probe_deviation", n, 6, frames, 0.999 * edge * circle)[:, 5]))


# --- projections and target charts ---------------------------------------------------------------------------------


def planes_of(kind: str, rng: np.random.Generator, n: int) -> tuple[Array, Array]:
    """(anchor, normal, axis, node left) (n, 4, 3), and each chart's own unit of length."""
    if kind == "projection":
        v, p = frames_of(rng, n)
        return np.stack([v, v, p, np.zeros((n, 3))], axis=1), np.ones(n)
    normal, axis = frames_of(rng, n)
    anchor = rng.normal(size=(n, 3))
    x = anchor + 0.5 * rng.normal(size=(n, 3))
    towards = anchor - x
    steep = np.abs(dot(unit(towards), normal)) > 0.2
    planes = np.stack([anchor, normal, axis, x], axis=1)[steep]
    return planes, np.linalg.norm(towards[steep], axis=-1)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("projection", ["normalise", "orthographic"])
def test_charts_that_move_a_point(kind: str, projection: str) -> None:
    """δ → v → δ, and dσ/dδ by differences: cos³ (or 1/cos) of the projections, |n.v| / r² of the target charts."""
    device, rng = device_scene(projection=projection), np.random.default_rng(4)
    planes, size = planes_of(kind, rng, 2000)
    n = len(planes)
    radius, angle = 0.5 * np.sqrt(rng.random(n)), 2 * np.pi * rng.random(n)
    delta = (size * radius)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    towards = planes[:, 0] - planes[:, 3]
    number = np.int32(KINDS[kind])
    out = run(device, "probe_chart", n, 7, np.int32(1), number, planes, delta, np.zeros((n, 3)))
    v, back, forth_log, back_log = out[:, :3], out[:, 3:5], out[:, 5], out[:, 6]
    e1, e2 = planes[:, 2], np.cross(planes[:, 1], planes[:, 2])
    if kind == "projection":
        offset = delta[:, :1] * e1 + delta[:, 1:] * e2
        cosine = dot(v, planes[:, 0])
        if projection == "normalise":
            expected, known = unit(planes[:, 0] + offset), 3 * np.log(cosine)
        else:
            expected, known = np.sqrt(1 - (delta**2).sum(axis=-1))[:, None] * planes[:, 0] + offset, -np.log(cosine)
    else:
        reach = towards + delta[:, :1] * e1 + delta[:, 1:] * e2
        expected, known = unit(reach), np.log(np.abs(dot(planes[:, 1], unit(reach)))) - np.log(dot(reach, reach))
    steep = np.abs(dot(expected, planes[:, 1])) > 0.1
    assert steep.mean() > 0.9
    assert np.abs(v - expected)[steep].max() < 2e-6
    # rounding of v grows by distance / cosine² on the way back to the plane
    assert (np.abs(back - delta)[steep] / size[steep, None]).max() < 2e-4
    assert np.abs(forth_log - known)[steep].max() < 1e-4 and np.abs(back_log - known)[steep].max() < 1e-3

    step = STEP * size
    eightfold, none = np.repeat(planes, 8, axis=0), np.zeros((8 * n, 3))
    spread = run(device, "probe_chart", 8 * n, 7, np.int32(1), number, eightfold, stencil(delta, step), none)
    measured = area_element(spread[:, :3], step)
    assert np.abs(np.log(measured) - forth_log)[steep & (np.abs(dot(v, planes[:, 1])) > 0.3)].max() < JACOBIAN


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("projection", ["normalise", "orthographic"])
def test_proposal_density_integrates_to_one(kind: str, projection: str) -> None:
    """∫ N(δ(v); h) / J(v) dσ(v) over the sphere, δ and J from the kernels' inverse."""
    device, rng = device_scene(projection=projection), np.random.default_rng(5)
    planes, size = planes_of(kind, rng, 3)
    z, weight = np.polynomial.legendre.leggauss(400)
    z, weight = (z + 1) / 2, weight / 2
    phi = (np.arange(400) + 0.5) * 2 * np.pi / 400
    sine = np.sqrt(1 - z**2)[:, None]
    h = 0.3
    for plane, length in zip(planes[:2], size[:2], strict=True):
        # directions about the plane's normal, on the side that the chart looks at
        axis = plane[1] if kind == "projection" else plane[1] * np.sign((plane[0] - plane[3]) @ plane[1])
        frame = np.stack([plane[2], np.cross(axis, plane[2]), axis])
        v = np.stack([sine * np.cos(phi), sine * np.sin(phi), np.broadcast_to(z[:, None], (400, 400))], axis=-1)
        v = v.reshape(-1, 3) @ frame
        n = len(v)
        out = run(
            device,
            "probe_chart",
            n,
            7,
            np.int32(0),
            np.int32(KINDS[kind]),
            np.broadcast_to(plane, (n, 4, 3)),
            np.zeros((n, 2)),
            v,
        )
        delta, log_jacobian = out[:, 3:5] / length, out[:, 6]
        gauss = np.exp(-(delta**2).sum(axis=-1) / (2 * h**2)) / (2 * np.pi * (h * length) ** 2)
        total = np.nansum(gauss * np.exp(-log_jacobian) * np.repeat(weight * 2 * np.pi / 400, 400))
        # the other projection reaches only |δ| < 1
        cut = np.exp(-0.5 / h**2) if kind == "projection" and projection == "orthographic" else 0
        assert total == pytest.approx(1 - cut, abs=1e-3)


# --- frames --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("lobe,shape", [("diffuse", 0), ("reflect", 1), ("dielectric_reflect", 2), ("dielectric_transmit", 2)])
def test_frames(lobe: str, shape: int) -> None:
    """Transported frames stay unit and across the direction; a minimal rotation is undone by the one back."""
    device, rng, n = device_scene(), np.random.default_rng(6), 20_000
    v, p = frames_of(rng, n)
    normal, next_direction = unit(rng.normal(size=(2, n, 3)))
    material = device.compiled.arrays["triangles"]["material"][shape]
    vectors = np.stack([normal, v, p, next_direction], axis=1)
    out = run(device, "probe_frames", n, 15, np.int32(number(lobe)), np.int32(material), vectors).reshape(n, 5, 3)
    s, at_s, turned, back, tangent = np.moveaxis(out, 1, 0)
    # a rotation by nearly π loses digits as 1 / (1 + a.b); there the frame is refused or of no use anyway
    mirrored = v - 2 * dot(v, normal)[:, None] * normal
    start = v if lobe == "dielectric_transmit" else mirrored
    gentle = (1 + dot(start, s) > 1e-2) & (1 + dot(s, next_direction) > 1e-2)
    assert gentle.mean() > 0.95
    for frame, axis in ((at_s, s), (turned, next_direction), (tangent, v)):
        assert np.abs(np.linalg.norm(frame, axis=-1) - 1)[gentle].max() < 1e-4
        assert np.abs(dot(frame, axis))[gentle].max() < 1e-4
    assert np.abs(back - at_s)[gentle].max() < 1e-4
    # minimal: the component along the rotation's axis stays
    axis = np.cross(s, next_direction)
    assert np.abs(dot(axis, turned) - dot(axis, at_s))[gentle].max() < 1e-4
