"""How far one picture is from another: error figures and a picture of where."""

from __future__ import annotations

from pathlib import Path

import flip_evaluator
import numpy as np

from ..errors import PylmcError
from .image import read_exr, write_png
from .statistics import relative_square
from .tonemap import exposure, tonemap

TRIMMED = 1e-3  # the part of the pixels, by error, that relMSE_trimmed leaves out
GAP = 4  # pixels between the parts of the difference picture


def compare(path_a: str | Path, path_b: str | Path, picture: str | Path | None = None) -> dict[str, float]:
    """The `metrics` of picture A against the reference B, read from files; ``picture`` is a PNG to write.

    It shows A, B and FLIP's error map side by side, A and B exposed as B wants it. Raises PylmcError if a file cannot
    be read or written, if sizes differ, or if a pixel is NaN or infinite.
    """
    a, b = (read_exr(path)[0] for path in (path_a, path_b))
    if a.shape != b.shape:
        sizes = " and ".join(f"{path} is {x.shape[1]}x{x.shape[0]}" for path, x in ((path_a, a), (path_b, b)))
        raise PylmcError(f"sizes differ: {sizes}; render both with the same --size")
    for path, image in ((path_a, a), (path_b, b)):
        bad = int(np.count_nonzero(~np.isfinite(image).all(axis=2)))
        if bad:
            raise PylmcError(f"{path}: {bad} pixels are NaN or infinite and cannot be compared; render it again")
    result = metrics(a, b)
    if picture is not None:
        exposed = exposure(b)
        gap = np.full((a.shape[0], GAP, 3), 255, dtype=np.uint8)
        parts = [tonemap(a, exposed), gap, tonemap(b, exposed), gap, _magma(flip_map(a, b))]
        write_png(picture, np.hstack(parts))
    return result


def metrics(a: np.ndarray, b: np.ndarray) -> dict[str, float]:
    """Errors of ``a`` against the reference ``b``, both (height, width, 3), linear and finite.

    - relMSE: mean of (a - b)² / (b² + ε) with ε = 0.01 mean(b)², so that black pixels do not rule (a black reference
      makes it infinite);
      relMSE_trimmed is the same without the worst 0.1 % of the pixels, which a few fireflies would rule.
    - MSE, MAE: mean squared and mean absolute difference.
    - SMAPE: mean of \\|a - b\\| / (\\|a\\| + \\|b\\|), between 0 and 1; 0 where both are black.
    - FLIP: mean of FLIP's error for high dynamic range, between 0 and 1.

    Raises PylmcError if the shapes differ.
    """
    a, b = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    if a.shape != b.shape or a.ndim != 3 or a.shape[2] != 3:
        raise PylmcError(f"pictures of shapes {a.shape} and {b.shape}: both must be (height, width, 3)")
    # All but MSE and MAE are free of scale: dividing by the brightest value keeps squares of extreme ones in range.
    unit = max(float(np.abs(a).max()), float(np.abs(b).max())) or 1.0
    difference, scaled = np.abs(a - b) / unit, b / unit
    with np.errstate(over="ignore"):
        relative = relative_square(difference**2, scaled).mean(axis=2)
        kept = trimmed(relative)
        figures = {"relMSE": float(relative.mean()), "relMSE_trimmed": float(kept.mean()) if kept.size else 0.0}
    total = (np.abs(a) + np.abs(b)) / unit
    ratio = np.divide(difference, total, out=np.zeros_like(difference), where=total > 0)
    return {
        **figures,
        "MSE": float((difference**2).mean()) * unit**2,
        "MAE": float(difference.mean()) * unit,
        "SMAPE": float(ratio.mean()),
        "FLIP": float(flip_map(a, b).mean()),
    }


def trimmed(errors: np.ndarray) -> np.ndarray:
    """Pixels' errors in rising order, without the worst 0.1 % of them."""
    return np.sort(errors, axis=None)[: errors.size - int(np.ceil(TRIMMED * errors.size))]


def flip_map(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """FLIP's error (height, width) in [0, 1] of ``a`` against the reference ``b``, high dynamic range.

    Both are brought to `exposure` first. FLIP takes its own range of exposures from the reference; for a black one,
    from which it can take none, the range is about the exposure of ``a``.
    """
    black = not np.any(b > 0)
    scale, white = exposure(a if black else b)
    top = 1e4 * white  # beyond white at every exposure, and within single precision
    reference, test = (np.clip(x.astype(np.float64) * scale, 0, top).astype(np.float32) for x in (b, a))
    parameters = {"startExposure": -1.0, "stopExposure": 1.0, "numExposures": 3} if black else {}
    error = flip_evaluator.evaluate(reference, test, "HDR", applyMagma=False, parameters=parameters)[0]
    return np.nan_to_num(np.asarray(error, dtype=np.float64)).reshape(a.shape[:2])


def _magma(values: np.ndarray) -> np.ndarray:
    """Values in [0, 1] as colours (uint8): black, purple, orange, pale yellow, as FLIP's own maps."""
    stops = np.array([[0, 0, 4], [81, 18, 124], [183, 55, 121], [252, 137, 97], [252, 253, 191]], dtype=np.float64)
    place = np.linspace(0, 1, len(stops))
    return np.rint(np.stack([np.interp(values, place, stops[:, k]) for k in range(3)], axis=-1)).astype(np.uint8)
