"""The servo loop around an axis: limits, stability, hunting, starts from rest, open loops."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy import signal

from stickslip_design.axis import Axis, Filter, Friction, low_pass, notch
from stickslip_design.critical import rigid_critical_feed
from stickslip_design.loop.hunting import hunting
from stickslip_design.loop.jumps import jump_at, limit_of_jumps
from stickslip_design.loop.motion import Motion, Point, walk
from stickslip_design.loop.response import open_loop
from stickslip_design.loop.rest import Start
from stickslip_design.loop.stability import gain_limits, is_stable, swing
from stickslip_design.loop.system import LAST, MOTOR, SPEED, TABLE, Mode, System

from .axes import DRIVE, SERVO, driven


@pytest.mark.parametrize(
    ("axis", "feed"),
    [
        (SERVO, 1.550e-3),
        (driven(K_v=50.0), 2.427e-3),
        (driven(bandwidth=600.0, T_n=4.0 / 600.0), 4.198e-3),
        (driven(T_s=1e-3), 1.40e-3),
        (driven(T_s=0.5e-3), 1.49e-3),
        (driven(T_s=0.05e-3), 1.60e-3),
        (driven(dead_time=0.25e-3), 1.468e-3),
        (driven(dead_time=0.25e-3, K_v=50.0), 2.29e-3),
        (driven(dead_time=0.25e-3, bandwidth=600.0, T_n=4.0 / 600.0), 4.47e-3),
    ],
)
def test_jumping_ends_where_the_whole_loop_raised_slowly_ends_it(axis: Axis, feed: float) -> None:
    """The feeds are those of the loop solved as one, raised over 120 s; to 1 %."""
    assert limit_of_jumps(axis).feed == pytest.approx(feed, rel=0.01)


@pytest.mark.parametrize(
    ("axis", "jump", "period"),
    [
        (SERVO, 18.4e-6, 36.9e-3),
        (driven(velocity_feedforward=0.0), 18.4e-6, 36.9e-3),
        (driven(on_table=False), 17.5e-6, 34.9e-3),
        (driven(T_n=0.0), 17.0e-6, 34.0e-3),
        (driven(K_v=50.0), 20.3e-6, 40.6e-3),
        (driven(bandwidth=600.0, T_n=4.0 / 600.0), 20.0e-6, 40.0e-3),
        (replace(SERVO, c=16e3), 17.4e-6, 34.7e-3),
    ],
)
def test_the_jump_at_a_feed_is_that_of_the_two_fmus(axis: Axis, jump: float, period: float) -> None:
    """The numbers of the table in docs/feed-axis.md, at 0.5 mm/s, to their digits."""
    found = jump_at(axis, 5e-4)
    assert found is not None
    assert found.way == pytest.approx(jump, abs=0.08e-6)
    assert found.period == pytest.approx(period, abs=0.2e-3)
    assert found.way == pytest.approx(5e-4 * found.period, rel=5e-3)


def test_jumps_that_take_turns_are_all_counted() -> None:
    """Of 15.8, 16.5 and 21.1 um, as in the loop solved as one, the longest is told."""
    found = limit_of_jumps(driven(bandwidth=100.0, T_n=0.04), highest=5e-4)
    assert found.jump is not None
    assert found.jump.way == pytest.approx(21.1e-6, abs=0.1e-6)
    assert found.rate == pytest.approx(5e-4 / 17.8e-6, rel=0.01)


def test_no_jump_is_reached_above_the_limit() -> None:
    """Just below it the least speed of a slip is next to 0, the end of the cycle."""
    limit = limit_of_jumps(SERVO)
    assert limit.jump is not None
    assert -0.1 * limit.feed < limit.jump.least < 0.0
    assert jump_at(SERVO, 1.01 * limit.feed) is None
    assert jump_at(SERVO, 0.99 * limit.feed) is not None


@pytest.mark.parametrize("tau_s", [0.0, 0.02, 0.1])
def test_a_drive_that_never_gives_way_leaves_the_rigid_limit(tau_s: float) -> None:
    """An inertia of 1e7 t, position on the motor; static friction there at once, or growing."""
    own = {"tau_s": tau_s} if tau_s else {}
    friction = Friction(mu_s=0.20, mu_k=0.15, own=own)
    axis = replace(driven(inertia=1e10, on_table=False), friction=friction)
    wanted = rigid_critical_feed(axis)
    assert limit_of_jumps(axis).feed == pytest.approx(wanted, rel=5e-3)


@pytest.mark.parametrize(
    "own",
    [
        {"shape": 1.0, "v_s": 1e-3, "delta": 2.0},
        {"shape": 1.0, "v_s": 5e-3, "delta": 1.0},
        {"shape": 2.0, "v_s": 1e-3},
        {
            "shape": 3.0,
            "n_points": 3.0,
            "mu_1": 0.20,
            "u_2": 2e-3,
            "mu_2": 0.15,
            "u_3": 0.05,
            "mu_3": 0.16,
        },
    ],
)
def test_on_a_drive_that_never_gives_way_friction_falls_as_in_the_law(
    own: dict[str, float],
) -> None:
    """The limit is that of the law, which the lines of a smooth fall miss by less than 1 %."""
    friction = Friction(mu_s=0.20, mu_k=0.15, law="stribeck", own=own)
    axis = replace(driven(inertia=1e10, on_table=False), friction=friction)
    assert limit_of_jumps(axis).feed == pytest.approx(rigid_critical_feed(axis), rel=0.01)


def test_growing_static_friction_shortens_the_jumps_in_the_loop() -> None:
    """The faster the feed, the shorter the rests, in which it grows."""
    growing = replace(SERVO, friction=Friction(mu_s=0.20, mu_k=0.15, own={"tau_s": 0.05}))
    limit = limit_of_jumps(growing)
    assert 0.05e-3 < limit.feed < 0.5e-3
    slow, plain = jump_at(growing, 0.5 * limit.feed), jump_at(SERVO, 0.5 * limit.feed)
    assert slow is not None
    assert plain is not None
    assert slow.way < plain.way


def test_without_a_gap_there_is_no_jump() -> None:
    """Kinetic as large as static friction."""
    assert limit_of_jumps(replace(SERVO, friction=Friction(mu_s=0.15, mu_k=0.15))).feed == 0.0


@pytest.mark.parametrize(
    ("axis", "jump", "period"),
    [
        (SERVO, 13.6e-6, 0.85),
        (replace(SERVO, k=1e8), 5.4e-6, 1.50),
        (replace(SERVO, friction=Friction(mu_s=0.16, mu_k=0.15)), 2.7e-6, 3.89),
        (driven(K_v=50.0), 14.4e-6, 0.40),
        (driven(bandwidth=600.0, T_n=4.0 / 600.0), 13.6e-6, 0.55),
        (replace(SERVO, c=16e3), 12.7e-6, 0.92),
    ],
)
def test_hunting_is_that_of_the_two_fmus(axis: Axis, jump: float, period: float) -> None:
    """The numbers of the table in docs/feed-axis.md, to their digits; the band is half a jump."""
    found = hunting(axis)
    assert found is not None
    assert found.jump == pytest.approx(jump, abs=0.06e-6)
    assert found.period == pytest.approx(period, rel=0.02)
    assert found.dead_band == pytest.approx(0.5 * jump, rel=0.03)


def test_hunting_halves_and_ends_where_friction_falls_more_slowly() -> None:
    """6.91 um at v_s = 1 mm/s, as the two FMUs have it; at 2 and 5 mm/s the axis comes to rest."""
    found = [
        hunting(replace(SERVO, friction=Friction(mu_s=0.20, mu_k=0.15, law="stribeck", own=own)))
        for own in ({"shape": 1.0, "v_s": v_s, "delta": 1.0} for v_s in (1e-3, 2e-3, 5e-3))
    ]
    assert found[0] is not None
    assert found[0].jump == pytest.approx(6.91e-6, rel=0.005)
    assert found[1:] == [None, None]


@pytest.mark.parametrize("axis", [driven(on_table=False), driven(T_n=0.0)])
def test_an_axis_comes_to_rest_where_nothing_winds_up(axis: Axis) -> None:
    """Position on the motor, or no integral."""
    assert hunting(axis) is None


def test_a_start_from_rest_ends_evenly_below_the_limit() -> None:
    """Where the loop solved as one jumps on after 4 s at the lower and not at the higher feed."""
    for acceleration, low, high in ((1.0, 0.985e-3, 0.995e-3), (0.01, 1.29e-3, 1.31e-3)):
        limit = Start(SERVO, acceleration).limit()
        assert low < limit < high
        assert limit < limit_of_jumps(SERVO).feed


def test_gains_have_limits() -> None:
    """72 and 716 1/s; there the swing of the sliding table has no damping."""
    limits = gain_limits(SERVO)
    assert limits == pytest.approx((72.18, 716.3), rel=1e-3)
    for axis in (
        driven(K_v=limits.K_v),
        driven(bandwidth=limits.bandwidth, T_n=4.0 / limits.bandwidth),
    ):
        assert swing(axis).damping == pytest.approx(0.0, abs=1e-6)
    assert is_stable(driven(T_n=0.0))
    assert is_stable(driven(K_v=0.999 * limits.K_v))
    assert not is_stable(driven(K_v=1.001 * limits.K_v))
    assert gain_limits(driven(K_v=100.0)).K_v == pytest.approx(limits.K_v, rel=1e-9)


def test_the_gain_margin_of_the_position_loop_is_that_of_its_gain() -> None:
    """9.2 dB: with the gain of the open loop the position gain alone rises."""
    plain = driven(velocity_feedforward=0.0)
    found = open_loop(plain, "position")
    assert found.gain_margin == pytest.approx(gain_limits(plain).K_v / 25.0, rel=1e-9)
    assert 20.0 * math.log10(found.gain_margin) == pytest.approx(9.2, abs=0.05)


def test_the_delay_margin_of_the_force_is_the_dead_time_it_bears() -> None:
    """A rest of a sample is no pure lag, so the dead time has whole samples."""
    T_s = 10e-6
    found = open_loop(driven(T_s=T_s), "force").delay_margin
    late = math.floor(found / T_s) * T_s
    assert swing(driven(T_s=T_s, dead_time=late)).damping > 0.0
    assert swing(driven(T_s=T_s, dead_time=late + T_s)).damping < 0.0


@pytest.mark.parametrize("T_s", [250e-6, 1e-3])
@pytest.mark.parametrize("each", [low_pass(150.0), low_pass(150.0, 0.7), notch(90.0, 0.5, 0.1)])
def test_filters_are_scipys(each: Filter, T_s: float) -> None:
    """The response of the sampled filter over frequency, bilinear with the frequency kept."""
    w = 2.0 * math.pi * each.frequency
    if each.kind == "notch":
        above = [1.0, 2.0 * each.depth * each.damping * w, w * w]
        below = [1.0, 2.0 * each.damping * w, w * w]
    elif math.isinf(each.damping):
        above, below = [w], [1.0, w]
    else:
        above, below = [w * w], [1.0, 2.0 * each.damping * w, w * w]
    bent = w / (2.0 * math.tan(0.5 * w * T_s))
    b, a = signal.bilinear(above, below, fs=bent)
    b0, b1, b2, a1, a2 = each.coefficients(T_s)
    _, wanted = signal.freqz(b, a, 64)
    _, found = signal.freqz([b0, b1, b2], [1.0, a1, a2], 64)
    assert found == pytest.approx(wanted, rel=1e-9, abs=1e-12)


def test_parts_that_do_nothing_change_nothing() -> None:
    """A filter far above the loop, a lag far below the sample, and dry friction of the motor."""
    plain = limit_of_jumps(SERVO).feed
    for changed in (
        {"filters": (low_pass(1900.0),)},
        {"lag": 1e-6},
        {"dead_time": 1e-7},
        {"dry": 300.0},
    ):
        assert limit_of_jumps(driven(**changed)).feed == pytest.approx(plain, rel=0.03), changed


def test_a_lag_is_close_to_a_dead_time_as_long() -> None:
    """Of 0.1 ms: both lag by w times it."""
    lag = swing(driven(lag=1e-4)).damping
    dead = swing(driven(dead_time=1e-4)).damping
    assert lag == pytest.approx(dead, rel=0.02)
    assert lag != pytest.approx(swing(SERVO).damping, rel=0.02)
    assert DRIVE.lag == 0.0


@pytest.mark.parametrize(
    "changed",
    [
        {},
        {"velocity_feedforward": 0.0},
        {"on_table": False, "velocity_feedforward": 0.5},
        {"dry": 300.0, "friction_feedforward": 200.0},
        {"lag": 1e-3},
        {"dead_time": 0.4e-3, "filters": (low_pass(150.0, 0.7), notch(90.0, 0.5, 0.1))},
    ],
)
def test_an_even_motion_stays_even(changed: dict[str, Any]) -> None:
    """From sample to sample the places go on by the feed, and nothing else changes."""
    feed, system = 2e-3, System(replace(driven(**changed), along=100.0))
    axis, drive, command = system.axis, system.drive, system.layout.command
    force = axis.F_k + axis.c * feed - axis.along
    state = system.holding(force, feed)
    state[SPEED] = feed
    state[[MOTOR, LAST]] += force / axis.k
    state[command] += 0.0 if drive.on_table else force / axis.k
    change = system.from_sample_to_sample(system.sliding) @ state - state
    wanted = np.zeros_like(state)
    wanted[[MOTOR, TABLE, LAST, command]] = feed * drive.T_s
    # Forces of 1e3 N over an inertia of 2e3 kg, in double precision.
    assert change == pytest.approx(wanted, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(("dead_time", "until", "late"), [(75e-6, 75e-6, 1), (0.6e-3, 0.1e-3, 3)])
def test_the_older_command_holds_till_the_dead_time_is_over(
    dead_time: float, until: float, late: int
) -> None:
    """A rest of a sample of dead time lies at its beginning."""
    parts = System(driven(dead_time=dead_time)).parts
    lates = [part.late for part in parts]
    assert lates == sorted(lates, reverse=True)
    assert set(lates) == {late, late - 1}
    assert sum(part.length for part in parts if part.late == late) == pytest.approx(until)


@pytest.mark.parametrize("lag", [0.0, 1e-3])
def test_backward_is_the_mirror_of_forward(lag: float) -> None:
    """About a target on either side, with dry friction of the motor, which comes to rest too."""
    system = System(driven(dry=300.0, lag=lag))
    motion = Motion(system)
    walks = []
    for side in (1, -1):
        state = system.at_rest()
        state[system.layout.command] = side * 1e-4
        turns = list(walk(motion, Mode(0, 0), Point(state, 0.0), 1.0))
        walks.append(
            [(turn.time, side * turn.mode.table, side * turn.mode.motor) for turn in turns]
        )
        assert {turn.mode.motor for turn in turns} == {-1, 0, 1}
    assert walks[1] == pytest.approx(np.array(walks[0]), abs=1e-9)
