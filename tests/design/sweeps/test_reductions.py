"""Reductions of samples: jump and period of a position with rests."""

import math

import numpy as np
import pytest

from stickslip_design.sweeps.reductions import REDUCTIONS, Floats, sticks

TIMES: Floats = 0.01 * np.arange(1000, dtype=np.float64)


def stairs(*, height: float, every: float, rise: float) -> Floats:
    """Return a position that rests, and rises by a height in `rise` [s] once `every` so often."""
    steps, within = np.divmod(TIMES, every)
    return height * (steps + np.clip((within - (every - rise)) / rise, 0.0, 1.0))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_jumps_have_the_height_of_the_stairs(sign: float) -> None:
    """In either direction; the rests are known to rounding."""
    position = 3.0 + sign * stairs(height=0.02, every=1.005, rise=0.2)
    assert REDUCTIONS["jump"].of(TIMES, position) == pytest.approx(0.02, rel=1e-9)
    # Eight periods between the first and the last break-away, each known to half a step.
    assert REDUCTIONS["period"].of(TIMES, position) == pytest.approx(1.005, abs=0.01 / 8)


def test_an_even_motion_has_no_jump() -> None:
    """Its jump is 0, and its period is none."""
    assert REDUCTIONS["jump"].of(TIMES, 0.3 * TIMES) == 0.0
    assert math.isnan(REDUCTIONS["period"].of(TIMES, 0.3 * TIMES))


def test_a_swing_that_never_rests_has_no_jump() -> None:
    """Where it turns its speed is 0 at once and not for some samples."""
    swing = 0.1 * TIMES + 0.2 * np.sin(3.0 * TIMES)
    assert REDUCTIONS["jump"].of(TIMES, swing) == 0.0


def test_a_mass_that_stays_has_one_rest() -> None:
    """And neither jump nor period."""
    (rest,) = sticks(TIMES, np.full(TIMES.shape, 2.0))
    assert (rest.begin, rest.end, rest.level) == (None, None, 2.0)
    assert REDUCTIONS["jump"].of(TIMES, np.full(TIMES.shape, 2.0)) == 0.0


def test_not_a_number_among_the_samples_is_the_result() -> None:
    """Of every reduction but the last value."""
    position = stairs(height=0.02, every=1.0, rise=0.2)
    position[500] = math.nan
    for name in ("jump", "period", "max", "min", "mean"):
        assert math.isnan(REDUCTIONS[name].of(TIMES, position))


def test_a_mean_is_that_of_time() -> None:
    """Where the communication points are uneven, each counts by the steps beside it."""
    times = np.array([0.0, 1.0, 4.0])
    assert REDUCTIONS["mean"].of(times, np.array([0.0, 2.0, 2.0])) == pytest.approx(1.75)
