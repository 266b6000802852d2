"""The observed order of the reference: a planted one is found, and what is no order is said."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from stickslip_verification import CheckResult, load_invariants
from stickslip_verification.drive.exact import observe, slope
from stickslip_verification.drive.processes import Answer
from stickslip_verification.judge.checks import REFERENCE_CONTRACT, judge_order
from stickslip_verification.model.verdict import ObservedOrder

from .records import named

INVARIANT = load_invariants().orders[0]
LEVELS = np.geomspace(1e-9, 1e-13, 17)
PARTS = LEVELS / LEVELS[8]


def judged(errors: Sequence[float] | NDArray[np.float64]) -> list[CheckResult]:
    order = ObservedOrder("default", "z", LEVELS.tolist(), list(errors), (), 1.0)
    return list(judge_order(INVARIANT, "default", REFERENCE_CONTRACT, Answer(order)))


@pytest.mark.parametrize(
    ("errors", "order", "difference", "passed"),
    [
        *((3.0 * PARTS**n, n, 0.0, [n in (0.9, 1.0), True]) for n in (0.5, 0.9, 1.0, 2.0)),
        (np.where(PARTS > 1.0, PARTS**2.0, PARTS**0.5), None, 1.5, [False, False]),
        # Errors that stop falling where rounding begins, or begin where a step limit ends.
        (np.maximum(PARTS, 1.0), None, 1.0, [False, False]),
        (np.minimum(PARTS, 1.0), None, -1.0, [False, False]),
    ],
)
def test_the_order_is_the_exponent_and_its_range_is_asymptotic_where_both_halves_have_it(
    errors: NDArray[np.float64], order: float | None, difference: float, passed: list[bool]
) -> None:
    results = judged(errors)
    # Rounding of logarithms.
    assert order is None or results[0].got == pytest.approx(order, rel=1e-12)
    assert results[1].got == pytest.approx(difference, abs=1e-12)
    assert [result.passed for result in results] == passed


@pytest.mark.parametrize("bad", [0.0, math.nan, -1e-12])
def test_errors_without_a_logarithm_have_no_order(bad: float) -> None:
    for result in judged([bad, *LEVELS[1:]]):
        assert (result.passed, result.got) == (False, None)
        assert result.failure == "an error is zero or no finite number"


def test_the_reference_converges_with_its_tolerance() -> None:
    invariant = replace(INVARIANT, levels=5, coarsest=1e-9, finest=1e-11, quantity="z")
    seen = observe(named("grazing"), invariant)
    assert list(seen.tolerances) == pytest.approx(np.geomspace(1e-9, 1e-11, 5).tolist())
    for coarse, fine, order in zip(seen.errors, seen.errors[1:], seen.orders, strict=False):
        assert order == pytest.approx(2.0 * math.log10(coarse / fine), rel=1e-9)
    # A scatter by a factor of two moves the slope through five half decades by 0.3.
    assert slope(list(seen.tolerances), list(seen.errors)) == pytest.approx(1.0, abs=0.3)
    # Parts of the largest extension, above rounding.
    assert all(1e-16 < error < 1e-6 for error in seen.errors)
