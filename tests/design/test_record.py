"""The motion of an axis over time, before and after a cure."""

from dataclasses import replace

import numpy as np
import pytest

from stickslip_design.axis import Axis
from stickslip_design.loop.critical import jumps_of, record
from tests.design.axes import RIGID, SERVO


@pytest.mark.parametrize(("axis", "feed"), [(SERVO, 5e-4), (RIGID, 3e-3)])
def test_below_the_limit_the_table_goes_on_by_the_steady_jump(axis: Axis, feed: float) -> None:
    jumps = jumps_of(axis, feed)
    assert jumps is not None
    motion = record(axis, feed, 20.0 * jumps.way / feed)
    place = motion.ahead + feed * motion.time
    rests = np.unique(np.round(place[1:][np.abs(np.diff(place)) < 1e-6 * jumps.way], 12))
    ways = np.diff(rests)
    # A rest begins between two of the points that are shown.
    assert ways[ways > 0.1 * jumps.way][-3:] == pytest.approx([jumps.way] * 3, rel=0.01)


@pytest.mark.parametrize(("axis", "feed"), [(SERVO, 2e-3), (RIGID, 4e-3)])
def test_beyond_the_limit_the_swing_dies_away(axis: Axis, feed: float) -> None:
    ahead = record(axis, feed, 0.6).ahead
    sixth = len(ahead) // 6
    assert np.ptp(ahead[-sixth:]) < 0.2 * np.ptp(ahead[:sixth])


@pytest.mark.parametrize(("axis", "feed"), [(SERVO, 5e-4), (RIGID, 3e-3)])
def test_a_force_along_the_way_changes_no_motion(axis: Axis, feed: float) -> None:
    level, tilted = record(axis, feed, 0.2), record(replace(axis, along=-800.0), feed, 0.2)
    # It moves the rest of the spring alone; to the rounding of the events.
    assert tilted.ahead == pytest.approx(level.ahead, abs=1e-10)


@pytest.mark.gate
def test_a_motion_does_not_depend_on_how_finely_it_is_shown() -> None:
    fine, coarse = record(SERVO, 5e-4, 0.3), record(SERVO, 5e-4, 10.0 * 0.3)
    same_times = fine.ahead[::10]
    # Events of a loop of samples, located to rounding each.
    assert coarse.ahead[: len(same_times)] == pytest.approx(same_times, abs=1e-9)
