"""Static friction that grows at rest, in the reference: its sticks, its cycle and where it ends.

docs/theory.md (19) to (25).
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from scipy.special import lambertw

from stickslip_ref import (
    COULOMB,
    Change,
    Parameters,
    coulomb_limit,
    critical_lambda,
    critical_velocity,
    simulate,
    steady_cycle,
)
from stickslip_ref.dwell import Block, Family, critical_speed, cycle_ranges

AXIS = {"m": 500.0, "k": 40e6, "c": 4000.0, "mu_s": 0.20, "mu_k": 0.15}
"""The axis of docs/feed-axis.md on a rigid drive."""

QUANTITIES = ("T", "t_stick", "t_slip", "delta_x", "spring_drop", "x_dot_peak")


def _with(own: Mapping[str, float], **values: Any) -> Parameters:
    return COULOMB.complete(Parameters(**values), own)


def _settled(p: Parameters, cycles: int) -> Any:
    """Return the last cycle of a run that begins at rest."""
    rough = 2.0 * math.pi / float(p.w) + 2.0 * float(p.Delta) / abs(float(p.v))
    return simulate(p, cycles * rough, own=p.own).cycles[-1]


def test_the_first_stick_lasts_as_long_as_lambert_says() -> None:
    """``k v t = F_s - (F_s - F_k) exp(-t/tau)``, closed by Lambert's W; also with an old stick."""
    p, tau = Parameters(), 0.1
    a, b = 0.5 * 9.81 / 20.0, 0.2 * 9.81 / 20.0
    t = a + tau * float(np.real(lambertw(-b / tau * math.exp(-a / tau))))
    for changes in ([], [Change(0.05, {"load": 0.0}), Change(0.1, {"c": 0.0})]):
        run = simulate(p, 0.4, own={"tau_s": tau}, changes=changes, times=[0.1, 0.35])
        assert run.events[0].time == pytest.approx(t, rel=1e-14)
        assert run.t_stick[-1] == pytest.approx(t, rel=1e-14)
        np.testing.assert_allclose(
            run.F_s, [9.81 * (0.5 - 0.2 * math.exp(-1.0)), 9.81 * 0.3], rtol=1e-14
        )
    old = simulate(p, 0.4, own={"tau_s": tau, "age_start": 0.3})
    b *= math.exp(-0.3 / tau)
    t = a + tau * float(np.real(lambertw(-b / tau * math.exp(-a / tau))))
    assert old.events[0].time == pytest.approx(t, rel=1e-14)
    assert old.t_stick[-1] == pytest.approx(t, rel=1e-14)
    # A later stick is fresh, and the slip begins with what has grown in it.
    later = simulate(p, 1.0, own={"tau_s": tau, "age_start": 0.3})
    stop, second = later.events[1:3]
    grown = 0.2 * 9.81 * -math.expm1(-(second.time - stop.time) / tau)
    assert 1000.0 * second.z == pytest.approx(0.3 * 9.81 + grown, rel=1e-14)
    just_after = simulate(
        p, second.time + 1e-6, own={"tau_s": tau, "age_start": 0.3}, times=[second.time + 1e-6]
    )
    assert just_after.x_dot[0] == pytest.approx(1e-6 * grown, rel=1e-4)
    assert simulate(p, 1.0, own={"tau_s": 0.0, "B": 0.0}).events == simulate(p, 1.0).events


def test_a_force_that_is_met_at_the_start_holds_where_friction_grows_faster() -> None:
    """From |A| = F_s(0) on the mass sticks while friction grows faster than the load."""
    values = {"g": 8.0, "k": 1024.0, "mu_k": 0.25, "v": 2.0**-6, "z_start": 2.0 / 1024.0}
    run = simulate(Parameters(**values), 1.0, own={"tau_s": 2.0**-6})
    assert run.events[0].time == pytest.approx(0.125, abs=1e-4)
    assert simulate(Parameters(**values), 1.0, own={"tau_s": 0.25}).events[0].time == 0.0


@pytest.mark.parametrize(
    ("own", "values"),
    [
        ({"tau_s": 0.1}, {}),
        ({"tau_s": 0.01}, {"v": -0.02}),
        ({"B": 0.02, "t_0": 1e-3}, {"v": 0.01}),
        ({"tau_s": 0.05, "B": 0.01, "t_0": 0.1}, {"load": 5.0, "F_ext": 1.0}),
        ({"tau_s": 0.05}, {"c": 3.0}),
        ({"tau_s": 0.05, "B": 0.01, "t_0": 0.1}, {"c": 10.0, "v": 0.005}),
    ],
)
def test_a_run_settles_to_the_steady_cycle(
    own: Mapping[str, float], values: Mapping[str, float]
) -> None:
    """The integrated motion tends to the fixed point; F_s, Delta, lambda are those of its break."""
    p = _with(own, **values)
    cycle, measured = steady_cycle(p), _settled(p, 40)
    assert cycle.exists
    for name in QUANTITIES:
        assert getattr(measured, name) == pytest.approx(getattr(cycle, name), rel=1e-10)
    held = COULOMB.break_away_force(p, float(cycle.t_stick))
    assert cycle.F_s == pytest.approx(held, rel=1e-14)
    assert cycle.Delta == pytest.approx((held - float(p.mu_k * p.N)) / float(p.k), rel=1e-13)
    assert cycle.lambda_ == pytest.approx(float(p.w * cycle.Delta / np.abs(p.v)), rel=1e-14)
    if not values.get("c"):
        assert cycle.spring_drop == pytest.approx(math.copysign(2 * cycle.Delta, p.v), rel=1e-13)


def test_parameters_without_growth_have_the_cycle_of_constant_coefficients() -> None:
    """Plain parameters, growth that is over at once, and growth without a gap: the same bits."""
    plain = Parameters(c=1.0)
    assert steady_cycle(_with({}, c=1.0)) == steady_cycle(plain)
    assert steady_cycle(_with({"t_0": 5.0, "age_start": 3.0}, c=1.0)) == steady_cycle(plain)
    no_gap = {"mu_k": 0.5}
    assert steady_cycle(_with({"tau_s": 1.0}, **no_gap)) == steady_cycle(Parameters(**no_gap))


def test_the_cycle_of_a_field_is_that_of_its_points() -> None:
    """Arrays give arrays, NaN where no cycle is: beyond the limit, at rest, without a gap."""
    own = {"tau_s": 0.05}
    field: Any = steady_cycle(_with(own, v=[[0.01], [0.2], [0.0]], mu_k=[0.3, 0.5]))
    assert field.T.shape == (3, 2)
    assert field.exists.tolist() == [[True, True], [False, True], [False, False]]
    assert field.T[0, 0] == steady_cycle(_with(own, v=0.01)).T
    assert field.t_stick[0, 1] == 0.0
    assert np.isnan(field.T[1, 0])
    assert field.F_s[1, 0] == pytest.approx(0.3 * 9.81, rel=1e-15)


@pytest.mark.parametrize("digits", [3, 6, 9])
def test_growth_tends_to_constant_coefficients_with_its_rate(digits: int) -> None:
    """The sticks are shorter by exp(-t_stick/tau_s), the period as (24) says."""
    plain: Any = steady_cycle(Parameters())
    tau_s = plain.t_stick / (digits * math.log(10.0))
    cycle, epsilon, L = steady_cycle(_with({"tau_s": tau_s})), 10.0**-digits, plain.lambda_
    # The second order, and what is left of the digits in a difference.
    near = 50.0 * digits * epsilon + 1e-14 / epsilon
    assert cycle.t_stick / plain.t_stick - 1.0 == pytest.approx(-epsilon, rel=near)
    shorter = 2.0 / math.sqrt(1000.0) * L**3 / (1.0 + L**2) * epsilon
    assert (plain.T - cycle.T) / shorter == pytest.approx(1.0, rel=near)
    assert 1.0 - cycle.F_s / plain.F_s == pytest.approx(0.4 * epsilon, rel=near)


def test_the_axis_jumps_up_to_a_tenth_of_a_millimetre_a_second() -> None:
    """3.95 mm/s with constant coefficients, 0.11 mm/s if static friction needs 0.1 s."""
    assert 1e3 * coulomb_limit(Parameters(**AXIS)) == pytest.approx(3.95, abs=0.005)
    (found,) = cycle_ranges(_with({"tau_s": 0.1}, **AXIS), (1e-6, 0.1))
    assert 1e3 * found.high == pytest.approx(0.11, abs=0.0005)
    assert found == (1e-6, critical_speed(_with({"tau_s": 0.1}, **AXIS)), "none", "fold")
    assert cycle_ranges(_with({"tau_s": 0.1}, **AXIS), (0.12e-3, 0.1)) == ()
    inside = cycle_ranges(_with({"tau_s": 0.1}, **AXIS), (1e-6, 1e-5))
    assert inside == ((1e-6, 1e-5, "none", "none"),)


@pytest.mark.parametrize(
    ("own", "values", "v_c"),
    [
        ({"tau_s": 0.05}, {}, 2.0 * 9.81 * 0.2 / 0.05 / 1000.0),
        ({"tau_s": 0.05, "B": 0.01, "t_0": 0.1}, {}, 2.0 * 9.81 * (4.0 + 0.1) / 1000.0),
        ({"B": 0.01, "t_0": 0.1}, {"mu_k": 0.5}, 2.0 * 9.81 * 0.1 / 1000.0),
        ({"tau_s": 0.05, "B": 0.01, "t_0": 0.1}, {"mu_k": 0.5}, 2.0 * 9.81 * 0.1 / 1000.0),
        ({"tau_s": 0.05}, {"load": 9.81}, 4.0 * 9.81 * 0.2 / 0.05 / 1000.0),
        ({"B": 0.01, "t_0": 0.1}, {}, math.inf),
    ],
)
def test_without_damping_the_limit_has_a_formula(
    own: Mapping[str, float], values: Mapping[str, float], v_c: float
) -> None:
    """(20); none where a fresh stop holds more than kinetic friction."""
    p = _with(own, **values)
    assert critical_speed(p) == pytest.approx(v_c, rel=1e-15)
    (found,) = cycle_ranges(p, (1e-3, 10.0))
    assert found.high_end == ("none" if v_c == math.inf else "grazing")
    assert found.high == pytest.approx(min(v_c, 10.0), rel=1e-15)
    if v_c < math.inf:
        # From rest, 1 % below and above: the sticks keep their length, or shrink to nothing.
        for v, there in ((0.99 * v_c, True), (1.01 * v_c, False)):
            q = _with(own, **values, v=v)
            cycle = steady_cycle(q)
            assert cycle.exists is there
            seen = simulate(q, 100.0 * 0.2, own=own, rtol=1e-8).cycles
            if there:
                assert 0.99 < seen[-1].t_stick / cycle.t_stick < 2.0
            else:
                # By the factor 1 - 2 d = 0.98 a cycle, from (22).
                assert seen[-1].t_stick / seen[-31].t_stick < 0.6


def test_a_fast_growth_ends_by_grazing_as_constant_coefficients_do() -> None:
    """The fold goes to the grazing limit (14) faster than any power of tau_s."""
    limit = coulomb_limit(Parameters(c=5.0))
    w, grazing = math.sqrt(1000.0), float(critical_lambda(5.0 / (2.0 * math.sqrt(1000.0))))
    found = []
    for tau_s in (0.3, 0.1, 0.03, 0.01, 0.001):
        (each,) = cycle_ranges(_with({"tau_s": tau_s}, c=5.0), (1e-4, 10.0))
        found.append((limit - each.high) / limit)
        assert each.high_end == ("fold" if tau_s > 0.005 else "grazing")
        grown = -math.expm1(-grazing / w / tau_s)
        assert each.high >= limit * grown * (1.0 - 1e-15)
    assert found == sorted(found, reverse=True)
    assert found[-1] == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("zeta", [0.01, 0.3, 0.8])
@pytest.mark.parametrize("own", [{"tau_s": 0.02}, {"tau_s": 0.3, "B": 0.02, "t_0": 0.01}])
def test_the_slope_of_the_family_is_its_derivative(own: Mapping[str, float], zeta: float) -> None:
    """(22) against differences, and one maximum: where it is 0."""
    family = Family(_with(own, c=2.0 * zeta * math.sqrt(1000.0)))
    fold, top, _ = family.fastest()
    for stretch in (1.001, 1.1, 3.0, 100.0):
        at = family.least * stretch
        step = 1e-6 * (at - family.least)
        rise = math.log(family.speed(at + step) / family.speed(at - step))
        assert family.slope(at) == pytest.approx(rise * at / (2.0 * step), rel=1e-6, abs=1e-6)
        assert family.speed(at) <= top * (1.0 + 1e-15)
        assert (family.slope(at) > 0.0) == (at < fold)


def test_a_damped_cycle_ends_in_a_fold() -> None:
    """Just below the fold the cycle stays; just above no stick is left after some passages."""
    own, values = {"tau_s": 0.05}, {"c": 4.0}
    top = critical_speed(_with(own, **values))
    p = _with(own, **values, v=0.9995 * top)
    cycle = steady_cycle(p)
    stop = (float(cycle.F_s) - 1000.0 * float(cycle.spring_drop)) / 1000.0
    below = simulate(Parameters(**values, v=p.v, z_start=stop), 20.0, own=own)
    assert below.cycles[-1].t_stick == pytest.approx(float(cycle.t_stick), rel=1e-8)
    above = simulate(Parameters(**values, v=1.0005 * top, z_start=stop), 60.0, own=own, rtol=1e-9)
    assert above.events[-1].kind == "break-away"
    assert above.events[-1].time < 50.0
    assert len(above.cycles) > 20
    assert not steady_cycle(_with(own, **values, v=1.0005 * top)).exists


@pytest.mark.parametrize("tau_s", [1e-5, 0.05, 100.0])
def test_the_range_that_is_searched_reaches_beyond_the_limit(tau_s: float) -> None:
    """However quick the growth, the one function for all laws finds the limit (20)."""
    found = critical_velocity(Parameters(), own={"tau_s": tau_s})
    (sticks,) = found.cycle
    assert sticks.high == pytest.approx(2.0 * 9.81 * 0.2 / tau_s / 1000.0, rel=1e-15)
    assert sticks.high_end == "grazing"


@pytest.mark.parametrize("zeta", [1.0, 3.0])
def test_without_a_swing_there_is_no_cycle(zeta: float) -> None:
    """From critical damping on no slip ends, however friction grows."""
    p = _with({"tau_s": 0.1}, c=2.0 * zeta * math.sqrt(1000.0))
    assert cycle_ranges(p, (1e-6, 10.0)) == ()
    assert critical_speed(p) == 0.0
    assert not steady_cycle(p).exists


@pytest.mark.parametrize(
    ("own", "values"),
    [
        ({"tau_s": 0.05}, {"mu_k": 0.08}),
        ({"tau_s": 0.05}, {"mu_k": 0.08, "c": 1.0}),
        ({"tau_s": 0.02}, {"mu_k": 0.03, "v": -0.01}),
        ({"tau_s": 0.02, "B": 0.01, "t_0": 0.01}, {"mu_k": 0.03, "c": 3.0, "v": 0.005}),
    ],
)
def test_a_cycle_with_reversals_is_that_of_a_run(
    own: Mapping[str, float], values: Mapping[str, float]
) -> None:
    """Stick and period of the integrated motion; slip and jump count to the re-stick."""
    p = _with(own, **values)
    cycle: Any = steady_cycle(p)
    run = simulate(p, 30.0, own=own)
    kinds = [event.kind for event in run.events]
    assert "reversal" in kinds[-8:]
    measured = run.cycles[-1]
    assert cycle.exists
    assert pytest.approx(cycle.T, rel=1e-9) == measured.T
    assert measured.t_stick == pytest.approx(cycle.t_stick, rel=1e-9)
    assert cycle.t_slip == pytest.approx(cycle.T - cycle.t_stick, rel=1e-14)
    assert cycle.delta_x == pytest.approx(float(p.v) * cycle.T, rel=1e-14)
    along = [run.x_dot[run.t > 25.0].max(), run.x_dot[run.t > 25.0].min()]
    assert cycle.x_dot_peak == pytest.approx(along[0] if float(p.v) > 0 else along[1], rel=3e-3)
    assert cycle_ranges(p, (1e-4, 1e-2))[0].low == 1e-4


def test_slow_growth_over_weak_kinetic_friction_is_irregular() -> None:
    """A tent map, (23): sticks of no one length for ever, so stick-slip without a steady cycle."""
    own, values = {"tau_s": 20.0}, {"mu_k": 0.01, "mu_s": 0.9, "v": 5e-4}
    p = _with(own, **values)
    assert not steady_cycle(p).exists
    assert cycle_ranges(p, (1e-4, 7e-4)) == ((1e-4, 7e-4, "none", "none"),)
    lengths = [each.t_stick for each in simulate(p, 100.0, own=own, rtol=1e-9).cycles[-30:]]
    assert max(lengths) > 1.1 * min(lengths)
    block, t = Block(p, 5e-4), lengths[0]
    for _ in range(100):
        following = block.next_stick(t)
        assert following is not None
        assert 0.0 < following < 2.0 * max(lengths)
        t = following


def test_a_reversal_without_kinetic_friction_never_holds() -> None:
    """With mu_k = 0 a fresh stop holds nothing: the mass swings on, and there is no stick."""
    p = _with({"tau_s": 0.1}, mu_k=0.0)
    assert not steady_cycle(p).exists
    assert cycle_ranges(p, (1e-3, 1e-2)) == ()
    run = simulate(p, 1.5, own=p.own)
    assert {event.kind for event in run.events[1:]} == {"reversal"}


@pytest.mark.parametrize("between", [(0.0, 1.0), (1.0, 0.5), (1e-3, math.inf), (-1.0, 1.0)])
def test_a_range_that_cannot_be_searched_is_refused(between: tuple[float, float]) -> None:
    """It must rise and lie above 0; the message repeats it."""
    with pytest.raises(ValueError, match=r"between = \(.*it must rise and be > 0"):
        cycle_ranges(_with({"tau_s": 0.1}), between)


def test_ranges_are_those_of_one_block_whose_friction_grows() -> None:
    """Arrays and constant coefficients are told that they are none."""
    for p in (_with({"tau_s": 0.1}, v=[0.1, 0.2]), Parameters()):
        with pytest.raises(ValueError, match="takes numbers and a static friction that grows"):
            cycle_ranges(p, (1e-3, 1.0))


@pytest.mark.parametrize(
    ("own", "message"),
    [
        ({"tau_s": -1.0}, r"tau_s = -1.0 s is out of range; it must be finite and >= 0 s"),
        ({"B": -1.0}, r"B = -1.0 is out of range; it must be finite and >= 0"),
        ({"t_0": 0.0}, r"t_0 = 0.0 s is out of range; it must be finite and > 0 s"),
        ({"age_start": -1.0}, r"age_start = -1.0 s is out of range"),
    ],
)
def test_a_value_out_of_range_is_refused(own: Mapping[str, float], message: str) -> None:
    """Name, value, unit and range."""
    with pytest.raises(ValueError, match=message):
        simulate(Parameters(), 1.0, own=own)


def test_the_age_of_the_first_stick_does_not_change_in_a_run() -> None:
    """It is not tunable."""
    with pytest.raises(ValueError, match=r"age_start = 1.0 at 0.5 s cannot change during a run"):
        simulate(Parameters(), 1.0, changes=[Change(0.5, {}, {"age_start": 1.0})])
