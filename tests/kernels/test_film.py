"""The film's 64-bit sums out of 32-bit atomics: exact, whatever the order; and pictures that a seed determines."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from studies.probes import build_probe

import pylmc
from pylmc.device.arrays import FULL, Film
from pylmc.device.device_scene import DeviceScene
from pylmc.device.tables import FILM_SCALE
from pylmc.sampling.compiled import compile_scene
from pylmc.settings import Settings

SOURCE = """
#include "number/vectors.cl"
#include "trace/traverse.cl"
#include "surface/scene.cl"
#include "path/film.cl"

__kernel void probe_film(SCENE_PARAMETERS, int count, __global const int *pixels, __global const float *values,
                         __global volatile uint *film) {
    int i = get_global_id(0);
    if (i < count) film_add(film, pixels[i], vload3(i, values));
}
"""
PIXELS = 5  # few, so that work-items collide


@pytest.fixture(scope="module")
def device() -> DeviceScene:
    return DeviceScene(compile_scene(pylmc.load("box").with_size(8, 8)), Settings(max_depth=2))


def filled(device: DeviceScene, pixels: np.ndarray, values: np.ndarray) -> Film:
    """A film of PIXELS pixels after concurrent additions."""
    kernel = build_probe(device, SOURCE, "probe_film")
    film = Film(device, 1, 1, PIXELS)
    device.launch(
        kernel,
        len(pixels),
        np.int32(len(pixels)),
        device.upload(pixels.astype(np.int32)),
        device.upload(values.astype(np.float32)),
        film.buffer,
    )
    return film


def add(device: DeviceScene, pixels: np.ndarray, values: np.ndarray) -> np.ndarray:
    """The film (PIXELS, 3) of 64-bit words after concurrent additions."""
    return filled(device, pixels, values).words(0)[0]


def exact(pixels: np.ndarray, values: np.ndarray) -> np.ndarray:
    """The same in Python's integers: each value once rounded to 2^-24, in float32 as the kernel has it."""
    scaled = values.astype(np.float32) * np.float32(FILM_SCALE) + np.float32(0.5)
    total = [[0, 0, 0] for _ in range(PIXELS)]
    for pixel, words in zip(pixels, np.floor(scaled).astype(np.uint64), strict=True):
        for channel in range(3):
            total[pixel][channel] += int(words[channel])
    return np.array(total, dtype=np.uint64)


def test_concurrent_sums_are_exact(device: DeviceScene) -> None:
    """Values from nothing to a million, on five pixels: low words wrap often, and every carry arrives."""
    rng = np.random.default_rng(0)
    n = 60_000
    pixels = rng.integers(0, PIXELS, n)
    values = np.exp(rng.uniform(np.log(1e-9), np.log(1e6), (n, 3))).astype(np.float32)
    values[rng.random((n, 3)) < 0.1] = 0
    expected = exact(pixels, values)
    assert expected.min() > 2**40  # the high words are in use
    film = add(device, pixels, values)
    assert np.array_equal(film, expected)
    order = rng.permutation(n)
    assert np.array_equal(add(device, pixels[order], values[order]), film)


def test_carry_at_the_words_edge(device: DeviceScene) -> None:
    """Many equal halves of the low word: every second addition wraps."""
    n = 4096
    pixels, values = np.zeros(n, int), np.full((n, 3), 128.0)
    film = add(device, pixels, values)
    assert np.all(film[0] == n * 2**31) and not film[1:].any()


def test_nothing_and_nan_leave_the_film_alone(device: DeviceScene) -> None:
    """What is not a positive number adds nothing; a NaN once became the largest word there is."""
    values = np.array([[np.nan, 0.0, -1.0], [1.0, 2.0, 3.0]])
    film = add(device, np.array([1, 2]), values)
    assert not film[[0, 1, 3, 4]].any()
    assert np.array_equal(film[2] / FILM_SCALE, [1, 2, 3])


@pytest.mark.parametrize("splat", [2.0**38, 2.0**39 + 2.0**31, 2.0**41, 3e38, np.inf])
def test_a_full_cell_stays_full_and_is_told_once(device: DeviceScene, splat: float) -> None:
    """2^64 and more does not wrap, whether it comes in one splat or in several; other cells are exact."""
    n = 64
    pixels, values = np.tile([1, 2], n), np.tile([[1.0, splat, 0.0], [1.0, 2.0, 3.0]], (n, 1))
    film = filled(device, pixels, values)
    words = film.words(0)[0]
    assert words[1, 1] >= FULL
    words[1, 1] = 0
    assert np.array_equal(words / FILM_SCALE, np.array([[0, 0, 0], [n, 0, 0], [n, 2 * n, 3 * n], [0, 0, 0], [0, 0, 0]]))
    with pytest.warns(pylmc.PylmcWarning, match=r"^1 pixels of the film are full and come out too dark"):
        film.read(0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert film.read(0)[0, 1, 1] >= 2.0**40 - 2.0**8
        Film(device, 1, 1, PIXELS).read(0)


@pytest.mark.parametrize("integrator", ["lmc", "bdpt", "path"])
def test_the_seed_makes_the_picture(integrator: str) -> None:
    """The same seed twice: the same bits. Another seed: another picture."""
    scene = pylmc.load("keyhole", hole=0.4, alpha=0.2).with_size(24, 18)

    def picture(seed: int) -> np.ndarray:
        work = {"mutations_per_pixel": 60, "integrator": integrator, "max_depth": 4, "progress": False}
        return pylmc.render(scene, seed=seed, **work).image

    first = picture(1)
    assert first.max() > 0 and np.all(np.isfinite(first))
    assert np.array_equal(first, picture(1))
    assert not np.array_equal(first, picture(2))
