"""What a failed comparison leaves behind: both pictures, their difference and the p-values, as files to look at."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np

from pylmc.picture.image import write_exr, write_png
from pylmc.picture.tonemap import exposure, tonemap

from .verdict import LEVELS, Verdict

FOLDER = Path(__file__).resolve().parents[3] / "out" / "comparison"
STRONGEST = 6.0  # standard errors at the ends of the colour scale


def diverging(t: np.ndarray) -> np.ndarray:
    """Differences in standard errors (height, width) as colours (uint8): blue too dark, white alike, red too bright."""
    x = np.clip(np.nan_to_num(t, posinf=STRONGEST, neginf=-STRONGEST) / STRONGEST, -1, 1)
    fade = 1 - np.abs(x)
    rgb = np.stack([np.where(x < 0, fade, 1), fade, np.where(x > 0, fade, 1)], axis=-1)
    return np.rint(255 * rgb).astype(np.uint8)


def strongest_channel(t: np.ndarray) -> np.ndarray:
    """Of each pixel's three t (height, width, 3) the one of largest size (height, width)."""
    return np.take_along_axis(t, np.abs(t).argmax(axis=2)[..., None], axis=2)[..., 0]


def leave_evidence(verdict: Verdict, folder: Path) -> list[Path]:
    """Write a verdict's pictures and numbers into ``folder``, which is made, and return the files.

    EXR (linear, exact): the tested mean, the expected one, their difference, t and p per pixel and channel. PNG: the first
    two exposed alike, and the strongest t of each pixel in a diverging scale of ``STRONGEST`` standard errors.
    """
    folder.mkdir(parents=True, exist_ok=True)
    images = {
        "tested": verdict.mean,
        "expected": verdict.expected,
        "difference": verdict.mean - verdict.expected,
        "standard_errors": verdict.t["pixels"],
        "p_values": verdict.p["pixels"],
    }
    for name, image in images.items():
        write_exr(folder / f"{name}.exr", image)
    exposed = exposure(verdict.expected)
    write_png(folder / "tested.png", tonemap(verdict.mean, exposed))
    write_png(folder / "expected.png", tonemap(verdict.expected, exposed))
    write_png(folder / "standard_errors.png", diverging(strongest_channel(verdict.t["pixels"])))
    (folder / "verdict.json").write_text(json.dumps(verdict.summary(), indent=2) + "\n", encoding="utf-8")
    return sorted(folder.iterdir())


def confirm(verdict: Verdict, name: str) -> None:
    """Fail unless the verdict passed, and then leave the evidence in out/comparison/<name>; else remove any older one."""
    folder = FOLDER / name
    shutil.rmtree(folder, ignore_errors=True)
    if not verdict.passed:
        leave_evidence(verdict, folder)
        worst = {level: f"{verdict.p[level].min():.2g} (threshold {verdict.threshold[level]:.2g})" for level in LEVELS}
        raise AssertionError(f"{name}: least p-values {worst}, ratio of means {verdict.ratio:.4f}; see {folder}")
