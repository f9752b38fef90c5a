"""Devices on which the same arithmetic gives the same bits."""

from __future__ import annotations

from functools import cache

import numpy as np
import pyopencl as cl
import pytest

from pylmc.device import survey

SOURCE = """
__kernel void probe(__global const float *x, __global const float *y, __global float *out) {
    int i = get_global_id(0), n = get_global_size(0);
    out[i] = x[i] / y[i];
    out[n + i] = sqrt(x[i]);
}
"""
COUNT = 1 << 16


def rounds(device: cl.Device) -> bool:
    """Whether division and square root are rounded as IEEE 754 has it: tried, since not every device that does says so."""
    context, queue = survey.context_and_queue(device)
    flag = cl.device_fp_config.CORRECTLY_ROUNDED_DIVIDE_SQRT
    options = ["-cl-fp32-correctly-rounded-divide-sqrt"] if device.single_fp_config & flag else []
    kernel = cl.Kernel(cl.Program(context, SOURCE).build(options=options), "probe")
    x, y = np.exp2(np.random.default_rng(0).uniform(-30, 30, (2, COUNT))).astype(np.float32)
    flags = cl.mem_flags.READ_WRITE | cl.mem_flags.COPY_HOST_PTR
    out = np.empty((2, COUNT), np.float32)
    buffers = [cl.Buffer(context, flags, hostbuf=array) for array in (x, y, out)]
    kernel(queue, (COUNT,), None, *buffers)
    cl.enqueue_copy(queue, out, buffers[2])
    return np.array_equal(out, [x / y, np.sqrt(x)])


@cache
def _alike() -> tuple[str, ...]:
    return tuple(str(index) for index in range(len(survey.usable())) if rounds(survey.select(str(index))))


def alike() -> tuple[str, ...]:
    """Two or more devices, as SPEC, that round alike; the test is skipped where there are none."""
    if len(_alike()) < 2:
        pytest.skip("needs two usable OpenCL devices that divide as IEEE 754 has it (pip install pylmc[intel] adds one)")
    return _alike()
