"""All that an answer depends on is among the inputs of its studies, and counted as it is said."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from stickslip_design.chunks import Results, Study, run
from stickslip_design.datasets import digest_of
from stickslip_design.points.axes import EVEN, STICKS, SWINGS, UNKNOWN
from stickslip_design.tolerances.indices import Mixed
from stickslip_design.tolerances.nominal import Turns
from stickslip_design.tolerances.probability import ranks
from stickslip_design.tolerances.question import question
from stickslip_design.tolerances.result import outcome
from stickslip_design.tolerances.samples import Population, Samples
from stickslip_design.tolerances.study import answer

from .series import gap, series

VARY = {"friction.mu_s": "normal 0.2 0.02", "friction.mu_k": "normal 0.15 0.015"}
PAIR = ("friction.mu_s", "friction.mu_k")


def population(zeta: str = "0.05", **arguments: Any) -> Population:
    """Return the machines of a series."""
    asked = {"vary": VARY, "correlation": {PAIR: 0.5}, "seed": 1, **arguments}
    return question(series(zeta=zeta), **asked).population


OTHERS: dict[str, Callable[[], Population]] = {
    "axis": lambda: population(zeta="0.06"),
    "mean": lambda: population(vary={**VARY, "friction.mu_s": "normal 0.21 0.02"}),
    "deviation": lambda: population(vary={**VARY, "friction.mu_s": "normal 0.2 0.03"}),
    "kind": lambda: population(vary={**VARY, "friction.mu_s": "uniform 0.2..0.21"}),
    "correlation": lambda: population(correlation={PAIR: 0.6}),
    "seed": lambda: population(seed=2),
    "order": lambda: replace(population(), varied=dict([*population().varied.items()][::-1])),
}


@pytest.mark.parametrize("other", OTHERS)
def test_machines_have_their_inputs_in_every_study(other: str) -> None:
    """Another file, distribution, correlation or seed is another study."""
    studies: list[Callable[[Population], Study]] = [
        lambda machines: Samples(machines, (1e-3,), 100),
        lambda machines: Mixed(machines, (1e-3,), 64),
        lambda machines: Turns(machines, 1e-3, 100, "friction.mu_s", 0.1, 10.0),
    ]
    for study in studies:
        key = digest_of(study(population()).identity)
        assert key == digest_of(study(population()).identity)
        assert key != digest_of(study(OTHERS[other]()).identity)


def test_what_is_asked_of_machines_is_among_the_inputs() -> None:
    """Feeds, how many, the number that is scaled and its factors."""
    machines = population()
    samples = Samples(machines, (1e-3,), 100)
    turns = Turns(machines, 1e-3, 100, "friction.mu_s", 0.1, 10.0)
    mixed = Mixed(machines, (1e-3,), 64)
    others: list[tuple[Study, Study]] = [
        (samples, replace(samples, feeds=(2e-3,))),
        (samples, replace(samples, count=101)),
        (samples, replace(samples, scaled="friction.mu_s")),
        (replace(samples, scaled="axis.mass"), replace(samples, scaled="axis.mass", by=2.0)),
        (samples, replace(samples, regimes_only=True)),
        (mixed, replace(mixed, feeds=(2e-3,))),
        (mixed, replace(mixed, rows=128)),
        (turns, replace(turns, feed=2e-3)),
        (turns, replace(turns, count=101)),
        (turns, replace(turns, path="axis.mass")),
        (turns, replace(turns, low=0.2)),
        (turns, replace(turns, high=5.0)),
    ]
    for one, other in others:
        assert one.identity != other.identity, other


def test_only_what_sticks_jumps() -> None:
    """A machine that swings, or that could not be computed, is none that jumps by a way."""
    regime = np.array([STICKS, SWINGS, EVEN, UNKNOWN, STICKS], dtype=np.int8)
    jump = np.array([2e-6, 0.0, 0.0, math.nan, math.nan])
    found = outcome(1e-3, regime, jump)
    assert found.jumps.value == 0.4
    assert found.even.value == 0.2
    assert (found.swings, found.unknown, found.unmeasured) == (1, 1, 1)
    assert found.jump == (2e-6, 2e-6, 2e-6)


@pytest.mark.parametrize(
    ("count", "share", "place"),
    [(5, 0.5, 3), (100, 0.99, 99), (10, 0.95, 10), (1000, 0.001, 1), (3, 0.01, 1), (50, 0.9, 45)],
)
def test_a_quantile_is_the_first_value_that_enough_do_not_exceed(
    count: int, share: float, place: int
) -> None:
    """The least number of values that are the share or more: 9 of 10 are 90 %, 3 of 5 half."""
    assert ranks(count, share)[1] == place


@pytest.mark.parametrize("share", [0.5, 0.9, 0.97])
def test_the_value_that_is_solved_for_keeps_what_must_hold(share: float) -> None:
    """Counted anew there, not one machine less runs evenly, of a sample that is small."""

    def here(study: Study, name: str) -> Results:
        return run(study, workers=1)

    asked = question(
        series(), vary={"friction.mu_s": "normal 0.2 0.02"}, samples=100, indices=0,
        hold=(share, 0.03 / gap(1.0)), solve="friction.mu_s",
    )  # fmt: skip
    found = answer(asked, here).solved
    assert found is not None
    assert found.checked.value == pytest.approx(share, abs=1e-12)
    assert not found.low > found.value
    assert not found.high < found.value
