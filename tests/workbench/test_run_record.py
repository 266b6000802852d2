"""Samples of a run and the events between them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stickslip.simulate.run import fitting_interval, sample_times
from stickslip_verification import events_between

from .motion_in_closed_form import ClosedForm

MOTION = ClosedForm()


def rounding(time: float) -> float:
    """Return what a time found as a sum of three of its size may differ by."""
    return 8.0 * math.ulp(time)


@pytest.mark.parametrize("interval", [0.001, 0.01, 0.05, 0.13, 0.3, 0.31])
def test_events_between_samples_are_exact(interval: float) -> None:
    run = MOTION.run(sample_times(0.0, 10.0, interval))
    found, hidden = events_between(run.samples, 0.02)
    assert hidden == 0
    assert [(event.kind, event.mode) for event in found] == [
        (event.kind, event.mode) for event in run.events
    ]
    for event, exact in zip(found, run.events, strict=True):
        assert event.time == pytest.approx(exact.time, abs=rounding(10.0))
        assert event.x == pytest.approx(exact.x, abs=rounding(0.2))
        assert event.z == pytest.approx(exact.z, abs=rounding(0.2))


def test_intervals_with_more_than_two_events_are_counted() -> None:
    run = MOTION.run(sample_times(0.0, 10.0, 0.5))
    found, hidden = events_between(run.samples, 0.02)
    assert hidden > 0
    assert len(found) < len(run.events)


@pytest.mark.parametrize("interval", [0.33, 0.4, 0.5, 0.7])
def test_an_event_beside_a_hidden_one_is_placed_exactly_or_not_at_all(interval: float) -> None:
    run = MOTION.run(sample_times(0.0, 10.0, interval))
    found, _ = events_between(run.samples, 0.02)
    for event in found:
        exact = min(run.events, key=lambda other: abs(other.time - event.time))
        assert event.kind == exact.kind
        assert event.time == pytest.approx(exact.time, abs=rounding(10.0))
        assert event.x == pytest.approx(exact.x, abs=rounding(0.2))


def test_sample_times_are_whole_intervals_and_the_stop() -> None:
    assert sample_times(1.0, 2.0, 0.4).tolist() == [1.0, 1.4, 1.8, 2.0]
    assert sample_times(0.0, 0.3, 0.1).tolist() == [0.0, 0.1, 0.2, 0.3]
    assert sample_times(0.0, 1.0, 5.0).tolist() == [0.0, 1.0]


@given(st.floats(-1e3, 1e3), st.floats(1e-3, 1e3), st.integers(1, 3000))
def test_sample_times_rise(start: float, duration: float, count: int) -> None:
    times = sample_times(start, start + duration, duration / count)
    assert times[0] == start
    assert times[-1] == start + duration
    assert np.all(np.diff(times) > 0.0)
    assert count <= len(times) <= count + 2


@given(st.floats(1e-6, 1e9))
def test_a_fitting_interval_gives_at_most_a_thousand_steps(duration: float) -> None:
    interval = fitting_interval(duration, 0.01)
    assert duration / interval <= 1000.0
    assert interval == 0.01 or duration / interval > 500.0
