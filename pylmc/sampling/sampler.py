"""The chain itself: an exact start, then Markov steps on the device (theory.md, 3 and 6).

``Sampler.init(seed)`` weighs independent paths and starts chains in their density; ``step(n)`` advances every chain;
``states()`` lays them open as arrays. ``render`` is a loop around these. It keeps one :class:`pylmc.sampling.chains.State`
and its film; whoever wants to hold states himself uses ``start`` and ``step`` from those modules.
"""

from __future__ import annotations

import time
import warnings
from copy import copy
from typing import Any

import numpy as np

from ..checks import check_integer
from ..device.arrays import Film
from ..device.device_scene import DeviceScene
from ..errors import PylmcError, PylmcWarning
from ..picture.estimators import Estimator, picture
from ..scene import Scene
from ..settings import Settings, explained
from . import start, views
from .chains import STEPS_PER_LAUNCH, Info, State, refine, step
from .compiled import compile_scene
from .films import film_for, places
from .groups import Group
from .limits import limits
from .states import Counters, States, Trial

CHAINS, CANDIDATES = 4096, 1 << 18  # of a start that is told neither


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
        begin = time.perf_counter()
        self.compiled = compile_scene(scene, precision)
        for sentence in limits(scene, self.compiled, precision):
            warnings.warn(sentence, PylmcWarning, stacklevel=2)
        self.device_scene = DeviceScene(self.compiled, self.settings, device, precision)
        self.seconds = {"build": time.perf_counter() - begin, "bootstrap": 0.0}
        self.groups: list[Group] = []
        self.dark_groups: list[Group] = []  # those in which the start found no light
        self._state: State | None = None
        self._film: Film | None = None
        self._counted: Info | None = None  # since counters() was last called
        self._untold_not_finite = 0  # of the start's candidates, until counters() has told

    @property
    def film_pixels(self) -> int:
        """Pixels of the film."""
        return self.scene.camera.width * self.scene.camera.height

    @property
    def compile_seconds(self) -> float:
        """Time spent compiling kernels so far."""
        return self.device_scene.compile_seconds

    @property
    def state(self) -> State:
        """The chains as they are. ``step`` consumes it. Raises PylmcError before ``init``."""
        if self._state is None:
            raise PylmcError("the chains have not been started: call Sampler.init(seed) first")
        return self._state

    @property
    def film(self) -> Film:
        """What the chains have splatted, a slot a group while memory allows (see :mod:`pylmc.sampling.films`).

        Raises PylmcError before ``init``.
        """
        if self._film is None:
            raise PylmcError("the chains have not been started: call Sampler.init(seed) first")
        return self._film

    @property
    def chains(self) -> int:
        """How many there are."""
        return self.state.chains.count

    @property
    def seed(self) -> int:
        """That of the chains."""
        return self.state.seed

    @property
    def evenness(self) -> np.ndarray:
        """The density's weights over the film that the start has chosen (GRID, GRID): see pylmc.sampling.evenness."""
        return self.state.evenness.read()

    def path_groups(self) -> list[Group]:
        """A group for each path length and ending that the settings admit, nothing known of them yet."""
        return start.path_groups(self.device_scene)

    def weigh(self, candidates: int = 1 << 18, seed: int = 0) -> list[Group]:
        """Draw ``candidates`` independent paths per group and keep their weights I / p_ind: the estimate of each b.

        I is plain luminance here. Chains that run are left as they are. Raises PylmcError if no path carries light.
        """
        begin = time.perf_counter()
        groups = start.weigh(self.device_scene, candidates, seed)
        start.check_found(groups, candidates, self.settings.max_depth)
        self.seconds["bootstrap"] += time.perf_counter() - begin
        return groups

    def init(self, seed: int = 0, chains: int | None = None, candidates: int | None = None) -> list[Group]:
        """Start ``chains`` chains in their density: resample the candidates in proportion to their weights.

        ``chains`` and ``candidates`` are those of the settings if not given here. The chains
        are shared out among the groups in proportion to b; a group in which no light was found has independent paths drawn
        in their place, and is one of ``dark_groups``. The same seed gives the same chains. Returns the other groups.
        """
        seed = check_integer("seed", seed, 0, 2**32 - 1)
        if chains is None:
            chains = self.settings.chains or CHAINS
        chains = check_integer("chains", chains, 1, 1 << 24)
        if candidates is None:
            candidates = self.settings.candidates or CANDIDATES
        candidates = check_integer("candidates", candidates, 1, 1 << 30)
        begin = time.perf_counter()
        state = start.start(self.device_scene, seed, chains, candidates)
        self.seconds["bootstrap"] += time.perf_counter() - begin
        self.resume(state)
        with self.device_scene.compiling():
            self._state, _ = step(self.state, 0, self.film)
        return self.groups

    def resume(self, state: State) -> None:
        """Go on with ``state``, which belongs to this sampler's device scene, and an empty film."""
        camera = self.scene.camera
        self._state, self._counted, self._untold_not_finite = state, None, state.not_finite
        self.groups, self.dark_groups = ([copy(group) for group in some] for some in (state.groups, state.dark))
        self._film = film_for(self.device_scene, len(state.groups) + len(state.dark), camera.height, camera.width)

    def step(self, n: int = STEPS_PER_LAUNCH, **constants: Any) -> None:
        """Advance every chain by ``n`` steps and wait; large steps refine each group's b.

        ``constants``: as for :func:`pylmc.sampling.chains.step`.
        """
        n = check_integer("n", n, 0, 1 << 40)
        self._state, info = step(self.state, n, self.film, **constants)
        self._counted = info if self._counted is None else self._counted + info
        refine((*self.groups, *self.dark_groups), self.state, self.state.counted)

    def counters(self) -> Counters:
        """What the chains counted since the last call.

        Candidates of the start whose weight was not finite are counted with the first call's ``not_finite``.
        """
        if self._counted is None:
            self.step(0)
        assert self._counted is not None
        info, self._counted = self._counted, None
        not_finite = int(info.not_finite.sum()) + self._untold_not_finite
        self._untold_not_finite = 0
        proposed, acceptance, trace = (of_all[: self.chains] for of_all in (info.proposed, info.acceptance, info.trace))
        return Counters(proposed, acceptance, trace, not_finite, int(info.rays.sum()), self.device_scene.moves.columns())

    def estimators(self) -> list[Estimator]:
        """The picture's parts, one for each slot of the film."""
        scale = self.film_pixels * self.compiled.radiance_scale
        placed = places((*self.state.groups, *self.state.dark), self.film.slots)
        return placed.estimators(self.film, (*self.groups, *self.dark_groups), scale, self.state.steps)

    def image(self) -> np.ndarray:
        """The picture so far (height, width, 3), float64, in the scene's units of radiance."""
        return picture(self.estimators())

    def states(self, block: int = 0) -> States:
        """Every chain's path; ``block`` limits charts and factors to that many leading directions (0: all free ones)."""
        return views.states(self.state, block)

    def displaced(self, deltas: np.ndarray, block: int = 0) -> tuple[np.ndarray, np.ndarray]:
        """Where displacements (chains, 2 K) in the chains' charts lead: nodes (scaled units) and directions; NaN: nowhere."""
        return views.displaced(self.state, deltas, block)

    def trial(self, number: int | None = None) -> Trial:
        """What one step of each chain would do, the chains staying as they are.

        ``number`` names its random numbers: those of the chains' step of this number (the first is 0), or of the next one.
        """
        return views.trial(self.state, number if number is None else check_integer("number", number, 0, 1 << 40))
