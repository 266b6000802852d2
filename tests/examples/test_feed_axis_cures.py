"""Cures of the design tool, fed back to the drive and the block: jumping ends at the feed."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from examples.feed_axis.axis import Axis
from examples.feed_axis.designed import designed
from stickslip_design.levers import END, cures
from tests.examples.in_process import couple

FEED = 1.2e-3
FIELDS = {"mu_s": "mu_s", "stiffness": "k", "c": "c", "mass": "m", "K_v": "K_v"}
"""Numbers of the axis file, and where the example has them."""


@pytest.mark.soak
@pytest.mark.parametrize("number", ["mu_s", "c", "mass", "K_v"])
def test_a_cure_ends_the_jumps_of_drive_and_block_at_the_feed(number: str) -> None:
    """The feed rises evenly for 60 s to a tenth above; its last jump is within 1 % of the feed."""
    axis = Axis(resolution_motor=0.0, resolution_table=0.0)
    (cure,) = (
        each
        for each in cures(designed(axis), FEED)
        if each.number == number and each.then is not None and each.aim == END
    )
    assert cure.then is not None
    duration, top = 60.0, 1.1 * FEED
    changed: dict[str, Any] = {FIELDS[number]: cure.then}
    cured = replace(axis, feed=top, acceleration=top / duration, **changed)
    motion = couple(cured, [cured.T_s] * round(duration / cured.T_s))
    place, time = np.array(motion.x), np.array(motion.time)
    moves = np.flatnonzero(np.diff(place) == 0.0)
    last = top * time[moves[-1]] / duration
    assert last == pytest.approx(FEED, rel=0.01)
