"""The rules that give the tolerances of a case from its values and its exact motion."""

import math
import re
from collections.abc import Mapping

import pytest

from stickslip_verification.model.formulas import FORMULAS
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.suite.tolerances import Facts, Rules, rounded_up
from stickslip_verification.truth import STRIBECK
from stickslip_verification.truth.parameters import complete

SLIPS = Facts(slips=3)
SIDES = {"fmu", "reference"}


def rules(*changed: Mapping[str, float], facts: Facts = SLIPS, **start: float) -> Rules:
    """Apply the rules to a start, and to changes of it."""
    values = [complete(start)]
    for change in changed:
        values.append({**values[-1], **change})
    return Rules(tuple(values), facts)


def test_a_tolerance_is_rounded_up_to_two_digits() -> None:
    # What is beyond nine digits comes from the factors, such as 0.5/(0.5 - 0.49).
    up = {0.0: 0.0, 2.51e-9: 2.6e-9, 9.91e-9: 1e-8, 1e-6 + 1e-18: 1e-6, 1e-6 - 1e-18: 1e-6}
    assert {value: rounded_up(value) for value in up} == up


CURVE = {"shape": 3.0, "n_points": 3.0, "mu_1": 0.5, "mu_2": 0.25, "mu_3": 0.4, "mu_4": 0.1}


@pytest.mark.parametrize(
    ("rule", "conditioning"),
    [
        (rules(), 2.5),
        (rules({"mu_k": 0.1}), 2.5),
        (rules({"mu_k": 0.4}, {"mu_k": 0.3}), 5.0),
        # The clamp leaves a gap of 0.01.
        (rules(mu_k=0.6), 50.0),
        (rules(mu_k=0.5), 1.0),
        (rules(mu_s=0.0, mu_k=0.0), 1.0),
        # A curve has no mu_k: its gap is that to its least point.
        (
            Rules((complete({"mu_k": 0.499, **CURVE}, STRIBECK.parameters),), SLIPS, law=STRIBECK),
            2.0,
        ),
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
        (rules(facts=Facts(1)), "z", 2.5e-12, 2.5e-9),
        (rules(facts=Facts(4)), "z", 2.5e-12, 1e-8),
        (rules(facts=Facts(3013)), "z", 2.5e-12, 7.6e-6),
        (rules(mu_k=0.5), "x", 1e-12, 3e-9),
        # A change and a reversal are restarts; a narrow gap amplifies more.
        (rules({"v": 0.0}), "x", 1e-10, 7.5e-9),
        (rules(facts=Facts(3, reversals=1)), "x", 1e-10, 7.5e-9),
        (rules({"v": 0.0}, mu_k=0.4995), "x", 1e-9, 3e-6),
        # What is not integrated has nothing to lose.
        *((rules({"v": 0.0}), name, 0.0, 0.0) for name in ("mode", "sticking", "n_slips", "W_k")),
        *((rules({"v": 0.0}), name, 1e-15, 1e-15) for name in ("F_s", "mu_k_used")),
        (rules(facts=Facts(0, zero=frozenset({"T"}))), "T", 0.0, 0.0),
        (rules(), "x_pull", 1e-12, 1e-12),
        (rules({"k": 900.0}), "W_k", 1e-10, 7.5e-9),
    ],
)
def test_what_a_course_may_lose(rule: Rules, quantity: str, fmu: float, reference: float) -> None:
    tolerance = rule.course(quantity)
    assert tolerance.allowed == {"fmu": fmu, "reference": reference}
    assert tolerance.measure == ("of_scale" if fmu else "absolute")


def test_a_relief_of_nothing_is_held_against_the_extension() -> None:
    extension = 0.5 * 9.81 / 1000.0 + 0.02 / math.sqrt(1000.0)
    tolerance = rules(mu_k=0.5).course("spring_drop")
    assert tolerance.measure == "absolute"
    # Rounded up to two digits.
    assert tolerance.allowed["reference"] == pytest.approx(1e-9 * extension, rel=0.02)
    assert "5.5 mm" in tolerance.because["reference"]
    assert rules(load=-9.81).course("spring_drop").measure == "absolute"
    for motion in (rules(), rules(mu_k=0.5, c=1.0), rules({"F_ext": 1.0}, mu_k=0.5)):
        assert motion.course("spring_drop").measure == "of_scale"


@pytest.mark.parametrize(
    ("name", "power"), [("period", 0), ("t_slip", 1), ("t_stick", 2), ("damped_t_stick", 2)]
)
def test_an_error_of_state_enters_a_formula_by_its_power_of_lambda(name: str, power: int) -> None:
    # At lambda = 0.01 the slip time loses 101 times as much, the stick time 10^4 times.
    fast = rules(v=6.2)
    enters = 1.0 + fast.lambda_**-power if power else 1.0
    tolerance = fast.formula(name)
    assert tolerance is not None
    assert tolerance.allowed["fmu"] == 2.5e-12, "no step enters the block's arcs"
    assert 2.5e-9 * enters <= tolerance.allowed["reference"] <= 1.05 * 2.5e-9 * enters
    assert f"{enters:.3g} times" in tolerance.because["reference"] or not power


def test_what_cancels_or_is_of_first_order_has_no_rule() -> None:
    cancels = ("fast_slip_deficit", "slip_travel_of_the_end")
    found = [rules().formula(name) for name in cancels]
    assert [*found, rules(mu_k=0.5).formula("t_slip"), rules(v=0.0).formula("t_stick")] == [
        None
    ] * 4
    assert rules(mu_k=0.5).formula("first_load_up") is not None


def test_every_output_and_every_formula_has_a_reason_for_each_side() -> None:
    found = [rules().course(name) for name in OUTPUT_NAMES]
    found += [each for name in FORMULAS if (each := rules().formula(name)) is not None]
    for tolerance in found:
        assert set(tolerance.allowed) == set(tolerance.because) == SIDES
        assert all(len(text) > 20 for text in tolerance.because.values())
    assert re.search("times 3 slips$", rules().course("z").because["reference"])
