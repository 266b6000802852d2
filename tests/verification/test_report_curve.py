"""What is drawn of a motion: corners stay corners, a stick stays flat, nothing is made up."""

import re
from functools import cache

import numpy as np
import pytest

from stickslip_verification.model.verdict import Motion, Run
from stickslip_verification.report.plots import curve, draw_case

from .records import exact_of, named, planted, value, without


@cache
def motion(case: str) -> Motion:
    exact, of = exact_of(case), named(case)
    return Motion(case, of.title, of.about, exact.record, exact.events, {"fmu": exact.record})


def test_the_line_goes_through_every_sample_and_event_and_a_stick_is_flat() -> None:
    moved = motion("heavy")
    drawn, events = curve(moved), [each.time for each in moved.events]
    assert drawn.joined
    assert {*moved.exact.times, *events} <= set(drawn.t)
    at = np.searchsorted(drawn.t, moved.exact.times)
    assert np.array_equal(drawn.x[at], moved.exact.outputs["x"])
    for re_stick, break_away in zip(events[1::2], events[2::2], strict=False):
        inside = (drawn.t >= re_stick) & (drawn.t <= break_away)
        assert inside.sum() >= 2
        assert np.ptp(drawn.x[inside]) == 0.0


@pytest.mark.parametrize("case", ["heavy", "reversals"])
def test_between_the_samples_the_line_is_the_motion(case: str) -> None:
    moved = motion(case)
    half = {name: samples[1::2] for name, samples in moved.exact.outputs.items()}
    record = Run(moved.exact.times[1::2], half, moved.exact.initial)
    drawn = curve(Motion(case, "", "", record, moved.events, {}))
    assert drawn.joined
    x = np.interp(moved.exact.times, drawn.t, drawn.x)
    # A line may err by 1.5 % of what is seen; straight pieces of a 400th of the width add less.
    assert np.max(np.abs(x - moved.exact.outputs["x"])) < 0.016 * np.ptp(drawn.x)


@pytest.mark.parametrize("case", ["one-step", "fast-pull"])
def test_samples_between_which_whole_slips_lie_are_not_joined(case: str) -> None:
    drawn = curve(motion(case))
    assert not drawn.joined


def test_a_picture_is_the_same_each_time_and_small() -> None:
    drawn = draw_case(motion("default"), {"fmu": 1e-12, "reference": 1e-7})
    assert drawn == draw_case(motion("default"), {"fmu": 1e-12, "reference": 1e-7})
    assert len(drawn) < 120_000
    assert not re.search("<metadata|http", drawn)
    # Two pictures in one page share no id.
    other = draw_case(motion("heavy"), {})
    assert not {*re.findall(r'\bid="[^"]+"', drawn)} & {*re.findall(r'\bid="[^"]+"', other)}


def test_a_side_that_went_astray_is_still_drawn() -> None:
    moved = motion("heavy")
    astray = planted(moved.exact, value("x", np.nan, 0), value("x", -1e308, 1), without("F"))
    short = Run(moved.exact.times[:9], astray.outputs, astray.initial)
    silent = Run(moved.exact.times[:0], {"x": np.array([])}, {})
    sides = {"fmu": short, "reference": silent}
    drawn = draw_case(Motion("heavy", "", "", moved.exact, moved.events, sides), {})
    assert drawn.startswith("<svg")
    assert "nan" not in drawn.lower().replace("name", "")
