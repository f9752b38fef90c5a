"""What holds for every integrator: memory stays flat, looking changes nothing, and the picture is its estimators' sum."""

import tracemalloc
from collections.abc import Callable

import numpy as np
import pytest

import pylmc
from pylmc import Sampler
from pylmc.integrators import INTEGRATORS, made
from pylmc.integrators.integrator import Integrator
from pylmc.picture.estimators import Estimator, picture

SIDE = 16


def prepared(name: str, side: int = SIDE, depth: int = 3) -> Integrator:
    sampler = Sampler(pylmc.load("box", width=side, height=side), max_depth=depth, chains=256, candidates=1 << 12)
    worker = made(name, sampler)
    worker.prepare(7, quick=True)
    return worker


def traced(work: Callable[[], object]) -> tuple[int, int]:
    """(bytes that stay, bytes at most on the way)."""
    tracemalloc.start()
    try:
        before = tracemalloc.get_traced_memory()[0]
        tracemalloc.reset_peak()
        work()
        now, peak = tracemalloc.get_traced_memory()
        return now - before, peak - before
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("name", INTEGRATORS)
def test_launches_leave_nothing_behind(name: str) -> None:
    """Beyond a chain's place on the film, 16 bytes for each of up to 64 chains a group, whose number is bounded as well."""
    worker = prepared(name)
    for _ in range(20):
        worker.advance()
    launches = 40
    stays, _ = traced(lambda: [worker.advance() for _ in range(launches)])
    positions = launches * 64 * 16 * 6 if name == "lmc" else 0
    assert stays < positions + 100_000, f"{stays / launches:.0f} bytes a launch"


@pytest.mark.parametrize("name", INTEGRATORS)
def test_films_are_read_one_at_a_time(name: str) -> None:
    worker = prepared(name, side=128, depth=6)
    worker.advance()
    assert len(worker.estimators()) == (1 if name == "path" else 6)
    _, peak = traced(worker.image)
    assert peak < 4 * worker.image().nbytes


@pytest.mark.parametrize("name", INTEGRATORS)
def test_looking_changes_nothing(name: str) -> None:
    pictures, errors = [], []
    for look in (False, True):
        worker = prepared(name)
        for _ in range(70):
            worker.advance()
            if look:
                worker.image(), worker.variance(), worker.note(), worker.diagnostics()
        pictures.append(worker.image())
        errors.append(worker.variance())
    np.testing.assert_array_equal(*pictures)
    np.testing.assert_array_equal(*errors)


@pytest.mark.parametrize("name", INTEGRATORS)
def test_a_run_is_its_estimators(name: str) -> None:
    """Two runs of one scene, put together by their estimators alone, are the mean of both, each by its work."""
    workers = [prepared(name), prepared(name)]
    for worker, launches in zip(workers, (2, 6), strict=True):
        for _ in range(launches):
            worker.advance()
    parts = [e for worker, share in zip(workers, (0.25, 0.75), strict=True) for e in shared(worker.estimators(), share)]
    expected = 0.25 * workers[0].image() + 0.75 * workers[1].image()
    np.testing.assert_allclose(picture(parts), expected, rtol=1e-12)
    assert all(e.work > 0 and e.normalisation > 0 and e.name for e in parts)


def shared(estimators: list[Estimator], share: float) -> list[Estimator]:
    return [estimator._replace(weight=share) for estimator in estimators]
