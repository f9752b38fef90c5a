"""How many work-items make a work-group: as many as the device runs in step, and no more."""

from __future__ import annotations

import pyopencl as cl

# On a CPU the number hardly shows (8 % at most, from 4 to 128, with PoCL and with Intel's runtime), but private memory of one
# work-item is several kilobytes, and PoCL keeps a whole work-group's on a thread's stack.
ON_CPU = 16


def work_group(kernel: cl.Kernel, device: cl.Device) -> int:
    """The work-group's size for ``kernel`` on ``device``: a GPU's own (32 or 64, mostly), less where the kernel needs it."""
    info = cl.kernel_work_group_info
    most = kernel.get_work_group_info(info.WORK_GROUP_SIZE, device)
    if device.type & cl.device_type.CPU:
        return min(ON_CPU, most)
    return min(kernel.get_work_group_info(info.PREFERRED_WORK_GROUP_SIZE_MULTIPLE, device), most)


def padded(count: int, group: int) -> int:
    """``count`` work-items or more that fill whole groups; kernels leave out what is too many."""
    return -(-count // group) * group
