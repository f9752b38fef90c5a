"""The Markov kernel leaves its target invariant, however chains move; and the test can fail.

Alpha is 1e-4 for a configuration, Šidák-corrected over its few hundred tests, so about 0.3 % for all that `make test` runs.
A negative control has power if its smallest p-value is below 1e-9, where a sound kernel's exceeds some 3e-7.
"""

from __future__ import annotations

import pytest
from studies.invariance_cases import ALPHA, CASES, CONTROLS, FACTORS, FAULTY, FULL, PAIRWISE, Case, Control, pairs

from pylmc.device.survey import select


def name(case: Case | Control) -> str:
    return f"{case.scene}, {case.name}" if isinstance(case, Case) else case.name


@pytest.mark.parametrize("case", CASES, ids=name)
def test_target_is_kept(case: Case) -> None:
    if case.precision == "double" and "cl_khr_fp64" not in select().extensions:
        pytest.skip("the device has no 64-bit floats")
    outcome = case.run()
    assert outcome.tests >= 100
    assert outcome.acceptance > 0.02, "the chains hardly move"
    assert outcome.not_finite == 0
    assert outcome.corrected > ALPHA, f"{outcome.worst}: p = {outcome.smallest:.2g} of {outcome.tests} tests"


@pytest.mark.parametrize("control", CONTROLS, ids=name)
def test_fault_is_seen(control: Control) -> None:
    """Negative controls; their twins without the fault are among the configurations above."""
    assert control.run().smallest < FAULTY


@pytest.mark.long
@pytest.mark.parametrize("case", FULL, ids=name)
def test_target_is_kept_on_the_full_grid(case: Case) -> None:
    test_target_is_kept(case)


def test_every_two_choices_occur_together() -> None:
    seen = set().union(*(pairs({"scene": case.scene, **case.settings}) for case in PAIRWISE))
    names = list(FACTORS)
    for i, first in enumerate(names):
        for second in names[i + 1 :]:
            assert {((first, a), (second, b)) for a in FACTORS[first] for b in FACTORS[second]} <= seen
