"""Rendering: run an integrator for a time or an amount of work, and keep the picture whatever happens."""

from __future__ import annotations

import json
import platform
import time
import warnings
from contextlib import closing
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np
import pyopencl

from .colour import LUMINANCE
from .errors import PylmcError, PylmcWarning
from .integrators import made
from .integrators.integrator import Integrator
from .interruption import Asked, gently
from .options import check_names
from .picture.statistics import relative_error
from .progress import Progress
from .sampling.sampler import Sampler
from .scene import Scene
from .settings import DEFAULT_SECONDS, Run, Settings, explained

LOOKS = 16  # at the picture's error, while the progress bar goes on
QUICK_SECONDS, QUICK_MUTATIONS = 10, 1 << 23  # shorter renders spend less on the start


@dataclass(frozen=True, eq=False)
class Render:
    """A finished picture: ``image`` (height, width, 3) float32 linear RGB radiance, row 0 at the top, and ``diagnostics``.

    ``variance`` is the estimated variance of the luminance per pixel (height, width), or None for very short renders.
    """

    image: np.ndarray
    diagnostics: dict[str, Any] = field(repr=False)
    variance: np.ndarray | None = field(default=None, repr=False)

    def save(self, path: str | Path) -> list[Path]:
        """Write ``path`` (OpenEXR, with metadata), and beside it a tone-mapped .png and the diagnostics as .json.

        All three appear whole or not at all. Returns their paths. Raises PylmcError if they cannot be written.
        """
        from .picture.image import write_exr, write_png
        from .picture.replacement import Replacement

        target = Path(path)
        if target.suffix.lower() != ".exr":
            raise PylmcError(f"{target}: pictures are saved as OpenEXR; give a name that ends in .exr")
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise PylmcError(f"{target.parent}: cannot make this folder: {error.strerror}") from None
        d = self.diagnostics
        metadata = {
            "seed": d["seed"],
            "configuration": json.dumps(d["configuration"]),
            "device": d["device"],
            "normalisation": d.get("b", "none"),
            "versions": json.dumps(d["versions"]),
        }
        text = json.dumps(d, indent=2, allow_nan=False) + "\n"
        with Replacement() as files:  # all three or none: a full disk must not cost an earlier picture
            write_exr(target, self.image, metadata, files)
            write_png(target.with_suffix(".png"), self.image, files)
            try:
                files.path_for(target.with_suffix(".json")).write_text(text, encoding="utf-8")
            except OSError as error:
                raise PylmcError(f"{target.with_suffix('.json')}: cannot be written: {error.strerror}") from None
        return [target, target.with_suffix(".png"), target.with_suffix(".json")]


@explained(Run, Settings)
def render(
    scene: Scene,
    *,
    seconds: float | None = None,
    mutations_per_pixel: float | None = None,
    seed: int = 0,
    device: Any = None,
    precision: str = "single",
    integrator: str = "lmc",
    progress: bool = True,
    **settings: Any,
) -> Render:
    """Render ``scene`` for ``seconds`` of run time, or ``mutations_per_pixel`` (samples, for bdpt and path).

    ``progress`` shows on stderr how far it is. Ctrl-C ends early with the picture so far and ``diagnostics["interrupted"]``
    set. ``device`` may also be a ``pyopencl.Device``. Raises PylmcError for bad arguments, an unusable device, or a scene
    without light.
    """
    check_names(settings, (*(item.name for item in fields(Run)), "progress", *Settings.names()))
    run = Run(seconds, mutations_per_pixel, seed, device, precision, integrator)
    seconds, seed = run.seconds, run.seed
    if seconds is None and mutations_per_pixel is None:
        seconds = DEFAULT_SECONDS
    sampler = Sampler(scene, device=device, precision=precision, **settings)
    worker = made(integrator, sampler)
    with gently() as asked:
        work = None if mutations_per_pixel is None else mutations_per_pixel * sampler.film_pixels
        quick = seconds < QUICK_SECONDS if seconds is not None else (work or 0) < QUICK_MUTATIONS
        worker.prepare(seed, quick)
        _run(worker, seconds, work, progress, asked)
    image = worker.image()
    if worker.done and not np.any(image):
        warnings.warn(
            f"the picture is black, though the scene has light paths: integrator '{integrator}' met none of them; "
            "give it more time, or use integrator 'lmc'",
            PylmcWarning,
            stacklevel=2,
        )
    variance = worker.variance()
    spent = worker.run_seconds
    diagnostics = {
        "scene_shapes": len(scene.shapes),
        "size": [scene.camera.width, scene.camera.height],
        "integrator": integrator,
        "seed": seed,
        "device": sampler.device_scene.device.name.strip(),
        "configuration": asdict(sampler.settings) | {"integrator": integrator, "precision": precision},
        "versions": _versions(),
        "interrupted": asked.is_set(),
        worker.unit: worker.done,
        f"{worker.unit}_per_second": worker.done / spent if spent else 0.0,
        **worker.diagnostics(),
        "mean_luminance": float((image @ LUMINANCE).mean()),
        "mean_luminance_error": worker.mean_error() if np.any(image) else None,  # of a black picture nothing is known
        "relative_error": relative_error(image, variance),
        "seconds": {
            "build": sampler.seconds["build"],
            "compile": sampler.compile_seconds,
            "bootstrap": sampler.seconds["bootstrap"],
            "run": spent,
        },
    }
    diagnostics["rays_per_second"] = diagnostics["rays"] / spent if spent else 0.0
    if diagnostics.get("ess"):
        diagnostics["ess_per_second"] = diagnostics["ess"] / spent
    _warn_of_range(image)
    single = np.nan_to_num(np.clip(image, 0, np.finfo(np.float32).max)).astype(np.float32)
    return Render(single, diagnostics, variance)


def _warn_of_range(image: np.ndarray) -> None:
    """A picture is float32: say so where its radiance is beyond that, above or below."""
    kind, brightest = np.finfo(np.float32), float(np.max(image, initial=0.0))
    if brightest > kind.max:
        warnings.warn(
            f"radiance up to {brightest:.3g} is more than a picture holds ({kind.max:.3g}) and is cut off there: "
            "give the lights less power",
            PylmcWarning,
            stacklevel=3,
        )
    elif 0 < brightest < 1000 * kind.tiny:  # a picture's dark parts are a thousandth of its bright ones
        warnings.warn(
            f"radiance of at most {brightest:.3g} is too dim for a picture, whose numbers end at {kind.tiny:.3g}: "
            "give the lights more power",
            PylmcWarning,
            stacklevel=3,
        )


def _run(worker: Integrator, seconds: float | None, work: float | None, shown: bool, asked: Asked) -> None:
    """Advance until the budget is spent or somebody asks to stop."""
    start, goal = time.perf_counter(), float(seconds if seconds is not None else work or 0)
    with closing(Progress(goal, shown)) as progress:
        look, error = 1, None
        spent = 0.0
        while spent < goal and not asked.is_set():
            worker.advance()
            elapsed = time.perf_counter() - start
            spent = elapsed if seconds is not None else float(worker.done)
            if shown and spent >= goal * look / LOOKS:
                look = int(spent / goal * LOOKS) + 1
                error = relative_error(worker.image(), worker.variance())
            note = {worker.unit + "/s": f"{worker.done / elapsed:.3g}", **worker.note()}
            if error is not None:
                note["error"] = f"{100 * error:.1f}%"
            progress.show(spent, note)


def _versions() -> dict[str, str]:
    from . import __version__

    return {
        "pylmc": __version__,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "pyopencl": pyopencl.VERSION_TEXT,
    }
