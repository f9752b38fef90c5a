"""The chain itself: an exact start, then Markov steps on the device (theory.md, 3 and 6).

``Sampler.init(seed)`` weighs independent paths and starts chains in their density; ``step(n)`` advances every chain;
``states()`` lays them open as arrays. ``render`` is a loop around these.
"""

from __future__ import annotations

import time
import warnings
from typing import Any

import numpy as np

from ..checks import check_integer
from ..device import tables
from ..device.device_scene import DeviceScene
from ..errors import PylmcError, PylmcWarning
from ..scene import Scene
from ..settings import Settings, explained
from .compiled import compile_scene
from .evenness import GRID, even_weights
from .groups import Group
from .limits import limits
from .states import Counters, States, Trial

STEPS_PER_LAUNCH = 32
CHAINS, CANDIDATES = 4096, 1 << 18  # of a start that is told neither
CANDIDATES_PER_LAUNCH = 1 << 17
PILOT_FROM = 1 << 31  # numbers of the pilot's paths, beyond those of any start's candidates
FILM_SCALE = 2.0**24  # of film.cl


@explained(Settings)
class Sampler:
    """Chains over a scene's light paths.

    Warns (PylmcWarning) of what ``precision`` cannot be right about. Raises PylmcError for unknown settings, a device that
    is not there, and scenes in which no light path is found.
    """

    def __init__(self, scene: Scene, *, device: Any = None, precision: str = "single", **settings: Any) -> None:
        self.settings = Settings.given(settings)
        if not isinstance(scene, Scene):
            raise PylmcError(f"{scene!r} is not a Scene; pylmc.load(name) makes one from a name or a file")
        self.scene = scene
        start = time.perf_counter()
        self.compiled = compile_scene(scene, precision)
        for sentence in limits(scene, self.compiled, precision):
            warnings.warn(sentence, PylmcWarning, stacklevel=2)
        self.device_scene = DeviceScene(self.compiled, self.settings, device, precision)
        self.seconds = {"build": time.perf_counter() - start, "bootstrap": 0.0, "run": 0.0}
        self.groups: list[Group] = []
        self.dark_groups: list[str] = []  # those in which the start found no light
        self.seed = 0
        self.steps_done = 0
        self._start_not_finite = 0

    @property
    def film_pixels(self) -> int:
        """Pixels of the film."""
        return self.scene.camera.width * self.scene.camera.height

    @property
    def compile_seconds(self) -> float:
        """Time spent compiling kernels so far."""
        return self.device_scene.compile_seconds

    def path_groups(self) -> list[Group]:
        """A group for each path length and ending that the settings admit, nothing known of them yet."""
        kinds = [(k, e) for k in range(1, self.settings.max_depth + 1) for e in self.compiled.endings if k > 1 or e == 1]
        if not kinds:
            raise PylmcError(
                "max_depth=1 leaves only emitters seen directly, and this scene has point lights only; "
                "use --max-depth 2 or more"
            )
        return [Group(length, ending, slot, np.zeros(0), np.zeros((0, 2))) for slot, (length, ending) in enumerate(kinds)]

    def weigh(self, candidates: int = 1 << 18, seed: int = 0) -> list[Group]:
        """Draw ``candidates`` independent paths per group and keep their weights I / p_ind: the estimate of each b.

        I is plain luminance here. Raises PylmcError if no path carries light.
        """
        self.device_scene.set_evenness(np.ones((GRID, GRID), np.float32))
        groups = self._weigh(candidates, seed)
        self._check_found(groups, candidates)
        return groups

    def _check_found(self, groups: list[Group], candidates: int) -> None:
        if not any(group.weight_sum > 0 for group in groups):
            tried = candidates * len(self.path_groups())
            raise PylmcError(
                f"no light path was found in {tried} tries (up to {self.settings.max_depth} segments): check "
                "that the camera sees a surface that light can reach, or raise --max-depth"
            )

    def _weigh(self, candidates: int, seed: int, numbers_from: int = 0) -> list[Group]:
        self.seed = seed
        groups = self.path_groups()
        kernel = self.device_scene.kernel("entry/bootstrap.cl", "weigh_candidates")
        start = time.perf_counter()
        device = self.device_scene
        out, out_positions = device.zero_reals(CANDIDATES_PER_LAUNCH), device.zero_reals(2 * CANDIDATES_PER_LAUNCH)
        for group in groups:
            parts, places = [], []
            for first in range(0, candidates, CANDIDATES_PER_LAUNCH):
                count = min(CANDIDATES_PER_LAUNCH, candidates - first)
                device.launch(
                    kernel,
                    count,
                    np.uint32(seed),
                    np.uint32(group.slot),
                    np.int32(group.length),
                    np.int32(group.ending),
                    np.uint32(numbers_from + first),
                    np.uint32(count),
                    out,
                    out_positions,
                )
                parts.append(device.read_reals(out, CANDIDATES_PER_LAUNCH)[:count])
                places.append(device.read_reals(out_positions, (CANDIDATES_PER_LAUNCH, 2))[:count])
            group.log_weights = np.concatenate(parts).astype(np.float64)
            group.positions = np.concatenate(places)
            group.weighed = candidates
            group.settle()
        self.seconds["bootstrap"] += time.perf_counter() - start
        return groups

    def init(self, seed: int = 0, chains: int | None = None, candidates: int | None = None) -> list[Group]:
        """Start ``chains`` chains in their density: resample the candidates in proportion to their weights.

        ``chains`` and ``candidates`` are those of the settings if not given here. The chains
        are shared out among the groups in proportion to b; a group in which no light was found has none. The
        same seed gives the same chains. Returns the groups.
        """
        seed = check_integer("seed", seed, 0, 2**32 - 1)
        if chains is None:
            chains = self.settings.chains or CHAINS
        chains = check_integer("chains", chains, 1, 1 << 24)
        if candidates is None:
            candidates = self.settings.candidates or CANDIDATES
        candidates = check_integer("candidates", candidates, 1, 1 << 30)
        self.device_scene.set_evenness(np.ones((GRID, GRID), np.float32))
        if self.settings.even:
            self._weight_density(max(candidates // 4, 1))
        weighed = self._weigh(candidates, seed)
        self._check_found(weighed, candidates)
        self._start_not_finite = sum(group.not_finite for group in weighed)
        groups = [group for group in weighed if group.weight_sum > 0]
        self.dark_groups = [group.name for group in weighed if not group.weight_sum > 0]
        total = sum(group.b for group in groups)
        rng = np.random.default_rng([seed, 1])
        starts = []
        first = 0
        for slot, group in enumerate(groups):
            group.first, group.chains = first, max(round(chains * group.b / total), 8)
            weights = np.exp(group.log_weights - group.log_weights.max())
            points = (np.arange(group.chains) + rng.random()) / group.chains * weights.sum()
            chosen = np.minimum(np.searchsorted(np.cumsum(weights), points, side="right"), len(weights) - 1)
            part = np.zeros(group.chains, tables.CHAIN_START)
            part["group"], part["slot"], part["number"] = group.slot, slot, chosen
            part["length"], part["ending"] = group.length, group.ending
            starts.append(part)
            first += group.chains
        self.groups, self.chains, self.steps_done = groups, first, 0
        device = self.device_scene
        dtypes = device.dtypes
        self._states = device.zeros(first * dtypes["ChainState"].itemsize)
        self._counters = device.zeros(first * dtypes["ChainCounters"].itemsize)
        self._film = device.zeros(len(groups) * self.film_pixels * 24)
        kernel = device.kernel("entry/bootstrap.cl", "start_chains")
        table = device.upload_struct(np.concatenate(starts), "ChainStart")
        device.launch(kernel, first, np.uint32(seed), np.uint32(first), table, self._states)
        self._kernel = device.kernel("entry/chains.cl", "run_chains")
        with device.compiling():
            self._launch(0)
        return groups

    def _launch(self, steps: int) -> None:
        self.device_scene.launch(
            self._kernel,
            self.chains,
            np.uint32(self.seed),
            np.uint64(self.steps_done),
            np.int32(steps),
            np.uint32(self.chains),
            *self._step_numbers(),
            self._states,
            self._counters,
            self._film,
            np.int32(self.film_pixels),
        )

    def _step_numbers(self) -> tuple[np.float32, np.float32, np.float32]:
        """What markov_step.cl needs to know of a step: the probability of a large one, and the range of log h."""
        low, high = self.settings.step_length
        return np.float32(self.settings.large_steps), np.float32(np.log(low)), np.float32(np.log(high))

    def _weight_density(self, pilot: int) -> None:
        """Weight the density over the film by a rough picture, the same one whatever the seed.

        Its paths are none of the start's: weights fitted to the candidates that they then weigh would come out too low,
        and b with them.
        """
        groups = self._weigh(pilot, 0, PILOT_FROM)
        positions = np.concatenate([group.positions for group in groups])
        weights = np.concatenate([np.exp(group.log_weights) for group in groups])
        self.device_scene.set_evenness(even_weights(positions, weights))

    def step(self, n: int = STEPS_PER_LAUNCH) -> None:
        """Advance every chain by ``n`` steps and wait."""
        n = check_integer("n", n, 0, 1 << 40)
        self._check_started()
        start = time.perf_counter()
        for done in range(0, n, STEPS_PER_LAUNCH):
            steps = min(STEPS_PER_LAUNCH, n - done)
            self._launch(steps)
            self.steps_done += steps
        self.device_scene.queue.finish()
        for group in self.groups:
            group.steps += n
        self.seconds["run"] += time.perf_counter() - start

    def _check_started(self) -> None:
        if not self.groups:
            raise PylmcError("the chains have not been started: call Sampler.init(seed) first")

    def counters(self) -> Counters:
        """Read and clear the chains' counters; large steps refine each group's b.

        Candidates of the start whose weight was not finite are counted with the first call's ``not_finite``.
        """
        self._check_started()
        device = self.device_scene
        counts = device.read_struct(self._counters, "ChainCounters", self.chains)
        device.clear(self._counters)
        for group in self.groups:
            part = counts[group.first : group.first + group.chains]
            group.weighed += int(part["proposed"][:, 0].sum(dtype=np.int64))
            group.weight_sum += float(part["weight_sum"].sum(dtype=np.float64))
            group.weight_square_sum += float(part["weight_square_sum"].sum(dtype=np.float64))
        not_finite = int(counts["not_finite"].sum(dtype=np.int64)) + self._start_not_finite
        self._start_not_finite = 0
        return Counters(
            counts["proposed"], counts["acceptance"], counts["trace"], not_finite, int(counts["rays"].sum(dtype=np.int64))
        )

    def films(self) -> np.ndarray:
        """Each group's accumulated splats (groups, height, width, 3), float64, not yet normalised."""
        self._check_started()
        return np.stack([self._film_of(slot) for slot in range(len(self.groups))])

    def _film_of(self, slot: int) -> np.ndarray:
        """One group's splats (height, width, 3): large films do not fit into memory several times over."""
        camera = self.scene.camera
        words = np.empty((camera.height, camera.width, 3), np.dtype("<u8"))
        self.device_scene.read_into(words, self._film, slot * words.nbytes)
        film = words.view(np.float64)
        return np.divide(words, FILM_SCALE, out=film)

    def image(self, films: np.ndarray | None = None) -> np.ndarray:
        """The picture so far (height, width, 3), float64, in the scene's units of radiance."""
        total = np.zeros((self.scene.camera.height, self.scene.camera.width, 3))
        for slot, group in enumerate(self.groups):
            film = self._film_of(slot) if films is None else films[slot].copy()
            film *= group.b * self.film_pixels / (max(group.steps, 1) * group.chains) * self.compiled.radiance_scale
            total += film
        return total

    def states(self, block: int = 0) -> States:
        """Every chain's path; ``block`` limits charts and factors to that many leading directions (0: all free ones)."""
        self._check_started()
        device, k = self.device_scene, self.settings.max_depth
        chains = self.chains
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
        device.launch(kernel, chains, np.uint32(chains), self._states, np.int32(block), *buffers)
        for name, buffer in zip(arrays, buffers, strict=True):
            whole = arrays[name].dtype == np.int32
            shape = arrays[name].shape
            arrays[name] = device.read(buffer, np.int32, shape) if whole else device.read_reals(buffer, shape)
        raw = device.read_struct(self._states, "ChainState", chains)
        nodes = arrays["nodes"] * self.compiled.scale + self.compiled.centre
        return States(
            raw["length"],
            raw["ending"],
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

    def displaced(self, deltas: np.ndarray, block: int = 0) -> tuple[np.ndarray, np.ndarray]:
        """Where displacements (chains, 2 K) in the chains' charts lead: nodes (scaled units) and directions; NaN: nowhere."""
        self._check_started()
        device, k = self.device_scene, self.settings.max_depth
        shape = (self.chains, k, 3)
        nodes, directions = (device.upload_reals(np.full(shape, np.nan)) for _ in range(2))
        kernel = device.kernel("entry/inspect.cl", "displace_chains")
        device.launch(
            kernel,
            self.chains,
            np.uint32(self.chains),
            self._states,
            np.int32(block),
            device.upload_reals(deltas),
            nodes,
            directions,
        )
        return device.read_reals(nodes, shape), device.read_reals(directions, shape)

    def trial(self, number: int | None = None) -> Trial:
        """What one step of each chain would do, the chains staying as they are.

        ``number`` names its random numbers: those of the chains' step of this number (the first is 0), or of the next one.
        """
        self._check_started()
        device, chains, k = self.device_scene, self.chains, self.settings.max_depth
        number = self.steps_done if number is None else check_integer("number", number, 0, 1 << 40)
        counts = {"drawn": (2,), "lobes": (k,), "triangles": (k,)}
        reals = {"numbers": (6,), "xi": (2 * k,), "nodes": (k, 3), "directions": (k, 3)}
        whole = {name: device.upload(np.full((chains, *shape), -1, np.int32)) for name, shape in counts.items()}
        real = {name: device.upload_reals(np.full((chains, *shape), np.nan)) for name, shape in reals.items()}
        kernel = device.kernel("entry/inspect.cl", "try_step")
        device.launch(
            kernel,
            chains,
            np.uint32(self.seed),
            np.uint64(number),
            np.uint32(chains),
            *self._step_numbers(),
            self._states,
            whole["drawn"],
            real["numbers"],
            real["xi"],
            real["nodes"],
            real["directions"],
            whole["lobes"],
            whole["triangles"],
        )
        drawn, lobes, triangles = (device.read(whole[name], np.int32, (chains, *shape)) for name, shape in counts.items())
        numbers, xi, nodes, directions = (device.read_reals(real[name], (chains, *shape)) for name, shape in reals.items())
        move, exists = drawn[:, 0], drawn[:, 1] != 1  # STEP_NO_PATH
        h, log_forward, log_reverse, log_pi, acceptance, uniform = numbers.T.astype(np.float64)
        # small_step.cl leaves out what the step and its reverse have in common
        common = np.where(move > 0, move * np.log(2 * np.pi) + 2 * move * np.log(np.where(move > 0, h, 1)), 0)
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
