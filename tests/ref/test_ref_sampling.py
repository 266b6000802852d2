"""Samples: as many as asked for, and on the right side of what happens at their time."""

import math
from random import Random

import numpy as np
import pytest

from stickslip_ref import Change, Parameters, simulate

STATE = ("x", "x_dot", "z", "F", "F_friction", "F_s", "W_pull", "Q_friction")


def test_no_sample_is_lost_at_the_end_of_a_run_or_at_a_change() -> None:
    """Every sample time gets its sample, whatever the rounding of stops, changes and phases."""
    draw = Random(5)
    for _ in range(300):
        p = Parameters(c=100.0, v=draw.uniform(0.015, 0.08), z_start=draw.uniform(0.0, 0.0049))
        start, length = draw.choice([0.0, draw.uniform(0.0, 50.0)]), draw.uniform(0.01, 1.0)
        stop = start + length
        changes = [
            Change(draw.uniform(start, stop), {"v": draw.uniform(0.01, 0.05)}) for _ in range(2)
        ]
        times = np.sort([*np.linspace(start, stop, 20), *(each.time for each in changes)])
        run = simulate(
            p, stop, start_time=start, times=times, changes=changes, rtol=1e-6, max_events=100
        )
        assert len(run.x) == len(times) == len(run.T), (p, start, stop)


def test_a_sample_at_the_stop_of_a_slip_without_end_is_there() -> None:
    """Where begin and length of the last arc add up to less than the stop time, as here."""
    times = np.linspace(0.0, 0.965, 98)
    assert len(simulate(Parameters(c=100.0, v=0.0157), 0.965, times=times).x) == 98


def test_a_sample_at_any_change_shows_the_state_before_it() -> None:
    """At the time of a change the run is, bit for bit, the one that stops there unchanged."""
    draw = Random(6)
    for _ in range(150):
        p = Parameters(v=draw.uniform(0.015, 0.08), c=draw.choice([0.0, 100.0]))
        time = draw.uniform(0.01, 0.6)
        change = Change(time, {"load": 30.0, "F_ext": -3.0, "k": 1500.0})
        changed = simulate(p, 0.7, times=[time], changes=[change], rtol=1e-6)
        plain = simulate(p, time, times=[time], rtol=1e-6)
        for name in STATE:
            np.testing.assert_array_equal(getattr(changed, name), getattr(plain, name))
        assert changed.W_k[0] == 0.0


@pytest.mark.parametrize("values", [{}, {"v": -0.02}, {"mu_s": 0.0, "mu_k": 0.0}])
def test_no_force_is_not_a_negative_one(values: dict[str, float]) -> None:
    """A relaxed block starts with forces of 0.0, which print without a sign."""
    run = simulate(Parameters(**values), 0.1, times=[0.0])
    for name in STATE:
        first = getattr(run, name)[0]
        assert first != 0.0 or math.copysign(1.0, first) == 1.0, name


def test_a_sample_at_a_break_away_still_shows_stick() -> None:
    """Stick ends when time passes its end: at the start without friction, and at a load-up."""
    frictionless = simulate(Parameters(mu_s=0.0, mu_k=0.0), 1.0, times=[0.0, 0.5])
    assert list(frictionless.mode) == [0, 1]
    # k v / F_s is a power of two here, so the break-away falls on a double.
    p = Parameters(m=1.0, g=8.0, mu_s=0.5, k=1024.0, v=2.0**-8)
    loaded = simulate(p, 2.0, times=[1.0, 1.0 + 1e-9])
    assert loaded.events[0].time == 1.0
    assert list(loaded.mode) == [0, 1]
