"""Facts about the rules that give the tolerances, and about what they are told of a motion."""

import math
import re
from collections.abc import Mapping

import pytest

from stickslip_verification import load_cases
from stickslip_verification.model.formulas import FORMULAS
from stickslip_verification.model.quantities import GROUPS, OUTPUT_NAMES
from stickslip_verification.suite.tolerances import Facts, Rules, rounded_up
from stickslip_verification.truth import STRIBECK
from stickslip_verification.truth.parameters import complete

from .records import exact_of

DEFAULT = complete({})
SLIPS = Facts(slips=3)


def rules(*changed: Mapping[str, float], facts: Facts = SLIPS, **start: float) -> Rules:
    """Apply the rules to a start, and to changes of it."""
    values = [complete(start)]
    for change in changed:
        values.append({**values[-1], **change})
    return Rules(tuple(values), facts)


@pytest.mark.parametrize(
    ("value", "up"),
    [
        (0.0, 0.0),
        (2.5e-9, 2.5e-9),
        (2.51e-9, 2.6e-9),
        (9.91e-9, 1e-8),
        (7.75e-8, 7.8e-8),
        # What is beyond nine digits comes from the factors, such as 0.5/(0.5 - 0.49).
        (1e-6 * (1.0 + 1e-12), 1e-6),
        (1e-6 * (1.0 - 1e-12), 1e-6),
    ],
)
def test_a_tolerance_is_rounded_up_to_two_digits(value: float, up: float) -> None:
    """It never gets smaller than the rule says, but for rounding of the rule itself."""
    assert rounded_up(value) == up


def test_the_narrowest_gap_of_the_whole_run_conditions() -> None:
    """A change that narrows the gap counts from the start; one that widens it does not."""
    assert rules().conditioning == 2.5
    assert rules({"mu_k": 0.1}).conditioning == 2.5
    assert rules({"mu_k": 0.4}, {"mu_k": 0.3}).conditioning == pytest.approx(5.0)
    assert rules(mu_k=0.6).conditioning == pytest.approx(50.0), "the clamp leaves a gap of 0.01"


def test_the_gap_of_a_curve_is_that_to_its_least_point() -> None:
    """A curve has no mu_k: whatever that says, the relief comes from mu_s less the least point."""
    points = {"shape": 3.0, "n_points": 3.0, "mu_1": 0.5, "mu_2": 0.25, "mu_3": 0.4, "mu_4": 0.1}
    for mu_k in (0.0, 0.3, 0.499):
        values = complete({"mu_k": mu_k, **points}, STRIBECK.parameters)
        assert Rules((values,), SLIPS, law=STRIBECK).conditioning == 2.0


@pytest.mark.parametrize("mu", [0.5, 0.0])
def test_without_a_gap_nothing_is_conditioned(mu: float) -> None:
    """Two equal coefficients are known to be equal: there is no difference to lose digits in."""
    tolerance = rules(mu_s=mu, mu_k=mu).course("x")
    assert tolerance.allowed == {"fmu": 1e-12, "reference": 3e-9}
    assert "no gap" in tolerance.because["reference"]


def test_an_integration_pays_for_each_slip_and_at_least_for_one() -> None:
    """A motion that never completes a slip is integrated as well."""
    for slips, allowed in ((0, 2.5e-9), (1, 2.5e-9), (4, 1e-8), (3013, 7.6e-6)):
        tolerance = rules(facts=Facts(slips)).course("z")
        assert tolerance.allowed["reference"] == allowed
        assert re.search(rf"times {max(slips, 1)} slips?$", tolerance.because["reference"])


def test_a_change_and_a_reversal_are_restarts() -> None:
    """Either lets the block lose more than along arcs that follow from each other."""
    assert rules().course("x").allowed["fmu"] == 2.5e-12
    assert rules({"v": 0.0}).course("x").allowed["fmu"] == 1e-10
    assert rules(facts=Facts(3, reversals=1)).course("x").allowed["fmu"] == 1e-10
    narrow = rules({"v": 0.0}, mu_k=0.4995).course("x").allowed["fmu"]
    assert narrow == 1e-9, "a narrow gap amplifies more than a restart"


def test_what_is_not_integrated_has_nothing_to_lose() -> None:
    """States, counts, products, and the work of a stiffness that stays, in any motion."""
    motion = rules({"v": 0.0}, facts=Facts(3, zero=frozenset({"T"})))
    for quantity in ("mode", "sticking", "n_slips", "W_k", "T"):
        tolerance = motion.course(quantity)
        assert (tolerance.measure, *tolerance.allowed.values()) == ("absolute", 0.0, 0.0)
    for quantity in ("F_s", "mu_k_used"):
        assert set(motion.course(quantity).allowed.values()) == {1e-15}
    assert rules({"k": 900.0}).course("W_k") == rules({"k": 900.0}).course("W_pull")


def test_a_relief_of_nothing_is_held_against_the_extension() -> None:
    """Without gap and damping the spring drop is zero, so its own size is no measure."""
    extension = 0.5 * 9.81 / 1000.0 + 0.02 / math.sqrt(1000.0)
    tolerance = rules(mu_k=0.5).course("spring_drop")
    assert tolerance.measure == "absolute"
    assert tolerance.allowed["reference"] == pytest.approx(1e-9 * extension, rel=0.02)
    assert "5.5 mm" in tolerance.because["reference"]
    assert rules(load=-9.81).course("spring_drop").measure == "absolute"
    for motion in (rules(), rules(mu_k=0.5, c=1.0), rules({"F_ext": 1.0}, mu_k=0.5)):
        assert motion.course("spring_drop").measure == "of_scale"


def test_an_error_of_state_enters_a_formula_by_its_power_of_lambda() -> None:
    """At lambda = 0.01 slip time, stick time and period lose 101, 10^4 times and once as much."""
    fast = rules(v=6.2)
    factor = 1.0 / fast.lambda_
    for name, power in (("period", 0), ("t_slip", 1), ("t_stick", 2), ("damped_t_stick", 2)):
        tolerance = fast.formula(name)
        assert tolerance is not None
        enters = 1.0 + factor**power if power else 1.0
        assert tolerance.allowed["fmu"] == 2.5e-12, "no step enters the block's arcs"
        assert 2.5e-9 * enters <= tolerance.allowed["reference"] <= 1.05 * 2.5e-9 * enters
        assert f"{enters:.3g} times" in tolerance.because["reference"] or not power


def test_a_formula_of_another_kind_has_no_rule() -> None:
    """First-order remainders, cancellations, and a stick time where there is no gap."""
    assert rules().formula("fast_slip_deficit") is None
    assert rules().formula("slip_travel_of_the_end") is None
    assert rules(mu_k=0.5).formula("t_slip") is None
    assert rules(v=0.0).formula("t_stick") is None
    assert rules(mu_k=0.5).formula("first_load_up") is not None


def test_every_output_and_every_formula_gets_reasons() -> None:
    """No rule leaves a side without a tolerance or a reason."""
    found = [rules().course(name) for name in OUTPUT_NAMES]
    found += [each for name in FORMULAS if (each := rules().formula(name)) is not None]
    for tolerance in found:
        assert set(tolerance.allowed) == set(tolerance.because) == {"fmu", "reference"}
        assert all(len(text) > 20 for text in tolerance.because.values())


def test_a_group_names_outputs_and_none_twice() -> None:
    """Groups divide outputs, so that two of them never collide in a case."""
    named = [name for group in GROUPS.values() for name in group]
    assert len(named) == len(set(named))
    assert set(named) <= set(OUTPUT_NAMES)


def test_a_case_states_what_happens_in_it() -> None:
    """What the exact motion shows of reversals and zeros is what the suite's cases state."""
    seen = {case.id: case.facts for case in load_cases("*reversals*")}
    for name, facts in seen.items():
        assert facts is not None
        assert exact_of(name).facts.reversals == facts.reversals > 0
