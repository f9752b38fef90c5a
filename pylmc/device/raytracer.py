"""Rays against a triangle mesh on an OpenCL device, for arrays of rays."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyopencl as cl

from ..errors import PylmcError
from ..geometry import bvh
from . import forks, program
from .survey import context_and_queue, select

LOCAL_SIZE = 64  # one size throughout: PoCL compiles a kernel anew for each
CHUNK = 1 << 22  # rays per launch, which bounds the buffers at about 200 MB

_READ = cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR


class RayTracer:
    """Closest and any intersections of rays with one mesh.

    ``vertices`` (n, 3) and ``faces`` (m, 3) as for :func:`pylmc.geometry.bvh.build`; ``device`` is a specification as on the
    command line ("cpu", "gpu", an index, part of a name), a ``pyopencl.Device``, or None for the default. Coordinates
    are single precision. Raises PylmcError for a bad mesh or a device that is not there.
    """

    def __init__(self, vertices: Any, faces: Any, device: Any = None, *, width: int = 8) -> None:
        tree = bvh.build(vertices, faces, width)
        self.device: cl.Device = device if isinstance(device, cl.Device) else select(device)
        self._context, self._queue = context_and_queue(self.device)
        built = program.build(self._context, "entry/raytracer.cl", defines=tree.defines())
        self._closest = cl.Kernel(built, "trace_closest")
        self._any = cl.Kernel(built, "trace_any")
        # Copied rather than shared with NumPy's memory, which is aligned for floats but not for the kernels' vectors.
        self._nodes = cl.Buffer(self._context, _READ, hostbuf=tree.nodes)
        self._leaves = cl.Buffer(self._context, _READ, hostbuf=tree.leaves)

    def closest_hit(
        self, origins: Any, directions: Any, t_max: Any = np.inf
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """(t, triangle, u, v), each (k,), of the first hit along each ray at t in (0, t_max).

        ``origins`` and ``directions`` broadcast to (k, 3), ``t_max`` to (k,); directions need not be unit vectors, and
        t is in their units. The hit point is (1 - u - v) v0 + u v1 + v v2 of face ``triangle``; of coincident triangles
        the lowest number is reported. A miss has t = inf and triangle = -1; so has a direction of length zero. Raises
        PylmcError for other shapes, for NaN, and for infinite origins or directions.
        """
        rays = _check_rays(origins, directions, t_max)
        count = len(rays[0])
        t, u, v = (np.empty(count, dtype=np.float32) for _ in range(3))
        triangle = np.empty(count, dtype=np.int32)
        self._trace(self._closest, rays, (t, triangle, u, v))
        return t, triangle, u, v

    def any_hit(self, origins: Any, directions: Any, t_max: Any = np.inf) -> np.ndarray:
        """(k,) bool: whether each ray meets anything at t in (0, t_max). Arguments and errors as in closest_hit."""
        rays = _check_rays(origins, directions, t_max)
        occluded = np.empty(len(rays[0]), dtype=np.uint8)
        self._trace(self._any, rays, (occluded,))
        return occluded.astype(bool)

    def _trace(self, kernel: cl.Kernel, rays: tuple[np.ndarray, ...], results: tuple[np.ndarray, ...]) -> None:
        forks.check()
        for begin in range(0, len(rays[0]), CHUNK):
            chunk = slice(begin, begin + CHUNK)
            inputs = [cl.Buffer(self._context, _READ, hostbuf=part[chunk]) for part in rays]
            parts = [result[chunk] for result in results]
            outputs = [cl.Buffer(self._context, cl.mem_flags.WRITE_ONLY, part.nbytes) for part in parts]
            count = len(parts[0])
            size = -(-count // LOCAL_SIZE) * LOCAL_SIZE
            kernel(self._queue, (size,), (LOCAL_SIZE,), self._nodes, self._leaves, np.int32(count), *inputs, *outputs)
            for part, buffer in zip(parts, outputs, strict=True):
                cl.enqueue_copy(self._queue, part, buffer)


def _check_rays(origins: Any, directions: Any, t_max: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Contiguous float32 origins (k, 3), directions (k, 3) and t_max (k,), or a PylmcError."""
    try:
        arrays = [np.atleast_2d(np.asarray(value, dtype=np.float32)) for value in (origins, directions)]
        limit = np.asarray(t_max, dtype=np.float32)
    except (TypeError, ValueError) as error:
        raise PylmcError(f"rays: origins, directions and t_max must be numbers: {error}") from None
    for name, array in zip(("origins", "directions"), arrays, strict=True):
        if array.ndim != 2 or array.shape[1] != 3:
            raise PylmcError(f"rays: {name} have shape {array.shape}; expected (k, 3)")
        if not np.all(np.isfinite(array)):
            bad = int(np.flatnonzero(~np.isfinite(array).all(axis=1))[0])
            raise PylmcError(f"rays: {name}[{bad}] is NaN, infinite or beyond single precision")
    if np.any(np.isnan(limit)):
        raise PylmcError("rays: t_max holds NaN; use inf for rays without an end")
    try:
        count = np.broadcast_shapes(arrays[0].shape[:1], arrays[1].shape[:1], limit.shape)
        if len(count) != 1:
            raise ValueError
    except ValueError:
        raise PylmcError(
            f"rays: {len(arrays[0])} origins, {len(arrays[1])} directions and t_max of shape {limit.shape} do not match"
        ) from None
    shape = (*count, 3)
    origins, directions = (np.ascontiguousarray(np.broadcast_to(array, shape)) for array in arrays)
    return origins, directions, np.ascontiguousarray(np.broadcast_to(limit, count))
