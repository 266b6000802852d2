"""What is drawn of a motion: corners stay corners, a stick stays flat, nothing is made up."""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from stickslip_verification.drive.exact import exact_motion
from stickslip_verification.model.verdict import Motion
from stickslip_verification.report.curve import curve
from stickslip_verification.report.plots import draw_case
from stickslip_verification.report.svg import thinned, tidy
from stickslip_verification.report.svg.line import SHAPE
from stickslip_verification.suite.cases import load_cases


@cache
def motion(case: str) -> Motion:
    """Return the exact motion of a case, beside itself as the FMU."""
    chosen = load_cases(case)[0]
    exact = exact_motion(chosen)
    return Motion(
        case, chosen.title, chosen.about, exact.record, exact.event_times, {"fmu": exact.record}
    )


def test_the_line_goes_through_every_sample_and_event() -> None:
    """All samples are on the line, and every event has its corner at the exact time."""
    moved = motion("heavy")
    drawn = curve(moved)
    assert drawn.joined
    assert set(moved.exact.times) <= set(drawn.t)
    assert set(moved.event_times) <= set(drawn.t)
    at = np.searchsorted(drawn.t, moved.exact.times)
    assert np.array_equal(drawn.x[at], moved.exact.outputs["x"])


def test_a_stick_is_drawn_flat_from_its_first_to_its_last_moment() -> None:
    """Between re-stick and break-away the drawn mass has one single position."""
    moved = motion("heavy")
    drawn = curve(moved)
    events = list(moved.event_times)
    for re_stick, break_away in zip(events[1::2], events[2::2], strict=False):
        inside = (drawn.t >= re_stick) & (drawn.t <= break_away)
        assert inside.sum() >= 2
        assert np.ptp(drawn.x[inside]) == 0.0


@pytest.mark.parametrize("case", ["heavy", "reversals", "clamp"])
def test_between_the_samples_the_line_is_the_motion(case: str) -> None:
    """Drawn from every second sample, the line meets the ones left out within a line's width."""
    moved = motion(case)
    half = {name: samples[1::2] for name, samples in moved.exact.outputs.items()}
    record = type(moved.exact)(moved.exact.times[1::2], half, moved.exact.initial)
    drawn = curve(Motion(case, "", "", record, moved.event_times, {}))
    assert drawn.joined
    x = np.interp(moved.exact.times, drawn.t, drawn.x)
    # A line may err by 1.5 % of what is seen; straight pieces of a 400th of the width add less.
    assert np.max(np.abs(x - moved.exact.outputs["x"])) < 0.016 * np.ptp(drawn.x)


@pytest.mark.parametrize("case", ["one-step", "fast-pull", "grazing"])
def test_samples_that_do_not_tell_the_motion_are_not_joined(case: str) -> None:
    """Where whole slips lie between two samples, only the samples are drawn."""
    drawn = curve(motion(case))
    assert not drawn.joined
    assert len(drawn.t) == len(motion(case).exact.times) + 1


def test_thinning_changes_no_shape() -> None:
    """Every point left out lies within a tenth of a point of the line that stays."""
    x = np.linspace(0.0, 400.0, 4001)
    y = np.where(x % 80.0 < 60.0, 10.0 * np.floor(x / 80.0), 50.0 + 40.0 * np.sin(x / 3.0))
    kept = thinned(x, y)
    kept_x, kept_y = x[kept], y[kept]
    assert len(kept_x) < 0.4 * len(x)
    steep = np.abs(np.gradient(y, x))
    assert np.max(np.abs(np.interp(x, kept_x, kept_y) - y) / np.hypot(1.0, steep)) < 1.5 * SHAPE


def test_thinning_keeps_gaps() -> None:
    """A line with a gap stays a line with a gap."""
    y = np.array([0.0, 0.0, 0.0, np.nan, 0.0, 0.0, 0.0])
    assert list(thinned(np.arange(7.0), y)) == [0, 2, 3, 4, 6]


def test_thinning_keeps_the_extremes() -> None:
    """The largest and the least error of a line of noise stay in the picture."""
    x = np.linspace(0.0, 10.0, 5000, endpoint=False)
    y = np.random.default_rng(1).normal(size=5000)
    kept = thinned(x, y)
    for column in range(10):
        inside, left = np.floor(x) == column, np.floor(x[kept]) == column
        assert y[kept][left].max() == pytest.approx(y[inside].max(), abs=SHAPE)
        assert y[kept][left].min() == pytest.approx(y[inside].min(), abs=SHAPE)


def test_every_reference_in_a_picture_is_to_an_id_of_its_own() -> None:
    """No id of one plot is that of another, and nothing points at an id that is not there."""
    seen: set[str] = set()
    for case in ("heavy", "default"):
        drawn = draw_case(motion(case), {"fmu": 1e-12})
        ids = set(re.findall(r'\bid="([^"]+)"', drawn))
        targets = set(re.findall(r'href="#([^"]+)"|url\(#([^)]+)\)', drawn))
        assert {a or b for a, b in targets} == ids
        assert not ids & seen
        seen |= ids


def test_a_picture_says_the_same_each_time() -> None:
    """The same motion gives the same bytes, without a date, and small ones."""
    drawn = draw_case(motion("default"), {"fmu": 1e-12})
    assert drawn == draw_case(motion("default"), {"fmu": 1e-12})
    assert len(drawn) < 120_000
    assert "<metadata" not in drawn
    assert "http" not in drawn


@pytest.mark.parametrize(
    ("reference", "names"),
    [(1e-7, {"tolerance, FMU", "tolerance, reference"}), (1e-12, {"tolerance, both"})],
)
def test_tolerances_that_lie_together_share_a_name(reference: float, names: set[str]) -> None:
    """A foreign FMU has the tolerances of the reference: two names would lie on one another."""
    moved = replace(motion("default"), records={"fmu": motion("default").exact})
    drawn = draw_case(moved, {"fmu": 1e-12, "reference": reference})
    assert set(re.findall("tolerance, [A-Za-z]+", drawn)) == names


def test_a_side_that_went_astray_is_still_drawn() -> None:
    """NaN, infinity, a wrong number of samples and a missing output stop no picture."""
    moved = motion("heavy")
    broken = {name: np.array(samples) for name, samples in moved.exact.outputs.items()}
    broken["x"][3], broken["x"][4], broken["x"][5] = np.nan, np.inf, -1e308
    del broken["F"]
    astray = type(moved.exact)(moved.exact.times[:9], broken, moved.exact.initial)
    silent = type(moved.exact)(moved.exact.times[:0], {"x": np.array([])}, {})
    sides = {"fmu": astray, "reference": silent}
    drawn = draw_case(Motion("heavy", "", "", moved.exact, moved.event_times, sides), {})
    assert drawn.startswith("<svg")
    assert "nan" not in drawn.lower().replace("name", "")


def test_markers_become_one_path_that_draws_the_same() -> None:
    """Markers that a picture refers to one by one are drawn where they were, and as large."""
    svg = (
        '<svg viewBox="0 0 9 9"><defs><path id="m" d="M -1 0L1 0M 0 2L0 -2" style="stroke: red"/>'
        '</defs><g clip-path="url(#c)"><use href="#m" x="3" y="4" style="fill: blue"/>\n'
        '<use href="#m" x="5" y="6" style="fill: blue"/></g></svg>'
    )
    drawn = tidy(svg, "p", "a <title>")
    assert 'd="M3 4m-1 0l2 0m-1 2l0 -4M5 6m-1 0l2 0m-1 2l0 -4"' in drawn
    assert 'style="fill: blue; stroke: red"' in drawn
    assert 'aria-label="a &lt;title&gt;"' in drawn
    assert "<use" not in drawn


def test_rounding_leaves_factors_alone() -> None:
    """Lengths lose the digits that nobody sees; a factor and a text keep theirs."""
    svg = '<svg viewBox="0 0 9 9"><g transform="translate(1.23456 2) scale(0.015625)"></g>'
    drawn = tidy(svg + "<text>0.12345</text></svg>", "p", "title")
    assert "translate(1.23 2) scale(0.015625)" in drawn
    assert "<text>0.12345</text>" in drawn
