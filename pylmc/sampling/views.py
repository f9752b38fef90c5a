"""Chains laid open, without moving them: paths, charts, factors and densities; where displacements and steps would lead."""

from __future__ import annotations

import numpy as np

from .chains import State
from .states import States, Trial


def states(state: State, block: int = 0) -> States:
    """Every chain's path; ``block`` limits charts and factors to that many leading directions (0: all free ones)."""
    device, chains = state.chains.device, state.chains.count
    k, compiled = device.settings.max_depth, device.compiled
    shapes = {
        "nodes": (k, 3),
        "directions": (k, 3),
        "deviations": (k, 2),
        "kinds": (k,),
        "lobes": (k,),
        "densities": (2,),
        "factors": (2 * k, 2 * k),
        "gradients": (2 * k,),
    }
    arrays = {
        name: np.full((chains, *shape), -1, np.int32) if name in ("kinds", "lobes") else np.full((chains, *shape), np.nan)
        for name, shape in shapes.items()
    }
    arrays["factors"][:] = 0
    buffers = [device.upload(device.precision.to_device(array)) for array in arrays.values()]
    kernel = device.kernel("entry/inspect.cl", "describe_chains")
    device.launch(
        kernel,
        chains,
        np.uint32(chains),
        state.chains.buffer,
        np.int32(block),
        *buffers,
        evenness=state.evenness.buffer,
    )
    for name, buffer in zip(arrays, buffers, strict=True):
        whole = arrays[name].dtype == np.int32
        shape = arrays[name].shape
        arrays[name] = device.read(buffer, np.int32, shape) if whole else device.read_reals(buffer, shape)
    content = state.arrays()
    nodes = arrays["nodes"] * compiled.scale + compiled.centre
    return States(
        content.length,
        content.ending,
        arrays["directions"][:, 0],
        nodes,
        arrays["directions"],
        arrays["deviations"],
        arrays["lobes"],
        arrays["kinds"],
        arrays["densities"][:, 0],
        arrays["densities"][:, 1],
        arrays["factors"],
        arrays["gradients"],
    )


def displaced(state: State, deltas: np.ndarray, block: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Where displacements (chains, 2 K) in the chains' charts lead: nodes (scaled units) and directions; NaN: nowhere."""
    device, chains = state.chains.device, state.chains.count
    shape = (chains, device.settings.max_depth, 3)
    nodes, directions = (device.upload_reals(np.full(shape, np.nan)) for _ in range(2))
    kernel = device.kernel("entry/inspect.cl", "displace_chains")
    device.launch(
        kernel,
        chains,
        np.uint32(chains),
        state.chains.buffer,
        np.int32(block),
        device.upload_reals(deltas),
        nodes,
        directions,
        evenness=state.evenness.buffer,
    )
    return device.read_reals(nodes, shape), device.read_reals(directions, shape)


def trial(state: State, number: int | None = None) -> Trial:
    """What one step of each chain would do, by the random numbers of the step of this number, or of the next one."""
    device, chains = state.chains.device, state.chains.count
    k = device.settings.max_depth
    number = state.steps if number is None else number
    counts = {"drawn": (2,), "lobes": (k,), "triangles": (k,)}
    reals = {"numbers": (6,), "xi": (2 * k,), "nodes": (k, 3), "directions": (k, 3)}
    whole = {name: device.upload(np.full((chains, *shape), -1, np.int32)) for name, shape in counts.items()}
    real = {name: device.upload_reals(np.full((chains, *shape), np.nan)) for name, shape in reals.items()}
    kernel = device.kernel("entry/inspect.cl", "try_step")
    device.launch(
        kernel,
        chains,
        np.uint32(state.seed),
        np.uint64(number),
        np.uint32(chains),
        device.upload(device.moves.numbers()),
        state.chains.buffer,
        whole["drawn"],
        real["numbers"],
        real["xi"],
        real["nodes"],
        real["directions"],
        whole["lobes"],
        whole["triangles"],
        evenness=state.evenness.buffer,
    )
    drawn, lobes, triangles = (device.read(whole[name], np.int32, (chains, *shape)) for name, shape in counts.items())
    numbers, xi, nodes, directions = (device.read_reals(real[name], (chains, *shape)) for name, shape in reals.items())
    move, exists = drawn[:, 0], drawn[:, 1] != 1  # STEP_NO_PATH
    h, log_forward, log_reverse, log_pi, acceptance, uniform = numbers.T.astype(np.float64)
    # moves/small.cl leaves out what the step and its reverse have in common
    m = np.where((move > 0) & (move <= k), move, 0)
    common = m * np.log(2 * np.pi) + 2 * m * np.log(np.where(m > 0, h, 1))
    log_pi = np.where(exists, log_pi, np.nan)
    return Trial(
        move,
        h,
        xi,
        exists,
        nodes,
        directions,
        lobes,
        triangles,
        log_forward - common,
        log_reverse - common,
        log_pi,
        acceptance,
        uniform,
        uniform < acceptance,
    )
