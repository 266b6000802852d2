"""The rules that give the tolerances of a case from its values and its exact motion."""

from collections.abc import Mapping

import pytest

from stickslip_verification.suite.tolerances import Facts, Rules, rounded_up
from stickslip_verification.truth import STRIBECK
from stickslip_verification.truth.parameters import complete

SLIPS = Facts(slips=3)


def rules(*changed: Mapping[str, float], facts: Facts = SLIPS, **start: float) -> Rules:
    values = [complete(start)]
    for change in changed:
        values.append({**values[-1], **change})
    return Rules(tuple(values), facts)


def test_a_tolerance_is_rounded_up_to_two_digits() -> None:
    # What is beyond nine digits comes from the factors, such as 0.5/(0.5 - 0.49).
    up = {0.0: 0.0, 2.51e-9: 2.6e-9, 9.91e-9: 1e-8, 1e-6 + 1e-18: 1e-6, 1e-6 - 1e-18: 1e-6}
    assert {value: rounded_up(value) for value in up} == up


POINTS = {"shape": 3.0, "n_points": 3.0, "mu_1": 0.5, "mu_2": 0.25, "mu_3": 0.4, "mu_4": 0.1}
CURVE = complete({"mu_k": 0.499, **POINTS}, STRIBECK.parameters)


@pytest.mark.parametrize(
    ("rule", "conditioning"),
    [
        (rules(), 2.5),
        (rules({"mu_k": 0.4}, {"mu_k": 0.3}), 5.0),
        # The clamp leaves a gap of 0.01.
        (rules(mu_k=0.6), 50.0),
        (rules(mu_k=0.5), 1.0),
        # A curve has no mu_k: its gap is that to its least point.
        (Rules((CURVE,), SLIPS, law=STRIBECK), 2.0),
    ],
)
def test_the_narrowest_gap_of_the_whole_run_conditions(rule: Rules, conditioning: float) -> None:
    # The difference of two coefficients loses digits.
    assert rule.conditioning == pytest.approx(conditioning, rel=1e-12)


@pytest.mark.parametrize(
    ("rule", "quantity", "fmu", "reference"),
    [
        # The reference pays for each slip, at least for one.
        (rules(facts=Facts(0)), "z", 2.5e-12, 2.5e-9),
        (rules(facts=Facts(4)), "z", 2.5e-12, 1e-8),
        (rules(mu_k=0.5), "x", 1e-12, 3e-9),
        # A change and a reversal are restarts; a narrow gap amplifies more.
        (rules({"v": 0.0}), "x", 1e-10, 7.5e-9),
        (rules(facts=Facts(3, reversals=1)), "x", 1e-10, 7.5e-9),
        (rules({"v": 0.0}, mu_k=0.4995), "x", 1e-9, 3e-6),
        # What is not integrated has nothing to lose.
        *((rules({"v": 0.0}), name, 0.0, 0.0) for name in ("mode", "sticking", "n_slips", "W_k")),
        *((rules({"v": 0.0}), name, 1e-15, 1e-15) for name in ("F_s", "mu_k_used")),
        # A relief of nothing is held against the extension, 5.5 mm.
        (rules(mu_k=0.5), "spring_drop", 5.6e-15, 5.6e-12),
        (rules(facts=Facts(0, zero=frozenset({"T"}))), "T", 0.0, 0.0),
        (rules({"k": 900.0}), "W_k", 1e-10, 7.5e-9),
    ],
)
def test_what_a_course_may_lose(rule: Rules, quantity: str, fmu: float, reference: float) -> None:
    tolerance = rule.course(quantity)
    assert tolerance.tolerance == {"fmu": fmu, "reference": reference}
    of_scale = fmu > 0.0 and quantity != "spring_drop"
    assert tolerance.measure == ("of_scale" if of_scale else "absolute")


@pytest.mark.parametrize(
    ("name", "power"), [("period", 0), ("t_slip", 1), ("t_stick", 2), ("damped_t_stick", 2)]
)
def test_an_error_of_state_enters_a_formula_by_its_power_of_lambda(name: str, power: int) -> None:
    # At lambda = 0.01 the slip time loses 101 times as much, the stick time 10^4 times.
    fast = rules(v=6.2)
    enters = 1.0 + fast.lambda_**-power if power else 1.0
    tolerance = fast.formula(name)
    assert tolerance is not None
    assert tolerance.tolerance["fmu"] == 2.5e-12, "no step enters the block's arcs"
    assert 2.5e-9 * enters <= tolerance.tolerance["reference"] <= 1.05 * 2.5e-9 * enters


def test_what_cancels_or_lacks_a_gap_or_a_pull_has_no_rule() -> None:
    assert rules().formula("fast_slip_deficit") is None
    assert rules(mu_k=0.5).formula("t_slip") is None
    assert rules(v=0.0).formula("t_stick") is None
    assert rules(mu_k=0.5).formula("first_load_up") is not None
