"""The density's weight over the film: as many samples for dark parts of the picture as for bright ones.

A chain whose density is luminance visits a pixel in proportion to its brightness, so that shadows stay noisy for long after
the highlights are clean. Dividing the density by a rough picture, made of other paths than the start's, evens that out; the
splats are multiplied by it again, so the picture is the same (Veach 1997, 11.3.3: two-stage MLT).
"""

from __future__ import annotations

import numpy as np
from scipy import ndimage

GRID = 64  # cells per side of the film
FLOOR = 0.1  # of the mean luminance: darker parts get no further weight; the relMSE of pylmc.picture.metrics has the same floor
CLIP = 1e-3  # share of the greatest candidates in a cell's mean that counts for no more than the next one
MEDIAN = 3  # cells: takes out noise without bleeding a bright spot into its surroundings, as a blur would


def even_weights(positions: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Weights (GRID, GRID) float32 for the kernels, from candidates' film positions (n, 2) and weights I / p_ind (n,).

    Positions are in [0, 1) to the right and down. A handful of heavy candidates must not look like a bright cell: weights
    are clipped at a high quantile first. All ones where nothing was found.
    """
    found = weights > 0
    if found.sum() < 10 * GRID:
        return np.ones((GRID, GRID), np.float32)
    positions, weights = positions[found], weights[found]
    weights = np.minimum(weights, np.quantile(weights, 1 - CLIP))
    cells = np.minimum((positions * GRID).astype(int), GRID - 1)
    rough = np.bincount(cells[:, 1] * GRID + cells[:, 0], weights=weights, minlength=GRID * GRID).reshape(GRID, GRID)
    rough = ndimage.median_filter(rough / rough.mean(), MEDIAN, mode="nearest")
    even = 1 / (rough + FLOOR)
    return (even / even.mean()).astype(np.float32)
