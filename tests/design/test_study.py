"""The verdict on an axis: limits, operating points, cures, and the words."""

import math
from dataclasses import replace

import numpy as np
import pytest

from stickslip_design.axis import Axis, Demand, Friction, axis_file_of, example
from stickslip_design.critical import critical_feed, jumps_of
from stickslip_design.levers import BELOW, cured, levers
from stickslip_design.loop.stability import gain_limits
from stickslip_design.study import design
from stickslip_design.verdict import Verdict
from stickslip_fmu.block import Block
from stickslip_fmu.spec import SPEC

from .axes import RIGID, SERVO, driven

FILE = (
    example()
    .replace('"40 N/um"', '"40 N/um ± 2 N/um"')
    .replace("mu_s = 0.20", 'mu_s = "0.20 ± 0.01"')
    .replace('["0.5 mm/s", "2 mm/s", "5 mm/s"]', '["2 mm/s", "0.5 mm/s"]')
    .replace("[demand]", '[demand]\nlargest_jump = "15 um"')
)
"""The servo axis with ± and a largest jump."""


@pytest.fixture(scope="module")
def servo() -> Verdict:
    """Return the verdict on the servo axis at 0.5 mm/s."""
    return design(axis_file_of(FILE))


@pytest.fixture(scope="module")
def rigid() -> Verdict:
    """Return the verdict on the rigid axis at 3 mm/s."""
    return design(RIGID)


def test_the_critical_feed_on_a_rigid_drive(rigid: Verdict) -> None:
    """3.40650 mm/s = 204.390 mm/min, by the familiar formula 3.914 mm/s."""
    assert rigid.critical_feed == pytest.approx(3.40650e-3, abs=0.5e-8)
    assert rigid.critical_feed * 60e3 == pytest.approx(204.390, abs=5e-4)
    assert rigid.simplified_critical_feed == pytest.approx(3.914e-3, abs=5e-7)
    assert rigid.points[0].margin == pytest.approx(3.0 / 3.40650, rel=1e-5)
    assert rigid.sliding is None
    assert not rigid.responses


def test_a_rigid_axis_without_damping_is_asked_for_it() -> None:
    """Nothing else ends its jumps, and no data sheet states it; with it the end is told."""
    bare = replace(RIGID, c=0.0)
    assert "no end at any feed: state c or zeta of the axis" in design(bare).sentence
    assert "zeta" not in design(RIGID).sentence


def sticks(axis: Axis, feed: float) -> bool:
    """Tell by the exact block whether its second slip still comes to rest."""
    values = {"m": axis.m, "k": axis.k, "c": axis.c, "v": feed} | {
        "mu_s": axis.friction.mu_s, "mu_k": axis.friction.mu_k, "g": axis.g
    }  # fmt: skip
    block = SPEC.model(SPEC.values({**SPEC.table.start_values(), **values}))
    assert isinstance(block, Block)
    load_up = axis.F_s / (axis.k * feed)
    block.advance(0.0, 3.0 * load_up + 40.0 * math.sqrt(axis.m / axis.k))
    return block.meter.n_slips > 1


def test_each_cure_of_a_rigid_axis_lands_on_the_limit(rigid: Verdict) -> None:
    """The exact block sticks at a change smaller by 1e-6, and no more at one larger by 1e-6."""
    found = [each for each in rigid.cures if each.then is not None and each.number != "feeds"]
    assert {each.number for each in found} == {"mu_s", "stiffness", "c", "mass"}
    for cure in found:
        assert sticks(cured(RIGID, cure, 1.0 - 1e-6), 3e-3), cure
        assert not sticks(cured(RIGID, cure, 1.0 + 1e-6), 3e-3), cure
    *efforts, faster = rigid.cures
    assert faster.name == "faster"
    assert [each.effort for each in efforts] == sorted(each.effort for each in efforts)


def test_friction_in_newtons_is_held_when_the_mass_changes() -> None:
    """Then less mass is no cure: the critical feed rises."""
    text = example().replace("mu_s = 0.20", 'F_s = "981 N"').replace("mu_k = 0.15", 'F_k = "736 N"')
    of_forces = axis_file_of(text).axis()
    found = {each.number: each for each in levers(replace(of_forces, drive=None))}
    assert found["F_s"].now == pytest.approx(981.0)
    lighter = found["mass"].at(2.0)
    assert (lighter.m, lighter.F_s, lighter.F_k) == pytest.approx((250.0, 981.0, 736.0))
    assert critical_feed(lighter) > critical_feed(replace(of_forces, drive=None))


def test_each_cure_of_a_servo_ends_its_jumps(servo: Verdict) -> None:
    """A hundredth less leaves them; the limit of the loop says so."""
    found = [each for each in servo.cures if each.then is not None and each.number != "feeds"]
    assert found
    for cure in found:
        if cure.aim == BELOW:
            jumps = jumps_of(cured(SERVO, cure, 1.0), 5e-4)
            assert jumps is not None
            assert 13e-6 < jumps.way < 15.1e-6, cure
            continue
        assert critical_feed(cured(SERVO, cure, 0.99)) > 5e-4, cure
        assert critical_feed(cured(SERVO, cure, 1.0)) <= 5e-4 * 1.001, cure


def test_what_is_asked_is_answered_in_order(servo: Verdict) -> None:
    """The slowest feed first; above the limit there is no jump."""
    slow, fast = servo.points
    assert (slow.feed, fast.feed) == (5e-4, 2e-3)
    assert slow.jumps
    assert not fast.jumps
    assert slow.from_rest is True
    assert fast.from_rest is False
    assert slow.jump == pytest.approx(18.4e-6, abs=0.08e-6)
    assert slow.frequency == pytest.approx(27.1, abs=0.1)
    assert fast.margin == pytest.approx(2.0 / 1.5506, rel=1e-3)
    assert servo.from_rest == pytest.approx(0.99e-3, rel=0.02)
    assert servo.sentence.startswith(
        "At 30 mm/min this axis jumps 18.4 µm, 27 times a second; from 1.55 mm/s on it cannot. "
        "Cheapest cure: "
    )


def test_the_range_of_the_critical_feed_holds_its_corners(servo: Verdict) -> None:
    """± of static friction and stiffness: the softest with most friction jumps longest."""
    low, high = servo.critical_range
    friction = [Friction(mu_s=mu_s, mu_k=0.15) for mu_s in (0.19, 0.21)]
    assert low == pytest.approx(critical_feed(replace(SERVO, k=4.2e7, friction=friction[0])))
    assert high == pytest.approx(critical_feed(replace(SERVO, k=3.8e7, friction=friction[1])))
    assert low < servo.critical_feed < high


def test_both_ends_of_the_screw_count() -> None:
    """Two stiffnesses make a range without any ±."""
    found = design(replace(RIGID, stiffest=8e7))
    assert found.critical_range == (critical_feed(replace(RIGID, k=8e7)), found.critical_feed)


def test_motions_before_and_after_the_cheapest_cure(servo: Verdict) -> None:
    """It jumps on and on as it is; with the cure a swing dies away."""
    assert servo.before is not None
    assert servo.after is not None
    late = servo.before.time > 0.8 * servo.before.time[-1]
    assert np.ptp(servo.after.ahead[late]) < 0.5 * np.ptp(servo.before.ahead[late])


def test_an_unstable_loop_is_called_so_before_anything_else() -> None:
    """No limit and no cure, but what gains it would bear."""
    found = design(driven(K_v=80.0))
    assert not found.stable
    assert "unstable" in found.sentence
    assert "It bears K_v below 72.2 1/s" in found.sentence
    assert not found.points
    assert not found.cures


def test_a_gain_that_cannot_mend_an_unstable_loop_is_not_offered() -> None:
    """With a velocity loop that swings by itself no position gain helps: its limit is 0."""
    axis = driven(bandwidth=6000.0, T_n=4.0 / 6000.0)
    assert gain_limits(axis).K_v == 0.0
    assert "It bears a bandwidth below 716 1/s, all else held" in design(axis).sentence


@pytest.mark.parametrize(
    "axis",
    [
        replace(SERVO, friction=Friction(mu_s=0.005, mu_k=0.005)),
        replace(RIGID, friction=Friction(mu_s=0.1, mu_k=0.1)),
        replace(RIGID, c=2.0 * math.sqrt(RIGID.k * RIGID.m)),
    ],
)
def test_an_axis_that_cannot_jump_comes_out_clean(axis: Axis) -> None:
    """No gap, or more damping than a swing bears."""
    found = design(axis)
    assert found.critical_feed == 0.0
    assert found.sentence == "This axis does not jump at any feed."
    assert not any(point.jumps for point in found.points)
    assert not found.cures
    assert all(math.isinf(point.margin) for point in found.points)


def test_without_damping_the_jumps_of_a_rigid_axis_have_no_end() -> None:
    """None of the numbers ends them."""
    found = design(replace(RIGID, c=0.0))
    assert math.isinf(found.critical_feed)
    assert all(each.then is None for each in found.cures)
    assert "no end" in found.sentence


@pytest.mark.parametrize(
    "friction",
    [
        Friction(mu_s=0.25, mu_k=0.15, own={"tau_s": 0.1}),
        Friction(
            mu_s=0.25, mu_k=0.15, law="stribeck", own={"v_s": 1e-3, "delta": 2.0, "shape": 1.0}
        ),
    ],
)
def test_other_laws_act_on_a_rigid_drive(friction: Friction) -> None:
    """Growth in the dwell and a fall with speed move the limit by factors."""
    found = design(replace(RIGID, friction=friction, demand=Demand(feeds=(1e-4,))))
    limit = found.critical_feed
    assert not 2.5e-3 < limit < 4e-3
    assert found.points[0].jumps
    assert found.points[0].jump is not None
