"""The reference's simulation: no cycle missed, samples and events in their places, refusals."""

from __future__ import annotations

import math
import warnings
from random import Random

import numpy as np
import pytest
from scipy.linalg import expm

from stickslip_ref import (
    RTOL,
    Change,
    Coulomb,
    FrictionClampWarning,
    Parameters,
    State,
    simulate,
    steady_cycle,
)

INTEGRATION = 3e-13
"""Relative error of an integrated slip: 50 steps of rtol 3e-14, with room for another SciPy."""


def test_samples_are_where_they_are_asked_for() -> None:
    times = [0.0, 0.1, 0.3, 0.3, 0.36, 1.0]
    run, fine = simulate(Parameters(), 1.0, times=times), simulate(Parameters(), 1.0)
    np.testing.assert_array_equal(run.t, times)
    # Linear interpolation on 32 intervals of a slip: (w h)^2 / 8 of the jump, h = 3.7 ms.
    np.testing.assert_allclose(run.x, np.interp(times, fine.t, fine.x), atol=2e-3 * 6.3e-3)
    assert np.all(np.diff(fine.t) > 0.0)
    assert {event.time for event in fine.events} <= set(fine.t)
    assert all(fine.x_dot[fine.sticking] == 0.0)


def test_no_sample_is_lost_at_the_end_of_a_run_or_at_a_change() -> None:
    draw = Random(5)
    for _ in range(60):
        p = Parameters(c=100.0, v=draw.uniform(0.015, 0.08), z_start=draw.uniform(0.0, 0.0049))
        start = draw.choice([0.0, draw.uniform(0.0, 50.0)])
        stop = start + draw.uniform(0.01, 1.0)
        changes = [
            Change(draw.uniform(start, stop), {"v": draw.uniform(0.01, 0.05)}) for _ in range(2)
        ]
        times = np.sort([*np.linspace(start, stop, 20), *(each.time for each in changes)])
        run = simulate(p, stop, start_time=start, times=times, changes=changes, rtol=1e-6)
        assert len(run.x) == len(times) == len(run.T), (p, start, stop)
    # Begin and length of the last arc add up to less than the stop time here.
    times = np.linspace(0.0, 0.965, 98)
    assert len(simulate(Parameters(c=100.0, v=0.0157), 0.965, times=times).x) == 98


def test_a_sample_at_a_change_shows_the_state_before_it() -> None:
    draw = Random(6)
    for _ in range(30):
        p = Parameters(v=draw.uniform(0.015, 0.08), c=draw.choice([0.0, 100.0]))
        time = draw.uniform(0.01, 0.6)
        change = Change(time, {"load": 30.0, "F_ext": -3.0, "k": 1500.0})
        changed = simulate(p, 0.7, times=[time], changes=[change], rtol=1e-6)
        plain = simulate(p, time, times=[time], rtol=1e-6)
        for name in ("x", "x_dot", "z", "F", "F_friction", "F_s", "W_pull", "W_k", "Q_friction"):
            np.testing.assert_array_equal(getattr(changed, name), getattr(plain, name))


def test_changes_at_one_time_act_as_their_last_at_the_start_as_a_start_at_the_end_not() -> None:
    for time in (0.0, 0.1):
        pulse = [Change(time, {"F_ext": 20.0, "k": 2e3}), Change(time, {"F_ext": 0.0, "k": 1e3})]
        run = simulate(Parameters(z_start=1e-3), 0.15, changes=pulse)
        assert (run.events, run.W_k[-1]) == ((), 0.0)
    a = simulate(Parameters(), 0.5, changes=[Change(0.0, {"k": 2000.0, "v": 0.03})])
    b = simulate(Parameters(k=2000.0, v=0.03), 0.5)
    late = simulate(Parameters(k=2000.0, v=0.03), 0.5, changes=[Change(0.5, {"v": 5.0, "k": 1.0})])
    for run in (a, late):
        np.testing.assert_array_equal(run.x, b.x)
        np.testing.assert_array_equal(run.W_k, 0.0)


def test_a_pull_taken_off_at_the_instant_of_break_away_moves_nothing() -> None:
    draw, broken = Random(8), 0
    for _ in range(40):
        cut = Change(draw.uniform(0.01, 0.24), {"v": draw.uniform(0.01, 0.05)})
        away = simulate(Parameters(), 1.0, changes=[cut], times=[], rtol=1e-6).events[0].time
        off = Change(away, {"F_ext": -3.0})
        run = simulate(Parameters(), away + 0.01, changes=[cut, off], rtol=1e-6)
        # Whether the break-away was counted before the change or not.
        assert [event.kind for event in run.events] in ([], ["break-away", "re-stick"])
        assert (run.x[-1], run.mode[-1]) == (0.0, 0)
        broken += bool(run.events)
    assert broken > 0


def test_a_stiff_slip_is_the_overdamped_solution_at_little_cost() -> None:
    class Counted(Coulomb):
        constant_in_slip = False
        calls = 0

        def slip_friction(self, p: Parameters, speed: float, state: State = ()) -> float:
            Counted.calls += 1
            return 0.3 * 9.81

    p = Parameters(c=200.0 * math.sqrt(1000.0), z_start=0.02, v=0.02)
    times = [0.001, 0.01, 0.1, 1.0, 3.0]
    run = simulate(p, 3.0, times=times, law=Counted())
    motion = np.array([[0.0, -1.0, 0.02], [1000.0, -float(p.c), -0.3 * 9.81], [0.0, 0.0, 0.0]])
    for t, x_dot in zip(times, run.x_dot, strict=True):
        exact = (expm(motion * t) @ [0.02, 0.0, 1.0])[1]
        # The implicit method's tolerance of 1e-11 a step, over some hundred steps.
        assert x_dot == pytest.approx(exact, rel=1e-9)
    # An explicit method needs a dozen for each 3 / (2 zeta w): 25,000.
    assert Counted.calls < 20_000


def test_a_large_constant_force_does_not_blur_a_small_gap() -> None:
    p = Parameters(mu_k=0.5 * (1.0 - 1e-3), F_ext=1e7, v=0.001, z_start=-1e4)
    run, exact = simulate(p, 6.0, times=[]), steady_cycle(p)
    assert run.cycles
    for name in ("t_slip", "x_dot_peak"):
        expected = float(getattr(exact, name))
        # Over a gap of 1e-3 and lambda of 0.3.
        assert getattr(run.cycles[0], name) == pytest.approx(expected, rel=INTEGRATION * 1e3)


def test_the_clamp_warns_where_the_friction_changes_and_once() -> None:
    changes = [Change(0.1, {"mu_k": 0.7}), Change(0.2, {"v": 0.03}), Change(0.3, {"load": 1.0})]
    with pytest.warns(FrictionClampWarning, match=r"mu_k = 0\.7 exceeds mu_s = 0\.5") as caught:
        simulate(Parameters(), 0.35, changes=changes)
    assert len(caught) == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"stop_time": -1.0}, "stop_time = -1.0 s is out of range"),
        ({"stop_time": math.nan}, "stop_time = nan s is out of range"),
        ({"rtol": 1e-17}, "rtol = 1e-17 is out of range"),
        ({"times": [0.5, 0.2]}, r"times\[1\] = 0.2 s is less"),
        ({"times": [0.5, 2.0]}, "must lie within the run, 0.0 to 1.0 s"),
        ({"p": Parameters(k=np.array([1.0, 2.0]))}, r"the fields broadcast to \(2,\)"),
        ({"changes": [Change(-0.1, {"v": 1.0})]}, "a change at -0.1 s lies before the start"),
        ({"own": {"slope": 1.0}}, "slope = 1.0 is no parameter of the friction law"),
    ],
)
def test_bad_runs_are_refused(arguments: dict[str, object], words: str) -> None:
    with warnings.catch_warnings(), pytest.raises(ValueError, match=words):
        simulate(**({"p": Parameters(), "stop_time": 1.0} | arguments))  # type: ignore[arg-type]  # wrong types are the point


@pytest.mark.parametrize(
    ("own", "setting", "rtol"),
    [
        ({}, {"c": 2.0, "v": 1e-6, "z_start": 0.004905001404, "x_dot_start": 7.8974e-7}, RTOL),
        ({"shape": 2, "v_s": 0.00169}, {"k": 197110.0, "mu_k": 0.3885, "v": 0.009657}, 1e-9),
    ],
)
def test_slow_pulls_and_coarse_tolerances_are_followed_to_their_end(
    own: dict[str, float], setting: dict[str, float], rtol: float
) -> None:
    run = simulate(Parameters(**setting), 1.0, law="stribeck", own=own, rtol=rtol, max_events=200)
    assert len(run.events) < 200


def test_too_many_events_end_the_run_with_their_number() -> None:
    with pytest.raises(RuntimeError, match=r"11 events by t = .* more than max_events = 10"):
        simulate(Parameters(), 10.0, max_events=10)
