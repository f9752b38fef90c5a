"""Work-groups' sizes: by device and kernel, and of no consequence for the picture."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pyopencl as cl
import pytest

import pylmc
from pylmc.device import device_scene
from pylmc.device.work_groups import padded, work_group

CPU, GPU = cl.device_type.CPU, cl.device_type.GPU


@pytest.mark.parametrize(
    ("kind", "multiple", "most", "size"),
    [(GPU, 32, 1024, 32), (GPU, 64, 256, 64), (GPU, 64, 48, 48), (CPU, 8, 4096, 16), (CPU, 128, 8192, 16), (CPU, 1, 1, 1)],
)
def test_the_size_is_a_gpus_own_and_small_on_a_cpu(kind: int, multiple: int, most: int, size: int) -> None:
    info = cl.kernel_work_group_info
    told = {info.PREFERRED_WORK_GROUP_SIZE_MULTIPLE: multiple, info.WORK_GROUP_SIZE: most}
    kernel = SimpleNamespace(get_work_group_info=lambda what, device: told[what])
    assert work_group(kernel, SimpleNamespace(type=kind)) == size


def test_groups_are_filled() -> None:
    assert [padded(count, 16) for count in (0, 1, 16, 17)] == [0, 16, 16, 32]


def test_the_size_changes_no_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    """Chains, counters and film come out the same, bit for bit."""
    scene = pylmc.load("keyhole", hole=0.4, alpha=0.2).with_size(16, 12)

    def picture(size: int) -> np.ndarray:
        monkeypatch.setattr(device_scene, "work_group", lambda kernel, device: size)
        return pylmc.render(scene, mutations_per_pixel=80, max_depth=3, chains=100, candidates=5000, progress=False).image

    first = picture(16)
    assert first.max() > 0
    for size in (1, 32, 48):
        assert np.array_equal(picture(size), first)
