"""Ray rates against Embree: ``python -m bench.traversal [--large] [--rays N] [--width W] [--device SPEC]``.

Everything runs on one core (Embree's Python binding has one thread), kernels and Embree interleaved; medians are
printed, and their ratio. Kernel times exclude copying rays to the device, Embree's exclude nothing: its binding takes
and returns arrays. The line "as called" is RayTracer's own methods, copies included.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable

import numpy as np
import pyopencl as cl
import trimesh

from pylmc.device.raytracer import LOCAL_SIZE, RayTracer
from pylmc.geometry import bvh

from .report import arguments, circumstances, words

try:
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene
except ImportError:
    EmbreeScene = None


def blobs(large: bool, seed: int = 7) -> tuple[np.ndarray, np.ndarray]:
    """Dented balls in a room, (vertices, faces): 102 k triangles, or 1.3 M."""
    rng = np.random.default_rng(seed)
    room = trimesh.creation.box(extents=(6, 6, 6))
    meshes = [(room.vertices, room.faces[:, ::-1])]  # walls face inwards
    for _ in range(4 if large else 5):
        ball = trimesh.creation.icosphere(subdivisions=7 if large else 5)
        wave = sum(np.sin(ball.vertices @ (k * rng.normal(size=3)) + 6 * rng.random()) / k for k in (3, 6, 12))
        centre, radius = rng.uniform(-1.5, 1.5, 3), rng.uniform(0.6, 1.3)
        meshes.append((centre + radius * ball.vertices * (1 + 0.2 * wave[:, None]), ball.faces))
    offsets = np.cumsum([0] + [len(v) for v, _ in meshes])
    faces = [f + offset for (_, f), offset in zip(meshes, offsets, strict=False)]
    return np.concatenate([v for v, _ in meshes]).astype(np.float32), np.concatenate(faces).astype(np.int32)


def surface_points(vertices: np.ndarray, faces: np.ndarray, count: int, rng: np.random.Generator) -> np.ndarray:
    """Points on the surface, uniform over its area, and the unit normals there: (2, count, 3)."""
    corners = vertices[faces].astype(np.float64)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normal, axis=1)
    face = rng.choice(len(faces), count, p=area / area.sum())
    weights = rng.dirichlet((1, 1, 1), count)
    return np.stack(((weights[:, :, None] * corners[face]).sum(axis=1), normal[face] / area[face, None]))


def rays(kind: str, vertices: np.ndarray, faces: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray, float]:
    """(origins, directions, t_max): camera rays in scan order, diffuse bounces, or segments between surface points."""
    rng = np.random.default_rng(11)
    if kind == "coherent":
        side = int(np.sqrt(count))
        y, x = np.divmod(np.arange(count), side)
        pixel = np.stack((x / side - 0.5, 0.5 - y / side, np.full(count, -0.8)), axis=1)
        return np.tile((0.1, 0.2, 2.9), (count, 1)), pixel / np.linalg.norm(pixel, axis=1, keepdims=True), np.inf
    origin, normal = surface_points(vertices, faces, count, rng)
    origin += 1e-3 * normal
    if kind == "incoherent":
        direction = rng.normal(size=(count, 3))
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        direction *= np.sign((direction * normal).sum(axis=1, keepdims=True))
        return origin, direction, np.inf
    target, target_normal = surface_points(vertices, faces, count, rng)
    return origin, target + 1e-3 * target_normal - origin, 1.0


def launcher(tracer: RayTracer, kind: str, origins: np.ndarray, directions: np.ndarray, t_max: float) -> Callable:
    """A call that traces the rays from buffers already on the device."""
    context, count = tracer._context, len(origins)
    read = cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR
    inputs = [cl.Buffer(context, read, hostbuf=part) for part in (origins, directions, np.full(count, t_max, np.float32))]
    kernel, results = (tracer._any, 1) if kind == "any hit" else (tracer._closest, 4)
    outputs = [cl.Buffer(context, cl.mem_flags.WRITE_ONLY, 4 * count) for _ in range(results)]
    size = -(-count // LOCAL_SIZE) * LOCAL_SIZE
    arguments = (tracer._nodes, tracer._leaves, np.int32(count), *inputs, *outputs)
    return lambda: kernel(tracer._queue, (size,), (LOCAL_SIZE,), *arguments).wait()


def median_rates(calls: dict[str, Callable], count: int, repeats: int) -> dict[str, float]:
    """Mrays/s of each call, the calls taking turns."""
    seconds: dict[str, list[float]] = {name: [] for name in calls}
    for repeat in range(repeats + 1):
        for name, call in calls.items():
            begin = time.perf_counter()
            call()
            if repeat:  # the first turn compiles and warms up
                seconds[name].append(time.perf_counter() - begin)
    return {name: count / float(np.median(times)) / 1e6 for name, times in seconds.items()}


def main() -> None:
    parser = arguments(__doc__)
    parser.add_argument("--large", action="store_true", help="1.3 M triangles instead of 102 k")
    parser.add_argument("--rays", type=int, default=500_000)
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--width", type=int, default=8, choices=bvh.WIDTHS)
    options = parser.parse_args()
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})  # before the first OpenCL call, whose threads inherit it
    print(words(circumstances(options.device)))
    vertices, faces = blobs(options.large)
    begin = time.perf_counter()
    tree = bvh.build(vertices, faces, options.width)
    print(
        f"{len(faces)} triangles, built in {time.perf_counter() - begin:.2f} s: {len(tree.nodes)} nodes, "
        f"{len(tree.leaves)} leaves, depth {tree.depth}, {tree.defines()}"
    )
    tracer = RayTracer(vertices, faces, options.device, width=options.width)
    print(f"one core, {options.rays} rays, medians of {options.repeats}, Mrays/s")
    embree = EmbreeScene(robust=False) if EmbreeScene else None
    if embree:
        TriangleMesh(embree, vertices[faces])
    for kind in ("coherent", "incoherent", "any hit"):
        origins, directions, t_max = rays(kind, vertices, faces, options.rays)
        origins, directions = np.ascontiguousarray(origins, np.float32), np.ascontiguousarray(directions, np.float32)
        method = tracer.any_hit if kind == "any hit" else tracer.closest_hit
        calls: dict[str, Callable] = {
            "kernel": launcher(tracer, kind, origins, directions, t_max),
            "as called": lambda m=method, o=origins, d=directions, t=t_max: m(o, d, t),
        }
        if embree:
            far = np.full(len(origins), min(t_max, 1e37), np.float32)
            query = "OCCLUDED" if kind == "any hit" else "INTERSECT"
            calls["Embree"] = lambda o=origins, d=directions, f=far, q=query: embree.run(o, d, f.copy(), q)
        rate = median_rates(calls, len(origins), options.repeats)
        ratio = f", kernel/Embree {rate['kernel'] / rate['Embree']:.2f}" if embree else ""
        print(f"{kind:>10}: " + ", ".join(f"{name} {value:.2f}" for name, value in rate.items()) + ratio)


if __name__ == "__main__":
    main()
