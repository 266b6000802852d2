"""What is drawn."""

import math
from pathlib import Path

import numpy as np
import pytest

from stickslip.errors import CommandError
from stickslip.show.curve import curve, stick_phases
from stickslip.show.plot import figure, write_plot
from stickslip.show.scales import FORCES, LENGTHS, scale_for
from stickslip.simulate.run import Run, sample_times
from stickslip_verification import events_between

from .motion_in_closed_form import ClosedForm

MOTION = ClosedForm()


def test_a_stick_is_drawn_flat_to_the_last_bit() -> None:
    run = MOTION.run(sample_times(0.0, 2.0, 0.01))
    drawn = curve(run)
    phases = stick_phases(run)
    assert len(phases) == 7
    for begin, end in phases:
        inside = (drawn.t >= begin) & (drawn.t <= end)
        assert len(np.unique(drawn.x[inside])) == 1


def test_the_corners_are_drawn() -> None:
    run = MOTION.run(sample_times(0.0, 2.0, 0.01))
    drawn = curve(run)
    for event in run.events:
        at = np.flatnonzero(drawn.t == event.time)
        assert len(at) > 0
        expected = run.parameters["k"] * event.z
        # k (x_pull - x), each of the two rounded at 0.04 m.
        assert drawn.F[at] == pytest.approx(expected, abs=1000.0 * 4.0 * math.ulp(0.04))


def test_a_slip_is_drawn_smoothly() -> None:
    run = MOTION.run(sample_times(0.0, 2.0, 0.01))
    drawn = curve(run)
    exact = MOTION.samples(drawn.t)
    # Hermite's cubic errs by h^4/384 of the fourth derivative, w^4 times an amplitude of at most
    # the jump: (0.01 s x 31.6 rad/s)^4 / 384 = 2.6e-5 of it.
    assert np.max(np.abs(drawn.x - exact["x"])) < 3e-5 * 0.0063


def test_the_overshoot_is_explained_where_it_is_seen() -> None:
    page = figure(MOTION.run(sample_times(0.0, 2.0, 0.01)))
    notes = [text.get_text() for text in page.axes[1].texts]
    assert any("0.099 N" in note and "pulled end still moves" in note for note in notes)


def test_what_the_samples_do_not_show_is_not_drawn() -> None:
    times = sample_times(0.0, 10.0, 0.5)
    samples = MOTION.samples(times)
    events, hidden = events_between(samples, 0.02)
    run = Run("fmu", MOTION.parameters, samples, events, hidden)
    assert hidden > 0
    upper, lower = figure(run).axes
    assert "points only, choose a shorter interval" in upper.get_title(loc="right")
    assert not upper.patches
    assert not lower.patches
    assert not upper.collections
    pulled_end, mass = upper.lines
    force = lower.lines[0]
    for line, output, size in ((pulled_end, "x_pull", 1e-3), (mass, "x", 1e-3), (force, "F", 1.0)):
        assert line.get_linestyle() == "None"
        assert np.array_equal(np.asarray(line.get_ydata()), samples[output] / size)


@pytest.mark.parametrize(
    ("suffix", "start"), [(".png", b"\x89PNG"), (".svg", b"<?xml"), (".pdf", b"%PDF")]
)
def test_the_suffix_says_the_format(tmp_path: Path, suffix: str, start: bytes) -> None:
    run = MOTION.run(sample_times(0.0, 1.0, 0.01))
    first, second = tmp_path / f"a{suffix}", tmp_path / f"b{suffix}"
    write_plot(run, first, "--plot")
    write_plot(run, second, "--plot")
    assert first.read_bytes().startswith(start)
    assert first.read_bytes() == second.read_bytes()
    assert sorted(tmp_path.iterdir()) == [first, second]


def test_an_unknown_format_is_refused(tmp_path: Path) -> None:
    with pytest.raises(CommandError, match=r"unknown format '\.xyz'; expected \.png"):
        write_plot(MOTION.run(sample_times(0.0, 1.0, 0.1)), tmp_path / "a.xyz", "--plot")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("value", "unit"), [(0.0, "m"), (3.0, "m"), (-0.2, "mm"), (5e-6, "µm"), (1e-12, "nm")]
)
def test_a_length_is_shown_in_a_unit_a_person_reads(value: float, unit: str) -> None:
    assert scale_for(value, LENGTHS).symbol == unit
    assert scale_for(4905.0, FORCES).symbol == "kN"
