"""The feed up to which an axis jumps: the design tool's search, and the whole loop in time."""

from dataclasses import replace
from typing import Any

import pytest

from examples.feed_axis.axis import Axis
from examples.feed_axis.designed import designed
from examples.feed_axis.document import exact_axis
from examples.feed_axis.monolithic import solve
from stickslip_design.loop.jumps import limit_of_jumps

from .jumping import last_jump, random_axis, velocity_loop
from .running import ROOT

ALL: dict[str, Any] = {
    "lag": 3e-4,
    "dead_time": 4e-4,
    "low_pass": 500.0,
    "low_pass_damping": 0.7,
    "notch": 200.0,
    "notch_damping": 0.4,
    "notch_depth": 0.1,
}
FAST = velocity_loop(600.0)
TEXT = " ".join((ROOT / "docs/feed-axis.md").read_text(encoding="utf-8").split())


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, 1.550),
        ({"K_v": 50.0}, 2.427),
        (FAST, 4.198),
        ({"T_s": 1e-3}, 1.40),
        ({"T_s": 5e-4}, 1.49),
        ({"T_s": 5e-5}, 1.60),
        ({"dead_time": 2.5e-4}, 1.468),
        ({"dead_time": 2.5e-4, "K_v": 50.0}, 2.29),
        ({"dead_time": 2.5e-4, **FAST}, 4.47),
    ],
)
def test_the_search_ends_where_the_whole_loop_does(
    changes: dict[str, Any], expected: float
) -> None:
    """Within 0.5 % of the last jump [mm/s] of the whole loop with the feed raised over 120 s."""
    limit = limit_of_jumps(designed(replace(exact_axis(), **changes))).feed
    assert 1e3 * limit == pytest.approx(expected, rel=5e-3)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ([{"on_table": False, "K_v": K_v} for K_v in (25.0, 50.0, 75.0)], "1.09, 1.00, 0.93 mm/s"),
        ([velocity_loop(220.0)], "lowest at 220 1/s, 1.44 mm/s"),
        ([velocity_loop(100.0)], "At 100 1/s jumping goes on to 1.83 mm/s"),
    ],
)
def test_the_how_to_tells_the_limits_of_other_drives(
    changes: list[dict[str, Any]], told: str
) -> None:
    """To the digit told."""
    limits = [1e3 * limit_of_jumps(designed(replace(Axis(), **each))).feed for each in changes]
    assert ", ".join(f"{limit:.2f}" for limit in limits) in told
    assert told in TEXT


@pytest.mark.parametrize(
    "changes",
    [
        ALL,
        {**ALL, "on_table": False, "T_s": 5e-4},
        # The motor stops while the table sticks: with a lag, and without one between two samples.
        {**ALL, "dry": 600.0, "J": 1e-3},
        {"dead_time": 4e-4, "dry": 600.0, "J": 1e-3},
    ],
)
def test_the_search_knows_what_is_between_a_sample_and_the_motion(changes: dict[str, Any]) -> None:
    """With all parts of the drive it ends where the whole loop stops jumping, to 0.5 %."""
    axis = replace(exact_axis(), **changes)
    limit = limit_of_jumps(designed(axis)).feed
    assert limit > 0.0
    # The feed rises by 0.02 % or so in a jump; the search ends within 0.05 %.
    assert last_jump(axis, limit, 5.0, 0.02) == pytest.approx(limit, rel=5e-3)


@pytest.mark.soak
@pytest.mark.parametrize("seed", range(50))
def test_the_search_ends_where_a_random_axis_stops_jumping(seed: int) -> None:
    """On a usual axis of any kind, search and whole loop agree to 1 %."""
    axis = random_axis(seed)
    limit = limit_of_jumps(designed(axis)).feed
    assert limit > 0.0
    assert last_jump(axis, limit, 8.0, 0.03) == pytest.approx(limit, rel=0.01)


@pytest.mark.soak
@pytest.mark.parametrize("changes", [{}, {"K_v": 50.0}, FAST])
def test_counts_do_not_move_the_limit(changes: dict[str, Any]) -> None:
    """The tool leaves counts out; with them jumping ends as near, the feed raised in 20 s: 1 %."""
    axis = replace(Axis(), **changes)
    limit = limit_of_jumps(designed(axis)).feed
    top, duration = 1.15 * limit, 20.0
    rising = replace(axis, feed=top, acceleration=top / duration)
    last, _ = solve(rising, duration).jumps[-1]
    assert last * rising.acceleration == pytest.approx(limit, rel=0.01)
