"""Typed handles on device buffers: what lies there, how many, and host arrays in and out. Bytes are counted here alone."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pyopencl as cl

from ..errors import PylmcError, PylmcWarning
from .tables import FILM_SCALE

if TYPE_CHECKING:
    from .device_scene import DeviceScene

FILM_WORD = np.dtype("<u8")
FULL = np.uint64(0xFFFFFFFF << 32)  # a cell from here on counts no further


class Records:
    """``count`` structs of one ``kind`` on a device. A handle that was taken is of no more use: its taker has the buffer."""

    def __init__(self, device: DeviceScene, kind: str, count: int) -> None:
        self.device, self.kind, self.count = device, kind, count
        self._buffer: cl.Buffer | None = device.zeros(count * device.dtypes[kind].itemsize)

    @classmethod
    def of(cls, device: DeviceScene, kind: str, array: np.ndarray) -> Records:
        """The structs of ``array``, whose fields are those of ``kind`` (see pylmc.device.tables)."""
        records = cls.__new__(cls)
        records.device, records.kind, records.count = device, kind, len(array)
        records._buffer = device.upload_struct(array, kind)
        return records

    @property
    def buffer(self) -> cl.Buffer:
        """For kernels. Raises PylmcError if the handle was taken."""
        if self._buffer is None:
            raise PylmcError("this State was consumed by step(): go on with the State that step() returned")
        return self._buffer

    def take(self) -> Records:
        """Another handle on the same structs, in place of this one. Raises PylmcError if this one was taken before."""
        taken = Records.__new__(Records)
        taken.device, taken.kind, taken.count, taken._buffer = self.device, self.kind, self.count, self.buffer
        self._buffer = None
        return taken

    def read(self) -> np.ndarray:
        """Wait for the device and copy the structs to the host, (count,), their reals as the host's numbers."""
        return self.device.read_struct(self.buffer, self.kind, self.count)

    def clear(self) -> None:
        """Fill with zeros."""
        self.device.clear(self.buffer)


class Floats:
    """A float32 array on a device."""

    def __init__(self, device: DeviceScene, array: np.ndarray) -> None:
        self.device, self.shape = device, array.shape
        self.buffer = device.upload(array.astype(np.float32, copy=False))

    def read(self) -> np.ndarray:
        """Wait for the device and copy the numbers to the host."""
        return self.device.read(self.buffer, np.float32, self.shape)


class Film:
    """``slots`` pictures (height, width, 3) that kernels add splats to, in 64-bit fixed point (see film.cl)."""

    def __init__(self, device: DeviceScene, slots: int, height: int, width: int) -> None:
        self.device, self.slots, self.shape = device, slots, (height, width, 3)
        self.buffer = device.zeros(slots * height * width * 3 * FILM_WORD.itemsize)
        self._warned = False

    @property
    def pixels(self) -> int:
        """Of one picture."""
        return self.shape[0] * self.shape[1]

    def words(self, slot: int) -> np.ndarray:
        """One picture as it lies on the device: 64-bit integers (height, width, 3), FILM_SCALE to the unit."""
        words = np.empty(self.shape, FILM_WORD)
        self.device.read_into(words, self.buffer, slot * words.nbytes)
        return words

    def read(self, slot: int) -> np.ndarray:
        """One picture's sum (height, width, 3), float64: large films do not fit into memory several times over.

        Warns once if a cell is full.
        """
        words = self.words(slot)
        if not self._warned and np.any(words >= FULL):
            self._warned = True
            warnings.warn(
                f"{np.any(words >= FULL, axis=2).sum()} pixels of the film are full and come out too dark: their light comes "
                "in few, enormous splats; use integrator 'lmc', whose splats are of one size, or give the lights a size",
                PylmcWarning,
                stacklevel=2,
            )
        return np.divide(words, FILM_SCALE, out=words.view(np.float64))

    def slot(self, slot: int) -> FilmSlot:
        """One of the pictures, to be read later."""
        return FilmSlot(self, slot)

    def clear(self) -> None:
        """Forget all splats."""
        self.device.clear(self.buffer)


@dataclass(frozen=True)
class FilmSlot:
    """One of a film's pictures."""

    film: Film
    slot: int

    def read(self) -> np.ndarray:
        """Its sum so far (height, width, 3), float64."""
        return self.film.read(self.slot)
