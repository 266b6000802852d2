"""What an axis does at a feed, where its friction has a plateau and falls beyond it."""

import math
from dataclasses import replace

import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from stickslip_design.axis import Axis, Demand, Drive, Friction
from stickslip_design.loop.critical import limits_of, regime_of
from stickslip_design.study import design
from stickslip_ref import Parameters, Regime, Shape, regime

POINTS = ((8e-3, 0.15), (12e-3, 0.11), (0.1, 0.11))
CURVE = {"shape": float(Shape.CURVE), "n_points": 4.0, "mu_1": 0.15} | {
    f"{name}_{number}": value
    for number, point in enumerate(POINTS, 2)
    for name, value in zip(("u", "mu"), point, strict=True)
}
RIGID = Axis(
    name="plateau", m=400.0, k=5e7, c=1e3, demand=Demand(feeds=(2e-3, 4e-3, 10e-3, 30e-3)),
    friction=Friction(mu_s=0.15, mu_k=0.11, law="stribeck", own=CURVE),
)  # fmt: skip
DRIVE = Drive(
    inertia=45e-4 * (2.0 * math.pi / 0.01) ** 2, K_v=2.0 / 60.0 / 1e-3, bandwidth=250.0,
    T_n=4.0 / 250.0, T_s=250e-6,
)  # fmt: skip
SERVO = replace(RIGID, drive=DRIVE)
SLOPE = 0.04 * 400.0 * 9.81 / 4e-3
"""How friction falls from 8 to 12 mm/s [N.s/m]."""


def test_a_servo_axis_swings_without_a_stop_where_its_friction_falls() -> None:
    kinds = [regime_of(SERVO, feed).kinds for feed in SERVO.demand.feeds]
    assert kinds == [("even",), ("even",), ("swings",), ("even",)]
    found = limits_of(SERVO)
    assert found.cycle == ()
    (falls,) = found.unstable
    assert (falls.low, falls.high) == pytest.approx((8e-3, 12e-3))


@pytest.mark.parametrize("T_n", [0.0, 0.016])
def test_a_drive_that_hardly_follows_is_judged_in_no_time(T_n: float) -> None:
    drive = replace(DRIVE, K_v=1e-9, T_n=T_n)
    axis = replace(RIGID, drive=drive, c=0.0, friction=Friction(mu_s=0.1, mu_k=0.08))
    assert limits_of(axis).highest < 1e-3
    assert regime_of(axis, 2e-2).kinds == ("even",)


@pytest.mark.gate
def test_a_swing_is_in_the_first_sentence() -> None:
    assert "At 10 mm/s this axis swings by ± 54 % of the feed" in design(SERVO).sentence


def test_sampled_ever_faster_it_swings_as_the_continuous_loop_does() -> None:
    fast = replace(SERVO, drive=replace(DRIVE, T_s=1e-5))
    (swing,) = regime_of(fast, 10e-3).swings
    # By SciPy on the continuous loop the table's velocity is 0.40 to 1.60 of the feed.
    assert swing.amplitude == pytest.approx(0.60, abs=5e-3)


def test_a_curve_with_a_plateau_gives_jumps_a_lower_end() -> None:
    (cycle,) = limits_of(RIGID).cycle
    assert (cycle.low, cycle.high) == pytest.approx((4.263e-3, 56.595e-3), abs=5e-7)
    even = regime_of(RIGID, 4e-3)
    assert even.kinds == ("even",)
    # The swing after the start from rest dies with exp(-c t/(2 m)): to 5 % after
    # ln(1/0.05)/1.25 = 2.40 s, to a part of a swing.
    assert even.settling == pytest.approx(2.39, abs=0.02)
    assert regime_of(RIGID, 30e-3).kinds == ("sticks", "even")
    assert regime_of(RIGID, 10e-3).kinds == ("sticks",)


@pytest.mark.parametrize("factor", [pytest.param(0.999, marks=pytest.mark.gate), 1.001])
def test_a_falling_friction_is_unstable_where_its_slope_exceeds_the_damping(factor: float) -> None:
    assert regime_of(replace(RIGID, c=factor * SLOPE), 10e-3).even is (factor > 1.0)


def test_what_a_start_from_rest_reaches_comes_first_though_nothing_is_known_of_it() -> None:
    assert Regime(1.0, -1e-6, 5.0, (), None, "sticks", math.inf).words == "sticks and slips"


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_without_a_gap_and_damping_a_mass_swings_and_does_not_stick(mu: float) -> None:
    found = regime(Parameters(mu_s=mu, mu_k=mu, c=0.0, v=0.02))
    assert found.words.endswith("without a stop; moves evenly after another start")


@pytest.mark.gate
def test_a_swing_that_fades_slowly_ends_where_friction_gives_what_damping_takes() -> None:
    p = Parameters(mu_s=0.3003, mu_k=0.3, c=0.1004, v=0.02)
    (swing,) = regime(p, "stribeck", {"v_s": 0.0221, "delta": 2.0}).swings

    def work(phi: float, amplitude: float) -> float:
        speed = p.v * (1.0 + amplitude * math.cos(phi))
        falls = p.m * p.g * (p.mu_s - p.mu_k) * math.exp(-((speed / 0.0221) ** 2))
        return float((falls + p.c * speed) * math.cos(phi))

    end = brentq(lambda amplitude: quad(work, 0.0, math.pi, amplitude)[0], 0.1, 0.9)
    assert swing.amplitude == pytest.approx(end, rel=1e-4)


@pytest.mark.gate
def test_a_servo_can_stabilise_a_table_and_destabilise_it() -> None:
    assert limits_of(RIGID).cycle
    assert not limits_of(SERVO).cycle
    soft = replace(SERVO, drive=replace(DRIVE, bandwidth=60.0, T_n=0.0, K_v=5.0))
    assert regime_of(soft, 10e-3).kinds == ("sticks",)
    assert regime_of(RIGID, 30e-3).even
    assert not design(replace(SERVO, drive=replace(DRIVE, K_v=150.0))).stable
