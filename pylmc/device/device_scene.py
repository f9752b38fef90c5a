"""A compiled scene on a device: its buffers, and programs specialised to it."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pyopencl as cl

from ..errors import PylmcError
from ..moves import Moves
from ..settings import Settings
from . import forks, program, structs, tables
from .compiled_scene import CompiledScene
from .handlers import kept_handlers
from .precision import NAME_OF_REAL, on_device, real_fields
from .survey import context_and_queue, select
from .work_groups import padded, work_group


class DeviceScene:
    """Uploads a compiled scene and builds kernels for it.

    ``device`` is a ``pyopencl.Device``, a SPEC string or None (see :func:`pylmc.device.survey.select`). Raises PylmcError if
    there is no such device or the scene does not fit into its memory.
    """

    def __init__(self, compiled: CompiledScene, settings: Settings, device: Any = None, precision: str = "single") -> None:
        self.compiled, self.settings = compiled, settings
        self.moves = Moves(settings, compiled.features)
        self.device = device if isinstance(device, cl.Device) else select(device)
        self.precision = on_device(precision, self.device)
        if settings.math == "native" and self.precision.real != "float":
            raise PylmcError(
                f"math='native' has short functions for 32-bit floats only, and precision '{precision}' computes "
                f"in {NAME_OF_REAL[self.precision.real]}: use math='exact', or precision='single'"
            )
        if settings.math != "exact" and self.precision.real == "pair":
            raise PylmcError(
                f"math='{settings.math}' would let the compiler cancel the low words of pairs of floats, which "
                f"precision '{precision}' computes in: use math='exact', or precision='single'"
            )
        self.context, self._queue = context_and_queue(self.device)
        self.compile_seconds = 0.0
        self._programs: dict[str, cl.Program] = {}
        self._kernels: dict[tuple[str, str], cl.Kernel] = {}
        self._declarations: list[str] = []
        self.dtypes: dict[str, np.dtype] = {}
        for name, fields in tables.SCENE_STRUCTS.items():
            self._declare(name, fields)
        self._declare("Lobe", tables.lobe_record(compiled.lobe_kinds))
        self._declare("Light", tables.light_record(compiled.light_kinds))
        self._declare("ChainStart", tables.CHAIN_START)
        self._declare("FilmPlace", tables.FILM_PLACE)
        # pyopencl knows a nested struct by one name and one set of fields: each number type needs its own
        vertex_name = f"ChainVertex_{self.precision.real}"
        vertex = self._declare(vertex_name, tables.CHAIN_VERTEX)
        self._declarations.append(f"typedef {vertex_name} ChainVertex;")
        self._declare("ChainState", tables.chain_state(settings.max_depth, vertex))
        self._declare("ChainCounters", tables.chain_counters(len(self.moves.columns())))
        self.buffers = {name: self._upload_scene_array(name, kind) for name, kind in tables.SCENE_ARRAYS.items()}

    @property
    def queue(self) -> cl.CommandQueue:
        """The device's, in order. Raises PylmcError in a process forked from this one, where it would never answer."""
        forks.check()
        return self._queue

    def _declare(self, name: str, fields: Any) -> np.dtype:
        dtype, declaration = structs.declare(self.device, name, real_fields(fields, self.precision.device))
        self.dtypes[name] = dtype
        self._declarations.append(declaration)
        return dtype

    def _upload_scene_array(self, name: str, kind: str) -> cl.Buffer:
        array = self.compiled.arrays[name]
        if kind in self.dtypes:
            return self.upload_struct(array, kind)
        return self.upload(array if kind in tables.FIXED_TYPES else self.precision.to_device(array))

    def upload(self, array: np.ndarray) -> cl.Buffer:
        """A device buffer with the array's content; one byte or more even where it is empty."""
        data = np.ascontiguousarray(array) if array.size else np.zeros(16, np.uint8)
        self._check_size(data.nbytes)
        return cl.Buffer(self.context, cl.mem_flags.READ_WRITE | cl.mem_flags.COPY_HOST_PTR, hostbuf=data)

    def zeros(self, nbytes: int) -> cl.Buffer:
        """A zero-filled device buffer."""
        self._check_size(nbytes)
        buffer = cl.Buffer(self.context, cl.mem_flags.READ_WRITE, max(nbytes, 16))
        self.clear(buffer)
        return buffer

    def clear(self, buffer: cl.Buffer) -> None:
        """Fill a buffer, whose size is a multiple of four bytes, with zeros."""
        cl.enqueue_fill_buffer(self.queue, buffer, np.zeros(1, np.uint32), 0, buffer.size)

    @contextmanager
    def compiling(self) -> Iterator[None]:
        """Count what happens here as compile time: some implementations compile for real at a kernel's first launch."""
        start = time.perf_counter()
        with kept_handlers():
            yield
            self.queue.finish()
        self.compile_seconds += time.perf_counter() - start

    def _check_size(self, nbytes: int) -> None:
        limit = self.device.max_mem_alloc_size
        if nbytes > limit:
            raise PylmcError(
                f"{self.device.name.strip()}: {nbytes / 2**20:.0f} MiB are needed in one piece, but it allows "
                f"{limit / 2**20:.0f}; use a smaller film (--size), fewer path lengths (--max-depth) or "
                "another device"
            )

    def kernel(self, source: str, name: str, **extra: Any) -> cl.Kernel:
        """Kernel ``name`` of ``source``, specialised to the scene and settings; ``extra`` overrides constants."""
        key = source + repr(sorted(extra.items()))
        if key not in self._programs:
            features = self.compiled.features
            constraints = self.compiled.plan.names(self.settings)
            kinds = tables.Kinds(self.compiled.lobe_kinds, self.compiled.light_kinds, constraints)
            deviates = self.settings.coordinates == "deviation" or features["HAS_NARROW"]
            defines = {
                **tables.scene_macros(),
                **tables.enumerations(),
                **tables.dispatch(kinds),
                **self.moves.macros(),
                "NEEDS_TANGENTS": bool(kinds.constraints) or self.settings.drift,
                **features,
                **self.settings.defines(),
                "HAS_DEVIATION": deviates,
                "FILM_SCALE": tables.FILM_SCALE,
                "EVENNESS_GRID": len(self.compiled.arrays["evenness"]),
                **extra,
            }
            with self.compiling():
                self._programs[key] = program.build(
                    self.context,
                    source,
                    defines=defines,
                    files={**tables.files(kinds), "MOVE_FILES": self.moves.files()},
                    structs=self._declarations,
                    real=self.precision.real,
                    math=self.settings.math,
                )
        if (key, name) not in self._kernels:
            self._kernels[key, name] = cl.Kernel(self._programs[key], name)
        return self._kernels[key, name]

    def launch(self, kernel: cl.Kernel, count: int, *arguments: Any, evenness: cl.Buffer | None = None) -> None:
        """Enqueue ``kernel`` over ``count`` work-items: the scene's buffers first, then ``arguments``.

        ``evenness``: the density's weights over the film (see :mod:`pylmc.sampling.evenness`), in place of the scene's
        own, which are one everywhere.
        """
        group = work_group(kernel, self.device)
        buffers = self.buffers if evenness is None else {**self.buffers, "evenness": evenness}
        kernel(self.queue, (padded(count, group),), (group,), *buffers.values(), *arguments)

    def read(self, buffer: cl.Buffer, dtype: Any, shape: Any) -> np.ndarray:
        """Wait for the queue and copy a buffer to a new array."""
        array = np.empty(shape, dtype)
        cl.enqueue_copy(self.queue, array, buffer)
        return array

    def read_into(self, array: np.ndarray, buffer: cl.Buffer, offset: int) -> None:
        """Wait for the queue and fill ``array`` from a buffer, ``offset`` bytes into it."""
        cl.enqueue_copy(self.queue, array, buffer, src_offset=offset)

    def read_struct(self, buffer: cl.Buffer, name: str, count: int) -> np.ndarray:
        """The buffer's ``count`` structs of this name, their reals as the host's numbers."""
        return self.precision.to_host(self.read(buffer, self.dtypes[name], count))

    def upload_struct(self, array: np.ndarray, name: str) -> cl.Buffer:
        """A device buffer of structs of this name with the array's content."""
        return self.upload(self.precision.to_device(array).astype(self.dtypes[name]))

    def upload_reals(self, array: Any) -> cl.Buffer:
        """A device buffer of ``real`` with the array's numbers."""
        return self.upload(self.precision.to_device(np.asarray(array, np.float64)))

    def zero_reals(self, count: int) -> cl.Buffer:
        """A device buffer of ``count`` zeros of type ``real``."""
        return self.zeros(count * self.precision.device.itemsize)

    def read_reals(self, buffer: cl.Buffer, shape: Any) -> np.ndarray:
        """Wait for the queue and copy a buffer of ``real`` to a new array of the host's numbers."""
        return self.precision.to_host(self.read(buffer, self.precision.device, shape))
