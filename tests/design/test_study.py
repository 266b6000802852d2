"""The verdict on an axis: limits, operating points, cures, and the sentence."""

import math
from dataclasses import replace

import pytest

from stickslip_design.axis import Axis, Friction, axis_file_of, example
from stickslip_design.levers import BELOW, levers
from stickslip_design.loop.critical import critical_feed, jumps_of
from stickslip_design.study import design
from stickslip_design.verdict import AxisCure, Verdict
from tests.design.axes import RIGID, SERVO, driven
from tests.fmu.blocks import make_block

FILE = (
    example()
    .replace('"40 N/um"', '"40 N/um ± 2 N/um"')
    .replace("mu_s = 0.20", 'mu_s = "0.20 ± 0.01"')
    .replace('["0.5 mm/s", "2 mm/s", "5 mm/s"]', '["2 mm/s", "0.5 mm/s"]')
    .replace("[demand]", '[demand]\nlargest_jump = "15 um"')
)
"""The servo axis with ± and a largest jump."""


def cured(axis: Axis, cure: AxisCure, more: float) -> Axis:
    """Return an axis with a cure, its factor times another one."""
    same = cure.name, cure.held
    (lever,) = (lever for lever in levers(axis) if (lever.name, lever.held) == same)
    return lever.at(cure.effort * more)


@pytest.fixture(scope="module")
def servo() -> Verdict:
    return design(axis_file_of(FILE))


@pytest.fixture(scope="module")
def rigid() -> Verdict:
    return design(RIGID)


def test_on_a_rigid_drive_the_critical_feed_is_that_of_the_closed_form(rigid: Verdict) -> None:
    assert rigid.critical_feed == pytest.approx(3.40650e-3, abs=0.5e-8)  # docs/theory.md (13)
    assert rigid.simplified_critical_feed == pytest.approx(3.914e-3, abs=5e-7)  # to its digits
    assert rigid.points[0].margin == pytest.approx(3.0 / 3.40650, rel=1e-5)  # to its digits
    undamped = design(replace(RIGID, c=0.0))
    assert math.isinf(undamped.critical_feed)
    assert "no end at any feed: state c or zeta of the axis" in undamped.sentence


def sticks(axis: Axis, feed: float) -> bool:
    values = {"m": axis.m, "k": axis.k, "c": axis.c, "v": feed} | {
        "mu_s": axis.friction.mu_s, "mu_k": axis.friction.mu_k, "g": axis.g
    }  # fmt: skip
    block = make_block(**values)
    load_up = axis.F_s / (axis.k * feed)
    block.advance(0.0, 3.0 * load_up + 40.0 * math.sqrt(axis.m / axis.k))
    return block.meter.n_slips > 1


def test_at_a_cure_of_a_rigid_axis_the_exact_block_stops_sticking(rigid: Verdict) -> None:
    assert [each.effort for each in rigid.cures] == sorted(each.effort for each in rigid.cures)
    changed = [each for each in rigid.cures if each.then is not None]
    assert {each.number for each in changed} == {"mu_s", "stiffness", "c", "mass"}
    for cure in changed:
        assert sticks(cured(RIGID, cure, 1.0 - 1e-6), 3e-3), cure
        assert not sticks(cured(RIGID, cure, 1.0 + 1e-6), 3e-3), cure


def test_friction_in_newtons_stays_when_the_mass_changes_so_that_less_mass_is_no_cure() -> None:
    text = example().replace("mu_s = 0.20", 'F_s = "981 N"').replace("mu_k = 0.15", 'F_k = "736 N"')
    axis = replace(axis_file_of(text).axis(), drive=None)
    found = {each.number: each for each in levers(axis)}
    assert found["F_s"].now == pytest.approx(981.0)
    lighter = found["mass"].at(2.0)
    assert (lighter.m, lighter.F_s, lighter.F_k) == pytest.approx((250.0, 981.0, 736.0))
    assert critical_feed(lighter) > critical_feed(axis)


@pytest.mark.gate
def test_at_a_cure_of_a_servo_axis_its_jumps_end_and_a_hundredth_before_they_do_not(
    servo: Verdict,
) -> None:
    changed = [each for each in servo.cures if each.then is not None]
    assert changed
    for cure in changed:
        if cure.aim == BELOW:
            jumps = jumps_of(cured(SERVO, cure, 1.0), 5e-4)
            assert jumps is not None
            assert 13e-6 < jumps.way < 15.1e-6, cure
        else:
            assert critical_feed(cured(SERVO, cure, 0.99)) > 5e-4, cure
            # The cure is searched to a thousandth.
            assert critical_feed(cured(SERVO, cure, 1.0)) <= 5e-4 * 1.001, cure


def test_what_is_asked_is_answered_the_slowest_feed_first(servo: Verdict) -> None:
    slow, fast = servo.points
    assert (slow.feed, slow.jumps, slow.after_start) == (5e-4, True, True)
    assert (fast.feed, fast.jumps, fast.after_start) == (2e-3, False, False)
    # As runs of the two FMUs of docs/feed-axis.md have it, to their digits.
    assert slow.frequency == pytest.approx(27.1, abs=0.1)
    assert fast.margin == pytest.approx(2.0 / 1.5506, rel=1e-3)
    assert servo.from_rest == pytest.approx(0.99e-3, rel=0.02)
    assert "jumps 18.4 µm, 27 times a second; from 1.55 mm/s on it cannot" in servo.sentence


def test_the_range_of_the_critical_feed_holds_its_corners(servo: Verdict) -> None:
    low, high = servo.critical_range
    least, most = (Friction(mu_s=mu_s, mu_k=0.15) for mu_s in (0.19, 0.21))
    assert low == pytest.approx(critical_feed(replace(SERVO, k=4.2e7, friction=least)))
    assert high == pytest.approx(critical_feed(replace(SERVO, k=3.8e7, friction=most)))
    assert low < servo.critical_feed < high


@pytest.mark.parametrize(
    ("axis", "bears"),
    [
        (driven(K_v=80.0), "It bears K_v below 72.2 1/s"),
        # The velocity loop swings by itself: no position gain helps.
        (driven(bandwidth=6000.0, T_n=4.0 / 6000.0), "It bears a bandwidth below 716 1/s"),
    ],
)
def test_an_unstable_loop_is_called_so_with_the_gain_that_it_would_bear(
    axis: Axis, bears: str
) -> None:
    found = design(axis)
    assert (found.stable, *found.points, *found.cures) == (False,)
    assert bears in found.sentence


@pytest.mark.parametrize(
    "axis",
    [
        replace(SERVO, friction=Friction(mu_s=0.005, mu_k=0.005)),
        replace(RIGID, friction=Friction(mu_s=0.1, mu_k=0.1)),
        replace(RIGID, c=2.0 * math.sqrt(RIGID.k * RIGID.m)),
    ],
)
def test_without_a_gap_or_with_much_damping_an_axis_does_not_jump(axis: Axis) -> None:
    found = design(axis)
    assert found.critical_feed == 0.0
    assert not found.cures
    assert not any(point.jumps or point.margin < math.inf for point in found.points)
