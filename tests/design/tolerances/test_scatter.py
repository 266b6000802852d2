"""How likely an axis jumps, against series whose probability is known in closed form."""

import math
import pickle
from dataclasses import replace
from typing import Any

import pytest
from numpy.testing import assert_array_equal
from scipy.special import ndtri

from stickslip_design.axis import AxisFile
from stickslip_design.chunks import Study, run
from stickslip_design.datasets import digest_of
from stickslip_design.tolerances.machines import Population, Samples
from stickslip_design.tolerances.statistics import Mixed, Turns
from stickslip_design.tolerances.study import Scatter, answer, question
from tests.design.tolerances.series import MU_K, gap, series, share_that_jumps

MU_S = {"friction.mu_s": "normal 0.2 0.02"}
BOTH = {**MU_S, "friction.mu_k": "normal 0.15 0.015"}
PAIR = ("friction.mu_s", "friction.mu_k")
THREE = {**BOTH, "axis.mass": "normal 500 20 kg"}
EXCLUDING = {PAIR: 0.9, (PAIR[1], "axis.mass"): 0.9, (PAIR[0], "axis.mass"): -0.9}


def asked(file: AxisFile | None = None, **arguments: Any) -> Scatter:
    asked_for = question(file or series(), **{"vary": MU_S, "indices": 0, **arguments})
    return answer(asked_for, lambda study, _: run(study, workers=1))


def four_errors(share: float, count: float) -> float:
    return 4.0 * math.sqrt(share * (1.0 - share) / count)


@pytest.mark.parametrize("rho", [-0.5, 0.0, 0.8])
def test_correlation_changes_the_probability_as_the_closed_case_does(rho: float) -> None:
    feed = 0.03 / gap(1.0)
    found = asked(vary=BOTH, feeds=[feed], correlation={PAIR: rho})
    truth = share_that_jumps(feed, (0.2, 0.02), (0.15, 0.015), rho)
    jumps = found.outcomes[0].jumps
    assert jumps.value == pytest.approx(truth, abs=four_errors(truth, 1e5))
    assert jumps.low < jumps.value < jumps.high
    assert jumps.value + found.outcomes[0].even.value == pytest.approx(1.0, abs=1e-15)


@pytest.mark.parametrize("sigma", [0.005, 0.02])
def test_the_nominal_value_that_holds_a_share_is_that_of_the_closed_case(sigma: float) -> None:
    feed = 0.03 / gap(1.0)
    found = asked(
        vary={"friction.mu_s": f"normal 0.2 {sigma}"}, samples=50_000, hold=(0.99, feed),
        solve="friction.mu_s",
    ).solved  # fmt: skip
    assert found is not None
    # 99 % run evenly where mu - mu_k - gap is -2.33 sigma, and sigma grows and shrinks with mu.
    truth = (MU_K + 0.03) / (1.0 + sigma / 0.2 * float(ndtri(0.99)))
    assert found.at_most
    assert found.low < truth < found.high
    # Half the width of the interval: the sampling error of the quantile.
    assert found.high - found.low < 0.01 * truth
    # Counted anew at the even side of each turn.
    assert found.checked.low < 0.99 <= found.checked.value < found.checked.high


def test_a_number_that_does_not_vary_is_solved_for_upwards() -> None:
    # More damping makes more machines even.
    feed = 0.06 / gap(1.0)
    found = asked(
        samples=5000, hold=f"90 % at {1e3 * feed} mm/s", solve="axis.zeta", within="0.02..0.5"
    ).solved
    assert found is not None
    assert not found.at_most
    assert (found.now, *found.within) == pytest.approx((0.05, 0.02, 0.5))
    again = asked(series(zeta=str(found.value)), samples=5000, feeds=[feed])
    # The same machines: only the last place of the factor can differ.
    assert again.outcomes[0].even.value == pytest.approx(0.9, abs=2.0 / 5000)


def test_studies_are_the_same_to_the_bit_in_any_chunks_and_from_any_process() -> None:
    population = question(series(), vary=BOTH, correlation={PAIR: 0.5}).population
    studies: list[Study] = [
        Samples(population, (1e-3, 4e-3), 10_000),
        Mixed(population, (1e-3,), 2048),
        Turns(population, 1e-3, 2000, "friction.mu_s", 0.5, 2.0),
    ]
    for study in studies:
        expected = study.compute(0, study.count)
        sent = pickle.loads(pickle.dumps(study))
        for start in range(0, study.count, study.quantum):
            part = sent.compute(start, min(start + study.quantum, study.count))
            for name, column in part.items():
                assert_array_equal(column, expected[name][start : start + study.quantum], name)


def population(zeta: str = "0.05", **arguments: Any) -> Population:
    defaults = {"vary": BOTH, "correlation": {PAIR: 0.5}, "seed": 1}
    return question(series(zeta=zeta), **{**defaults, **arguments}).population


def test_all_that_results_depend_on_is_an_input() -> None:
    machines = population()
    samples = Samples(machines, (1e-3,), 100)
    turns = Turns(machines, 1e-3, 100, "friction.mu_s", 0.1, 10.0)
    populations: list[dict[str, Any]] = [
        {"zeta": "0.06"}, {"vary": {**BOTH, PAIR[0]: "normal 0.21 0.02"}},
        {"correlation": {PAIR: 0.6}}, {"seed": 2},
    ]  # fmt: skip
    others: list[Study] = [
        samples, *(replace(samples, population=population(**each)) for each in populations),
        replace(samples, feeds=(2e-3,)), replace(samples, count=101),
        replace(samples, regimes_only=True), Mixed(machines, (1e-3,), 64),
        turns, replace(turns, path="axis.mass"), replace(turns, low=0.2),
    ]  # fmt: skip
    assert Samples(population(), (1e-3,), 100).identity == samples.identity
    assert len({digest_of(study.identity) for study in others}) == len(others)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"feeds": ["2"]}, "feed 2 has no unit; expected a velocity in m/s above 0"),
        ({"samples": 0}, "0 samples: at least 1 is needed"),
        ({"indices": 100}, "100 rows for Sobol indices: a power of two"),
        ({"seed": -1}, "the seed -1 is out of range"),
        ({"hold": "99 % at 2 mm/s"}, "given together"),
        ({"within": (0.1, 0.2)}, "goes with a number to solve for"),
        ({"hold": "99 %", "solve": "friction.mu_s"}, '"99 %" does not say what must hold'),
        ({"correlation": {("friction.mu_s", "axis.mass"): 0.5}}, "axis.mass does not vary"),
        ({"vary": BOTH, "correlation": {PAIR: 1.01}}, "is 1.01; it must be -1 to 1"),
        ({"vary": THREE, "correlation": EXCLUDING}, "exclude each other"),
        ({"hold": (0.9, 1e-3), "solve": "axis.gravity"}, "is no number that the file states"),
        ({"hold": (0.9, 1e-3), "solve": "axis.mass", "within": "600..500 kg"}, "reversed"),
    ],
)
def test_a_question_that_cannot_be_asked_is_refused_before_anything_is_computed(
    arguments: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        question(series(), **{"vary": MU_S, **arguments})
