"""Philox4x32-10 (Salmon et al. 2011) and the numbers that the kernels make of its words (random.cl).

A stream is named by (seed, stream, step, purpose). Streams draws from many at once, each at its own pace.
"""

from __future__ import annotations

import numpy as np

from .vectors import Array

MULTIPLIERS = np.uint64(0xD2511F53), np.uint64(0xCD9E8D57)
WEYL = np.uint32(0x9E3779B9), np.uint32(0xBB67AE85)
BOOTSTRAP, CHAIN = range(2)  # purposes
BLOCKS = 128  # made ahead for each stream: 512 words


def philox(counter: Array, key: Array) -> Array:
    """Ten rounds on counters (…, 4) under keys (…, 2), all uint32."""
    c0, c1, c2, c3 = (counter[..., i].astype(np.uint32) for i in range(4))
    k0, k1 = (key[..., i].astype(np.uint32) for i in range(2))
    for _ in range(10):
        a, b = c0.astype(np.uint64) * MULTIPLIERS[0], c2.astype(np.uint64) * MULTIPLIERS[1]
        high_a, high_b = ((x >> np.uint64(32)).astype(np.uint32) for x in (a, b))
        low_a, low_b = (x.astype(np.uint32) for x in (a, b))
        c0, c1, c2, c3 = high_b ^ c1 ^ k0, low_b, high_a ^ c3 ^ k1, low_a
        with np.errstate(over="ignore"):
            k0, k1 = k0 + WEYL[0], k1 + WEYL[1]
    return np.stack([c0, c1, c2, c3], axis=-1)


class Streams:
    """One stream per entry of ``streams``. ``single``: a uniform takes 23 bits of one word; else 26 of each of two."""

    def __init__(self, seed: int, streams: Array, step: int | Array, purpose: int, single: bool) -> None:
        n = len(streams)
        self.single = single
        step = np.broadcast_to(np.asarray(step, np.uint64), n)
        counter = np.zeros((n, BLOCKS, 4), np.uint32)
        counter[..., 0] = np.arange(BLOCKS)
        counter[..., 1], counter[..., 2] = step[:, None].astype(np.uint32), (step[:, None] >> np.uint64(32)).astype(np.uint32)
        counter[..., 3] = purpose
        key = np.zeros((n, 1, 2), np.uint32)
        key[..., 0], key[:, 0, 1] = seed, streams
        self.words = philox(counter, key)[..., ::-1].reshape(n, 4 * BLOCKS)  # a block is used from its end
        self.used = np.zeros(n, int)

    def bits(self, wanted: Array) -> Array:
        """The next word (n,) of the ``wanted`` streams; the others stand still and get 0."""
        words = np.zeros(len(wanted), np.uint32)
        words[wanted] = self.words[wanted, self.used[wanted]]
        self.used[wanted] += 1
        return words

    def uniform(self, wanted: Array) -> Array:
        """The next number in the open interval (0, 1) of the ``wanted`` streams."""
        if self.single:
            return ((self.bits(wanted) >> np.uint32(9)) + 0.5) * 2.0**-23
        high, low = self.bits(wanted) >> np.uint32(6), self.bits(wanted) >> np.uint32(6)
        return (high * 2.0**26 + low + 0.5) * 2.0**-52

    def index(self, count: int | Array, wanted: Array) -> Array:
        """The next whole number from 0 to count - 1."""
        return np.minimum((self.uniform(wanted) * count).astype(int), np.asarray(count) - 1)

    def normal2(self, wanted: Array) -> Array:
        """The next two standard normals (n, 2), by Box and Muller."""
        radius, angle = np.sqrt(-2 * np.log(self.uniform(wanted))), 2 * np.pi * self.uniform(wanted)
        return radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
