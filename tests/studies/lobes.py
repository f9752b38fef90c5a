"""The kernels' lobe functions over arrays, for every kind of lobe that is registered and the materials that show it."""

from __future__ import annotations

from itertools import chain

import numpy as np
from oracle.lobes import KINDS, NAMES, Surface
from oracle.materials import side_by_side
from oracle.vectors import Array, unit

from pylmc.device.device_scene import DeviceScene
from pylmc.sampling.compiled import CompiledScene, compile_scene
from pylmc.scene import Camera, Material, PointLight, Scene, Shape
from pylmc.settings import Settings

from .probes import build_probe

MATERIALS: list[Material] = list({id(m): m for m in chain.from_iterable(kind.MATERIALS for kind in KINDS)}.values())
# (material, kind of lobe), by number
CASES = [(index, NAMES.index(lobe.name)) for index, material in enumerate(MATERIALS) for lobe in material.lobes()]
NORMAL = unit(unit(np.array([0.3, -0.2, 0.9])).astype(np.float32).astype(float))


def is_wide(case: tuple[int, int]) -> bool:
    """Whether a quadrature of 320 by 320 directions is good to 1e-3 for the material's lobes."""
    return all((lobe.width or 1.0) >= 0.2 for lobe in MATERIALS[case[0]].lobes())


def name_of(case: tuple[int, int]) -> str:
    """What a test of the case is called."""
    return f"{MATERIALS[case[0]]}-{NAMES[case[1]]}".replace(" ", "")


def incoming(cosine: float, n: Array, phi: float = 0.7) -> Array:
    """A direction at an angle to n, exact in float32."""
    tangent = unit(np.cross(n, [1.0, 0.0, 0.0]))
    across = np.cos(phi) * tangent + np.sin(phi) * np.cross(n, tangent)
    return (cosine * n + np.sqrt(1 - cosine**2) * across).astype(np.float32).astype(float)


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

    def facing(self, material: int, lobe: int, n: int = 1) -> Surface:
        """``n`` nodes whose both normals are ``NORMAL``."""
        return self.surface(material, lobe, n, NORMAL, NORMAL)

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
