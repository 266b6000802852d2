"""Samples of a run, the events between them, and what is drawn of both."""

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import stickslip_ref
from stickslip.errors import CommandError
from stickslip.parameters import Parameters
from stickslip.runs import Experiment, Run, fitting_interval, sample_times, simulate_reference
from stickslip.show.plot import curve, figure, stick_phases, write_plot
from stickslip_units import scale_for
from stickslip_verification import events_between


def run(interval: float = 0.01, stop_time: float = 2.0) -> Run:
    return simulate_reference(Experiment(Parameters(), 0.0, stop_time, interval))


@pytest.mark.parametrize("interval", [0.001, 0.01, 0.05, 0.13, 0.3, 0.31])
def test_events_are_dated_and_placed_from_samples_with_up_to_two_in_a_step(interval: float) -> None:
    motion = run(interval, 10.0)
    found, hidden = events_between(motion.samples, 0.02)
    assert hidden == 0
    assert [(e.kind, e.mode) for e in found] == [(e.kind, e.mode) for e in motion.events]
    for event, exact in zip(found, motion.events, strict=True):
        place = (exact.time, exact.x, exact.z)
        # Rounding of sums of times of 10 s.
        assert (event.time, event.x, event.z) == pytest.approx(place, abs=8.0 * math.ulp(10.0))


@pytest.mark.parametrize("interval", [0.33, 0.4, 0.5, 0.7])
def test_hidden_events_are_counted_and_none_is_placed_from_them(interval: float) -> None:
    motion = run(interval, 10.0)
    found, hidden = events_between(motion.samples, 0.02)
    assert hidden > 0
    assert len(found) < len(motion.events)
    for event in found:
        exact = min(motion.events, key=lambda other: abs(other.time - event.time))
        assert event.kind == exact.kind
        assert (event.time, event.x) == pytest.approx((exact.time, exact.x), abs=1e-14)


def test_sample_times_are_whole_intervals_and_the_stop() -> None:
    assert sample_times(1.0, 2.0, 0.4).tolist() == [1.0, 1.4, 1.8, 2.0]
    assert sample_times(0.0, 0.3, 0.1).tolist() == [0.0, 0.1, 0.2, 0.3]
    assert sample_times(0.0, 1.0, 5.0).tolist() == [0.0, 1.0]


@given(st.floats(-1e3, 1e3), st.floats(1e-3, 1e3), st.integers(1, 3000))
def test_sample_times_rise(start: float, duration: float, count: int) -> None:
    times = sample_times(start, start + duration, duration / count)
    assert (times[0], times[-1]) == (start, start + duration)
    assert np.all(np.diff(times) > 0.0)
    assert count <= len(times) <= count + 2


@given(st.floats(1e-6, 1e9))
def test_a_fitting_interval_gives_at_most_a_thousand_steps(duration: float) -> None:
    interval = fitting_interval(duration, 0.01)
    assert duration / interval <= 1000.0
    assert interval == 0.01 or duration / interval > 500.0


def test_a_stick_is_drawn_flat_corners_sharp_and_a_slip_smooth() -> None:
    motion = run()
    drawn = curve(motion)
    phases = stick_phases(motion)
    assert len(phases) == 7
    for begin, end in phases:
        inside = (drawn.t >= begin) & (drawn.t <= end)
        assert len(np.unique(drawn.x[inside])) == 1
    for event in motion.events:
        at = np.flatnonzero(drawn.t == event.time)
        assert len(at) > 0
        # k (x_pull - x), each of the two rounded at 0.04 m.
        assert drawn.F[at] == pytest.approx(1000.0 * event.z, abs=1000.0 * 4.0 * math.ulp(0.04))
    times, first = np.unique(drawn.t, return_index=True)
    exact = stickslip_ref.simulate(stickslip_ref.Parameters(), 2.0, times=times)
    # Hermite's cubic errs by h^4/384 of the fourth derivative, w^4 times an amplitude of at most
    # the jump: (0.01 s x 31.6 rad/s)^4 / 384 = 2.6e-5 of it.
    assert np.max(np.abs(drawn.x[first] - exact.x)) < 3e-5 * 0.0063


def test_the_overshoot_is_explained_where_it_is_seen() -> None:
    notes = [text.get_text() for text in figure(run()).axes[1].texts]
    assert any("0.099 N" in note and "pulled end still moves" in note for note in notes)


def test_what_the_samples_do_not_show_is_not_drawn() -> None:
    motion = run(0.5, 10.0)
    events, hidden = events_between(motion.samples, 0.02)
    upper, lower = figure(dataclasses.replace(motion, events=events, hidden_events=hidden)).axes
    assert "points only, choose a shorter interval" in upper.get_title(loc="right")
    assert not any((upper.patches, lower.patches, upper.collections))
    pulled_end, mass = upper.lines
    force = lower.lines[0]
    for line, output, size in ((pulled_end, "x_pull", 1e-3), (mass, "x", 1e-3), (force, "F", 1.0)):
        assert line.get_linestyle() == "None"
        assert np.array_equal(np.asarray(line.get_ydata()), motion.samples[output] / size)


@pytest.mark.parametrize(
    ("suffix", "start"), [(".png", b"\x89PNG"), (".svg", b"<?xml"), (".pdf", b"%PDF")]
)
def test_the_suffix_says_the_format_and_a_run_gives_the_same_bytes(
    tmp_path: Path, suffix: str, start: bytes
) -> None:
    first, second = tmp_path / f"a{suffix}", tmp_path / f"b{suffix}"
    write_plot(run(stop_time=1.0), first, "--plot")
    write_plot(run(stop_time=1.0), second, "--plot")
    assert first.read_bytes().startswith(start)
    assert first.read_bytes() == second.read_bytes()
    with pytest.raises(CommandError, match=r"unknown format '\.xyz'; expected \.png"):
        write_plot(run(stop_time=1.0), tmp_path / "a.xyz", "--plot")
    assert sorted(tmp_path.iterdir()) == [first, second]


@pytest.mark.parametrize(
    ("value", "unit"), [(0.0, "m"), (3.0, "m"), (-0.2, "mm"), (5e-6, "µm"), (1e-12, "nm")]
)
def test_a_length_is_shown_in_the_largest_unit_that_it_fills(value: float, unit: str) -> None:
    assert scale_for(value, "m").symbol == unit
    assert scale_for(4905.0, "N").symbol == "kN"
