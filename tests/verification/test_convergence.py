"""The observed order: a planted one is found, and what is no order is told."""

import math
from dataclasses import replace

import numpy as np
import pytest

from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.convergence import halves, observe, slope
from stickslip_verification.judge.checks import REFERENCE_CONTRACT
from stickslip_verification.judge.invariant_checks import judge_order
from stickslip_verification.model.verdict import CheckResult, ObservedOrder
from stickslip_verification.suite.invariants import Order, load_invariants

from .records import named

INVARIANT: Order = load_invariants().orders[0]

LEVELS = np.geomspace(1e-9, 1e-13, 17)


def observed(errors: np.ndarray[tuple[int], np.dtype[np.float64]]) -> ObservedOrder:
    """Return errors at the levels of the suite."""
    return ObservedOrder("default", "z", LEVELS.tolist(), errors.tolist(), (), 1.0)


def judged(seen: Answer[ObservedOrder]) -> dict[str, CheckResult]:
    """Return both results of the invariant by their ids."""
    return {r.check: r for r in judge_order(INVARIANT, "default", REFERENCE_CONTRACT, seen)}


@pytest.mark.parametrize("order", [0.5, 1.0, 4.0 / 3.0, 8.0])
def test_a_planted_order_is_found(order: float) -> None:
    """The slope through the errors of a pure power law is its exponent, in both halves."""
    errors = 3.0 * LEVELS**order
    assert slope(LEVELS.tolist(), errors.tolist()) == pytest.approx(order, rel=1e-12)
    assert halves(observed(errors)) == pytest.approx(0.0, abs=1e-12)


def test_the_levels_share_their_middle() -> None:
    """An order that changes at the middle level is the difference of both halves, to the digit."""
    middle = LEVELS[8]
    errors = np.where(middle < LEVELS, (LEVELS / middle) ** 2.0, (LEVELS / middle) ** 0.5)
    assert halves(observed(errors)) == pytest.approx(1.5, rel=1e-12)


def test_a_flat_half_is_seen() -> None:
    """Errors that stop falling where rounding begins, or begin where a step limit ends, show it."""
    floor = np.maximum(LEVELS, LEVELS[8])
    ceiling = np.minimum(LEVELS, LEVELS[8])
    assert halves(observed(floor)) == pytest.approx(1.0, rel=1e-12)
    assert halves(observed(ceiling)) == pytest.approx(-1.0, rel=1e-12)
    for errors in (floor, ceiling):
        assert not judged(Answer(observed(errors)))[f"{INVARIANT.id}-asymptotic"].passed


@pytest.mark.parametrize("bad", [0.0, math.nan, math.inf, -1e-12])
def test_errors_without_a_logarithm_have_no_order(bad: float) -> None:
    """A zero, negative or missing error gives no slope, and a failure with its reason."""
    errors = np.array(LEVELS)
    errors[3] = bad
    assert math.isnan(slope(LEVELS.tolist(), errors.tolist()))
    for result in judged(Answer(observed(errors))).values():
        assert (result.passed, result.got) == (False, None)
        assert result.failure == "an error is zero or no finite number"


def test_an_order_is_judged_by_its_invariant() -> None:
    """The promised order passes; one that is half of it, or twice, does not."""
    for order, passed in ((1.0, True), (0.9, True), (0.5, False), (2.0, False)):
        result = judged(Answer(observed(LEVELS**order)))[INVARIANT.id]
        assert result.got == pytest.approx(order, rel=1e-12)
        assert (result.passed, result.truth) == (passed, "convergence")


def test_an_order_that_could_not_be_observed_fails() -> None:
    """The reason why there is no order is the failure of both checks."""
    for result in judged(Answer(failure="the process crashed (SIGSEGV)")).values():
        assert (result.passed, result.failure) == (False, "the process crashed (SIGSEGV)")


def test_the_scatter_that_the_invariant_allows_for_passes() -> None:
    """Errors that scatter by a factor of two about the power law keep the invariant."""
    for seed in range(20):
        scatter = np.exp(np.log(2.0) * np.random.default_rng(seed).standard_normal(17) / 2.0)
        assert all(r.passed for r in judged(Answer(observed(LEVELS * scatter))).values())


def test_the_reference_converges() -> None:
    """A case of a few steps shows the reference's order, at fewer levels than the suite's."""
    invariant = replace(INVARIANT, levels=5, coarsest=1e-9, finest=1e-11, quantity="z")
    seen = observe(named("grazing"), invariant)
    assert (seen.case, seen.quantity, len(seen.errors)) == ("grazing", "z", 5)
    assert list(seen.tolerances) == pytest.approx(np.geomspace(1e-9, 1e-11, 5).tolist())
    pairs = zip(seen.errors, seen.errors[1:], seen.orders, strict=False)
    for coarse, fine, order in pairs:
        assert order == pytest.approx(math.log(coarse / fine) / math.log(10.0**0.5), rel=1e-9)
    # A scatter by a factor of two moves the slope through five half decades by 0.3.
    fitted = slope(list(seen.tolerances), list(seen.errors))
    assert fitted == pytest.approx(1.0, abs=0.3)
    # An error is a part of the largest extension: it is far below it, and above rounding.
    assert all(1e-16 < error < 1e-6 for error in seen.errors)
