"""What the design tool computes of an axis, and the whole loop in time."""

from typing import Any

import numpy as np
import pytest

from examples.feed_axis.whole_loop import solve
from stickslip_design.loop.critical import estimated_critical_feed
from stickslip_design.loop.jumps import limit_of_jumps
from stickslip_design.loop.stability import swing

from .axes import Axis
from .coupled import EXACT, FILTERED, last_jump, random_axis, velocity_loop

AXIS = Axis(**EXACT)


@pytest.mark.parametrize(
    "changes",
    [
        pytest.param(FILTERED | {"on_table": False, "T_s": 5e-4}, marks=pytest.mark.gate),
        # The motor stops while the table sticks: with a lag, and without one between two samples.
        pytest.param(FILTERED | {"dry": 600.0, "J": 1e-3}, marks=pytest.mark.soak),
        pytest.param({"dead_time": 4e-4, "dry": 600.0, "J": 1e-3}, marks=pytest.mark.soak),
    ],
)
def test_the_search_knows_what_is_between_a_sample_and_the_motion(changes: dict[str, Any]) -> None:
    axis = AXIS.but(**changes)
    limit = limit_of_jumps(axis.designed).feed
    # The feed rises by 0.02 % or so in a jump; the search ends within 0.05 %.
    assert last_jump(axis, limit, 5.0, 0.02) == pytest.approx(limit, rel=5e-3)


@pytest.mark.soak
@pytest.mark.parametrize("seed", range(50))
def test_the_search_ends_where_a_random_axis_stops_jumping(seed: int) -> None:
    axis = random_axis(seed)
    limit = limit_of_jumps(axis.designed).feed
    # The feed rises faster than above.
    assert last_jump(axis, limit, 8.0, 0.03) == pytest.approx(limit, rel=0.01)


@pytest.mark.gate
@pytest.mark.parametrize(
    ("changes", "grows"),
    [
        ({}, False),
        ({"K_v": 75.0}, True),
        (velocity_loop(740.0), True),
        ({"K_v": 75.0, "on_table": False}, False),
        ({"T_n": 0.0}, False),
    ],
)
def test_what_a_ramp_leaves_of_oscillation_decays_or_grows_by_the_damping_ratio(
    changes: dict[str, Any], grows: bool
) -> None:
    # Fast enough for the table to slide all the time.
    axis = AXIS.but(feed=0.05, acceleration=1.0, **changes)
    mode = swing(axis.designed)
    assert (mode.damping < 0.0) == grows
    x_dot = solve(axis.values, 0.5).column("x_dot")
    assert x_dot[40:].min() > 0.0
    # All else has decayed by exp(-25 * 0.2) = 7e-3 or more by now, and is smooth: of that a second
    # difference over half a period, 11 ms, leaves (25 * 0.011)^2 = 8 %, 5e-4 in all.
    late = x_dot[1000:]
    half = round(np.pi / (mode.w * axis.T_s))
    left = late[2 * half :] - 2.0 * late[half:-half] + late[: -2 * half]
    # A pair z, z* obeys y[n+2] = 2 Re(z) y[n+1] - |z|^2 y[n].
    before, now, after = left[:-2], left[1:-1], left[2:]
    (_, square), *_ = np.linalg.lstsq(np.column_stack((now, -before)), after)
    found = -0.5 * np.log(square) / (mode.w * axis.T_s)
    assert found == pytest.approx(mode.damping, abs=5e-4)


def test_without_control_the_slideway_damps_alone() -> None:
    axis = Axis(omega_v=0.0, K_v=0.0, T_n=0.0, d=0.0)
    w = np.sqrt(axis.k / axis.m + axis.k / axis.m_d)
    mode = swing(axis.designed)
    # Drive and table against each other; the next terms are smaller by the damping ratio's square
    # and by the masses'.
    assert mode.w == pytest.approx(w, rel=1e-3)
    share = axis.m_d / (axis.m + axis.m_d)
    assert mode.damping == pytest.approx(0.5 * axis.c * share / (axis.m * w), rel=5e-3)


def test_the_quick_estimate_of_the_limit_is_as_far_off_as_was_found() -> None:
    for changes, by in (({}, 1.02), ({"K_v": 50.0}, 0.94), ({"k": 1e8}, 1.20)):
        axis = Axis(**changes).designed
        assert estimated_critical_feed(axis) == pytest.approx(by * limit_of_jumps(axis).feed, 0.01)


def test_gravity_is_one_number_of_table_design_tool_and_whole_loop() -> None:
    axis = Axis(g=4.905)
    assert axis.values["table"]["g"] == axis.designed.g == 4.905
    # Half the weight breaks away at half the force, to what a sample adds.
    F, x = (solve(axis.values, 0.15).column(name) for name in ("F", "x"))
    assert float(F[x == 0.0].max()) == pytest.approx(0.5 * 981.0, rel=1e-2)
