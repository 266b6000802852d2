"""The curves: flat where it sticks, with corners at the events at every zoom, and their meaning."""

import math
from itertools import pairwise

import pytest

from stickslip_ref import steady_cycle
from tests.page import drawing
from tests.page.drawing import PIXEL, Kind, lines, value_at
from tests.page.settings import PRESETS, START, parameters
from tests.page.window import Window

MASS, FORCE = "#x-chart .curve.mass", "#F-chart .curve.force"


def check_curves(window: Window) -> set[Kind]:
    """Hold what is drawn against the page's events: sticks, corners and bands, on both charts."""
    axis, seen = drawing.time_axis(window), drawing.phases(window)
    assert drawing.time_axis(window, "F-chart") == axis
    for selector in (MASS, FORCE):
        path = drawing.curve(window, selector)
        for kind, start, end in seen:
            left, right = axis.place(start), axis.place(end)
            if right - left < 4 * PIXEL:
                continue
            within = [
                each
                for each in path
                if left - PIXEL <= each.start[0] and each.end[0] <= right + PIXEL
            ]
            pieces = [each for each in within if each.is_line is (kind == "stick")]
            # From corner to corner: a stick is one line, a slip is curves alone.
            assert abs(pieces[0].start[0] - left) <= PIXEL
            assert abs(pieces[-1].end[0] - right) <= PIXEL
            assert all(a.end == b.start for a, b in pairwise(pieces))
            if kind == "stick":
                assert len(pieces) == 1
                rise = pieces[0].start[1] - pieces[0].end[1]
                assert rise == 0.0 if selector == MASS else rise >= 0.0
    for chart in ("x-chart", "F-chart"):
        for kind in ("stick", "slip"):
            found = [x for band in drawing.bands(window, chart, kind) for x in band]
            edges = [axis.place(t) for each in seen if each[0] == kind for t in each[1:]]
            assert found == pytest.approx(edges, abs=PIXEL)
    return {kind for kind, *_ in seen}


def test_sticks_are_flat_and_corners_sharp_in_every_preset(window: Window) -> None:
    for name in PRESETS:
        window.preset(name)
        assert check_curves(window) == {"stick", "slip"}


def test_a_corner_stays_a_corner_from_seconds_to_microseconds(window: Window) -> None:
    window.look(0.0, 10.0)
    events = window.js("stickslip.events(4, 6)")
    for kind in ("break-away", "re-stick"):
        t = next(each["t"] for each in events if each["kind"] == kind)
        for power in range(2, 22, 3):
            span = 10.0 * 2.0**-power
            window.look(t - 0.37 * span, t + 0.63 * span)
            check_curves(window)
            assert t in [end for *_, end in drawing.phases(window)]


def test_the_dashed_line_is_the_break_away_force_and_the_grey_one_the_pulled_end(
    window: Window,
) -> None:
    window.look(0.0, 10.0)
    _, level = drawing.start_of(window, "#F-chart .threshold")
    F_s, slack = value_at(window, "F-chart", "y", level)
    assert F_s == pytest.approx(4.905, abs=slack)
    assert all(abs(each.end[1] - level) <= PIXEL for each in lines(window, FORCE)[:-1])
    (pulled,) = drawing.curve(window, "#x-chart .curve.pull")
    for (_, y), x in zip(pulled.points, (0.0, 0.2), strict=True):
        found, slack = value_at(window, "x-chart", "y", y)
        assert found == pytest.approx(x, abs=slack)


def test_the_portrait_is_one_closed_loop_around_steady_sliding(window: Window) -> None:
    *slip, stick = drawing.curve(window, "#phase-chart .curve.mass")
    assert stick.is_line
    assert not any(each.is_line for each in slip)
    assert stick.end == slip[0].start
    assert stick.start[1] == stick.end[1]
    peak, slack = value_at(window, "phase-chart", "y", min(each.end[1] for each in slip))
    exact = float(steady_cycle(parameters(START)).x_dot_peak)
    # Points stand every 0.4 rad, so the highest lies at most 0.2 rad from the top.
    assert exact * math.cos(0.2) - slack <= peak <= exact + slack
    for values in ({}, {"c": 20.0}, {"c": 20.0, "v": 0.3}):
        window.set(**values)
        p = parameters(window.setting)
        left, top = drawing.start_of(window, "#phase-chart .centre")
        # There the spring holds friction and damping.
        z = (float(p.mu_k_used * p.N) + p.c * p.v) / p.k
        for found, expected in (
            (value_at(window, "phase-chart", "x", left + 5.0), z),
            (value_at(window, "phase-chart", "y", top), p.v),
        ):
            assert found[0] == pytest.approx(float(expected), abs=found[1])
