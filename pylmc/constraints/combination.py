"""How constraints combine into the preconditioner (paper, section 4; theory.md, 5), in float64 NumPy.

The reference that the kernels, which never form Q, are tested against.
"""

from __future__ import annotations

import numpy as np

from ..errors import PylmcError


def combine(rows: np.ndarray, owners: np.ndarray, rule: str = "sum") -> np.ndarray:
    """Q of eq. (21), batched: w(M) times the sum of the constraints' row wᵀ row.

    ``rows`` (..., rows, n) are the constraints' differentials, already divided by their widths q (zero rows are
    absent constraints); ``owners`` (..., rows) names the constraint of each row, so that M counts constraints and not
    rows. Returns (..., n, n) float64.
    """
    rows = np.asarray(rows, dtype=np.float64)
    q = np.einsum("...ri,...rj->...ij", rows, rows)
    if rule == "sum":
        return q
    present = np.any(rows != 0, axis=-1)
    flat_present, flat_owners = present.reshape(-1, present.shape[-1]), np.broadcast_to(owners, present.shape)
    flat_owners = flat_owners.reshape(flat_present.shape)
    m = np.array([len(np.unique(o[p])) for o, p in zip(flat_owners, flat_present, strict=True)], dtype=np.float64)
    m = np.maximum(m, 1).reshape(present.shape[:-1])
    if rule == "mean":
        return q / m[..., None, None]
    if rule == "rms":
        return q / np.sqrt(m)[..., None, None]
    raise PylmcError(f"rule={rule!r} is unknown; choose from sum, mean, rms")


def proposal_factor(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(T, log |det T|) with T Tᵀ = Q⁻¹, from Q = L Lᵀ as T = L⁻ᵀ; batched over leading axes, float64."""
    factor = np.linalg.cholesky(np.asarray(q, dtype=np.float64))
    diagonal = np.diagonal(factor, axis1=-2, axis2=-1)
    return np.swapaxes(np.linalg.inv(factor), -1, -2), -np.log(diagonal).sum(axis=-1)
