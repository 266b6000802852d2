"""The motion of an axis over time, before and after a cure."""

from dataclasses import replace

import numpy as np
import pytest

from stickslip_design.axis import Axis
from stickslip_design.critical import jumps_of
from stickslip_design.record import record

from .axes import RIGID, SERVO


@pytest.mark.parametrize(("axis", "feed"), [(SERVO, 5e-4), (RIGID, 3e-3)])
def test_a_motion_in_jumps_stays_one(axis: Axis, feed: float) -> None:
    """From rest to rest the table goes on by the steady jump."""
    jumps = jumps_of(axis, feed)
    assert jumps is not None
    jump = jumps.way
    found = record(axis, feed, 20.0 * jump / feed)
    place = found.ahead + feed * found.time
    rests = np.unique(np.round(place[1:][np.abs(np.diff(place)) < 1e-6 * jump], 12))
    ways = np.diff(rests)
    assert ways[ways > 0.1 * jump][-3:] == pytest.approx([jump] * 3, rel=0.01)


@pytest.mark.parametrize(("axis", "feed"), [(SERVO, 2e-3), (RIGID, 4e-3)])
def test_beyond_the_limit_the_motion_becomes_even(axis: Axis, feed: float) -> None:
    """The swing after the first slip dies away."""
    found = record(axis, feed, 0.6)
    first, last = (found.ahead[: len(found.ahead) // 6], found.ahead[-len(found.ahead) // 6 :])
    assert np.ptp(last) < 0.2 * np.ptp(first)


@pytest.mark.parametrize(("axis", "feed"), [(SERVO, 5e-4), (RIGID, 3e-3)])
@pytest.mark.parametrize("along", [-800.0, 800.0])
def test_a_force_along_the_way_changes_no_motion(axis: Axis, feed: float, along: float) -> None:
    """It moves the rest of the spring alone; to the rounding of the events."""
    level, tilted = record(axis, feed, 0.2), record(replace(axis, along=along), feed, 0.2)
    assert tilted.ahead == pytest.approx(level.ahead, abs=1e-10)


def test_a_motion_does_not_depend_on_how_finely_it_is_shown() -> None:
    """In steps of 1 ms, and of 40 ms with a stop and a break-away in each."""
    fine, coarse = record(SERVO, 5e-4, 0.6), record(SERVO, 5e-4, 40.0 * 0.6)
    shared = fine.ahead[::40]
    assert coarse.ahead[: len(shared)] == pytest.approx(shared, abs=1e-9)
