"""Lists the devices of one OpenCL implementation and runs a small kernel on each; started by pylmc.device.survey.

It runs in a process of its own because a broken driver may abort or hang: ``python -P _probe.py FIRST [LIBRARY ...]``
with OCL_ICD_VENDORS naming the implementation. The LIBRARYs are loaded first, and devices before number FIRST (counted
over all platforms) are skipped: that is how the caller goes on behind a device that brought the process down.

Every line on stdout is a JSON object: {"listed": n} once, then for each device {"device": {...}} before it is tried and
{"ok": true} or {"error": "..."} after.
"""

import ctypes
import json
import sys
from typing import Any

SOURCE = """
__kernel void pylmc_probe(__global int *out, int n)
{
    int i = get_global_id(0), sum = 0;
    for (int k = 0; k < n; ++k)
        sum += i * k;
    out[i] = sum;
}
"""


def say(**event: Any) -> None:
    print(json.dumps(event), flush=True)


def run_kernel(cl: Any, np: Any, device: Any) -> None:
    """Build and run the kernel on ``device``; raises whatever the driver does, ArithmeticError for wrong numbers."""
    items, steps = 64, 10
    context = cl.Context([device])
    queue = cl.CommandQueue(context)
    kernel = cl.Kernel(cl.Program(context, SOURCE).build(), "pylmc_probe")
    out = cl.Buffer(context, cl.mem_flags.WRITE_ONLY, 4 * items)
    kernel(queue, (items,), None, out, np.int32(steps))
    numbers = np.zeros(items, np.int32)
    cl.enqueue_copy(queue, numbers, out)
    queue.finish()
    if not np.array_equal(numbers, np.arange(items) * (steps * (steps - 1) // 2)):
        raise ArithmeticError("the test kernel returned wrong numbers")


def main(first: int, libraries: list[str]) -> None:
    for library in libraries:
        ctypes.CDLL(library)
    import numpy as np
    import pyopencl as cl

    try:
        platforms = cl.get_platforms()
    except cl.Error:  # what the loader says when no implementation could be opened
        platforms = []
    devices = []
    for platform in platforms:
        try:
            found = platform.get_devices()
        except cl.Error:  # a platform without devices, such as a GPU driver where there is no GPU
            found = []
        devices += [(platform, position, device) for position, device in enumerate(found)]
    say(listed=len(devices), platforms=[platform.name.strip() for platform in platforms])
    for platform, position, device in devices[first:]:
        extensions = device.extensions.split()
        kinds = {cl.device_type.CPU: "cpu", cl.device_type.GPU: "gpu"}
        say(
            device={
                "name": device.name.strip(),
                "kind": next((name for bit, name in kinds.items() if device.type & bit), "other"),
                "platform": platform.name.strip(),
                "platform_version": platform.version.strip(),
                "driver": device.driver_version.strip(),
                "position": position,
                "compute_units": device.max_compute_units,
                "memory": device.global_mem_size,
                "fp64": "cl_khr_fp64" in extensions,
                "int64_atomics": "cl_khr_int64_base_atomics" in extensions,
            }
        )
        try:
            run_kernel(cl, np, device)
        except Exception as error:
            say(error=f"{type(error).__name__}: {error}")
        else:
            say(ok=True)


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2:])
