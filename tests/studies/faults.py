"""Faults of the small step, made by editing cl_kernels/moves/small.cl as it is built.

Each breaks one thing that Hastings' rule needs, so that the tests of invariance can be seen to fail.
"""

from __future__ import annotations

FORWARD = "real forward = factor_log_determinant(&small->factor)"
REVERSE = "real reverse = factor_log_determinant(&small->factor)"
SECOND_FACTOR = "precondition(scene, y, m, small->p_new, charts_new, &small->factor, &small->gradient);"
BACK = "factor_apply_transposed(&small->factor, small->delta, small->shift);"

FAULTS = {
    # log |det T| left out, both of X and of X^
    "no determinant": {FORWARD: "real forward = 0.0", REVERSE: "real reverse = 0.0"},
    # the reverse step's delta X taken from X to X^; shows with drift only, the Gaussian being even
    "reverse sign": {BACK: f"{BACK} for (int k = 0; k < n; k++) small->shift[k] = -small->shift[k];"},
    # the reverse step by T(X) and a(X) in place of T(X^) and a(X^)
    "factor of X": {SECOND_FACTOR: ""},
}
