"""The polynomials of cl_kernels/number/elementary.cl: minimax fits whose coefficients are floats.

    python -m bench.polynomials     prints each polynomial's coefficients, lowest first, and its greatest relative error

A fit minimises the greatest weighted error by Lawson's rule: least squares, weighted again and again by the errors left.
Coefficients are rounded to floats one after the other, lowest first, and the rest is fitted anew to what they leave.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

ROUNDS = 400
POINTS = 1001


@dataclass(frozen=True)
class Polynomial:
    """``values`` at ``x`` are to be fitted with this degree; ``weight`` makes an error of them one of the function."""

    name: str
    x: np.ndarray
    values: np.ndarray
    weight: np.ndarray
    degree: int


def minimax(x: np.ndarray, values: np.ndarray, powers: list[int], weight: np.ndarray) -> np.ndarray:
    """The coefficients of ``powers`` of ``x`` whose greatest weighted error is least."""
    columns = x[:, None] ** np.array(powers) * weight[:, None]
    scale = np.abs(columns).max(axis=0)
    columns = columns / scale
    shares = np.full(len(x), 1 / len(x))
    least, best = np.inf, np.zeros(len(powers))
    for _ in range(ROUNDS):
        root = np.sqrt(shares)
        found = np.linalg.lstsq(columns * root[:, None], values * weight * root, rcond=None)[0]
        error = np.abs(columns @ found - values * weight)
        if error.max() < least:
            least, best = error.max(), found / scale
        shares *= error + 1e-3 * error.max()
        shares /= shares.sum()
    return best


def fitted(polynomial: Polynomial) -> tuple[list[np.float32], float]:
    """(coefficients, greatest weighted error)."""
    left, found = polynomial.values, []
    for power in range(polynomial.degree + 1):
        powers = list(range(power, polynomial.degree + 1))
        found.append(np.float32(minimax(polynomial.x, left, powers, polynomial.weight)[0]))
        left = left - float(found[-1]) * polynomial.x**power
    return found, float(np.abs(left * polynomial.weight).max())


def polynomials() -> list[Polynomial]:
    """Those of elementary.cl. Near zero the differences below cancel, and the fit needs no points."""
    s = np.linspace(1e-3, 0.1716, POINTS)  # f / (2 + f), for f up to sqrt(2) - 1
    r = np.cos(np.linspace(0, np.pi, POINTS)) * np.log(2) / 2
    r = r[np.abs(r) > 1e-3]
    t = np.linspace(1e-3, np.pi / 4, POINTS)
    return [
        Polynomial("log: R(s^2) / s^2", s**2, (2 * np.arctanh(s) - 2 * s) / s**3, s**2, 2),
        Polynomial("exp: P(r)", r, (np.expm1(r) - r) / r**2, r**2, 4),
        Polynomial("sin: (sin r - r) / r^3 in r^2", t**2, (np.sin(t) - t) / t**3, t**3 / np.sin(t), 2),
        Polynomial("cos: (cos r - 1 + r^2 / 2) / r^4 in r^2", t**2, (np.cos(t) - 1 + t**2 / 2) / t**4, t**4 / np.cos(t), 2),
    ]


def main() -> None:
    for polynomial in polynomials():
        coefficients, error = fitted(polynomial)
        numbers = ", ".join(f"{coefficient:.8e}" for coefficient in coefficients)
        print(f"{polynomial.name}: {numbers}; error 2^{np.log2(error):.1f}")


if __name__ == "__main__":
    main()
