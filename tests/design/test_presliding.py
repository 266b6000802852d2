"""What presliding makes of a verdict, against closed forms, the sampled loop and itself."""

import cmath
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from stickslip_design.axis import Axis, Friction
from stickslip_design.loop.critical import regime_of
from stickslip_design.loop.follower import Follower
from stickslip_design.loop.presliding import at_feed, growth_of, stribeck_speed, with_presliding
from stickslip_design.loop.rest import hunting
from stickslip_design.report import data
from stickslip_design.study import design
from tests.design.axes import DRIVE, RIGID, SERVO, driven, random_axis


def yielding(axis: Axis, way: float, **changed: Any) -> Axis:
    return replace(axis, friction=replace(axis.friction, presliding=way, **changed))


def falling(axis: Axis, v_s: float) -> Axis:
    own = {"shape": 1.0, "v_s": v_s, "delta": 2.0}
    return yielding(axis, axis.friction.presliding, law="stribeck", own=own)


@pytest.mark.parametrize("way", [2e-6, 5e-8])
def test_at_rest_bristles_are_a_spring_of_break_away_force_over_presliding(way: float) -> None:
    axis = yielding(RIGID, way)
    sigma_0 = axis.F_s / way
    damping = axis.c + 2.0 * math.sqrt(sigma_0 * axis.m)
    root = -damping + cmath.sqrt(damping**2 - 4.0 * axis.m * (axis.k + sigma_0))
    expected = root.real / (2.0 * axis.m)
    assert growth_of(Follower(axis), 0.0) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("on_table", [True, False])
def test_the_slowest_motion_at_rest_solves_the_equation_of_the_loop(on_table: bool) -> None:
    axis = yielding(driven(on_table=on_table, dead_time=1e-3), 1e-6)
    s = growth_of(Follower(axis), 0.0)
    sigma_0 = axis.F_s / 1e-6
    # docs/feed-axis.md (1), (2): motor [m_d s^2 + d s + k + gain (s + K_v)] x_m = k x.
    passes = math.exp(-s * (1e-3 + DRIVE.T_s))
    gain = DRIVE.K_p * (s + 1.0 / DRIVE.T_n) * passes
    motor = DRIVE.inertia * s**3 + DRIVE.d * s**2 + axis.k * s + gain * s
    table = axis.m * s * s + (axis.c + 2.0 * math.sqrt(sigma_0 * axis.m)) * s + axis.k + sigma_0
    terms = [motor * table, -(axis.k**2) * s, gain * DRIVE.K_v * (axis.k if on_table else table)]
    # It is no swing, and slow against the delay, which the loop takes by Pade.
    assert abs(sum(terms)) < 1e-6 * max(map(abs, terms))


@pytest.mark.parametrize(("feed", "v_s"), [(2e-3, 2e-3), (5e-3, 2e-3), (5e-3, 5e-3), (2e-2, 5e-3)])
def test_a_small_swing_grows_as_the_eigenvalues_say_and_none_that_grows_is_even(
    feed: float, v_s: float
) -> None:
    axis = yielding(falling(RIGID, v_s), 2e-6)
    follower = Follower(axis)
    growth, swing = growth_of(follower, feed), 2.0 * math.pi * math.sqrt(axis.m / axis.k)
    # While it is small: far above the error of the solver, 1e-10 m/s, and below the feed.
    end = (2.0 if growth > 0.0 else 6.0) * swing
    start, time = follower.even(feed), np.linspace(0.0, end, 4002)[1:-1]
    start[1] += 1e-4 * feed
    rows = follower.states(start, lambda _: feed, lambda _: 0.0, (0.0, end), time)
    size = np.abs(rows[:, 1])
    peaks = 1 + np.flatnonzero((size[1:-1] > size[:-2]) & (size[1:-1] >= size[2:]))
    first, last = peaks[2], peaks[-1]
    rate = math.log(size[last] / size[first]) / (time[last] - time[first])
    # Tolerance: a swing of 2 % of the feed bends the friction by as much.
    assert rate == pytest.approx(growth, rel=0.02)
    found = at_feed(axis, feed)
    assert found.judders is not None
    assert ("even" in (found.from_rest.kind, found.from_jumps.kind)) <= (growth < 0.0)


@pytest.mark.parametrize(("axis", "feed"), [(SERVO, 5e-4), (SERVO, 1.2e-3), (RIGID, 3e-3)])
def test_without_presliding_the_jump_is_that_of_the_verdict(axis: Axis, feed: float) -> None:
    found = at_feed(yielding(axis, 2e-9), feed).from_jumps
    # A jump is read above half of the feed; below that the table goes some percent of its way.
    expected = regime_of(falling(axis, stribeck_speed(axis, feed)), feed).stick_slip
    assert expected is not None
    assert found.kind == "jumps"
    assert found.jump == pytest.approx(expected.jump, rel=0.05)
    assert found.period == pytest.approx(expected.period, rel=0.02)


@pytest.mark.gate
@pytest.mark.parametrize("seed", [11, 16, 23, 24])
def test_long_rests_are_no_even_motion(seed: int) -> None:
    axis = random_axis(seed)
    assert axis.drive is not None
    friction = Friction(mu_s=axis.friction.mu_s, mu_k=axis.friction.mu_k)
    axis = replace(axis, friction=friction, drive=replace(axis.drive, dry=0.0))
    feed = 0.2 * (axis.F_s - axis.F_k) / math.sqrt(axis.k * axis.m)
    expected = regime_of(falling(axis, stribeck_speed(axis, feed)), feed).stick_slip
    found = at_feed(yielding(axis, 1e-4 * (axis.F_s - axis.F_k) / axis.k), feed)
    assert found.judders is (expected is not None)


@pytest.mark.gate
def test_half_a_micrometre_ends_the_hunting_of_the_worked_axis() -> None:
    rest = hunting(SERVO)
    assert rest is not None
    stiff = at_feed(yielding(SERVO, 2e-9), 0.0, rest).from_rest
    assert (stiff.jump, stiff.period) == pytest.approx((rest.jump, rest.period), rel=0.06)
    assert at_feed(yielding(SERVO, 4e-7), 0.0, rest).judders is True
    assert at_feed(yielding(SERVO, 6e-7), 0.0, rest).judders is False


@pytest.mark.gate
def test_a_verdict_with_presliding_says_more_and_nothing_else() -> None:
    # Two axes: the rounding of one goes by what was asked of it before.
    bare, found = design(replace(SERVO)), design(replace(SERVO), presliding=True)
    before, after = data(bare), data(found)
    assert (before.pop("presliding"), bare.with_presliding) == (None, ())
    assert after.pop("presliding")["feeds"][0]["from_rest"]["kind"] == "even"
    assert before.pop("unanswered")[:2] == after.pop("unanswered")[:2]
    assert before == after
    (sentence,) = found.with_presliding
    assert "2 µm, an estimate for a sliding way: it jumps 11" in sentence
    assert "it does not hunt at a target, as from 0.5" in sentence


def test_what_presliding_is_not_known_of_is_refused() -> None:
    smooth = yielding(SERVO, 0.0, mu_s=0.0, mu_k=0.0)
    curve = yielding(SERVO, 0.0, law="stribeck", own={"shape": 3.0})
    growing = yielding(SERVO, 0.0, own={"tau_s": 1.0})
    axes = [driven(kind="rotary"), smooth, curve, growing, driven(K_v=100.0)]
    reasons = ["rotary", "no dry friction", "curve", "grows at rest", "unstable"]
    for axis, reason in zip(axes, reasons, strict=True):
        assert reason in with_presliding(axis, {}, None).refused
