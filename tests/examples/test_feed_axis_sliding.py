"""How well the drive damps the table that slides: the estimate, and the whole loop in time."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from examples.feed_axis.axis import Axis
from examples.feed_axis.designed import designed
from examples.feed_axis.document import exact_axis
from examples.feed_axis.monolithic import solve
from examples.feed_axis.study import CREEPING, rows_of
from stickslip_design.critical import estimated_critical_feed
from stickslip_design.loop.stability import swing

from .jumping import velocity_loop
from .running import ROOT

DOCUMENT = (ROOT / "docs/feed-axis.md").read_text(encoding="utf-8")
TEXT = " ".join(DOCUMENT.split())


@pytest.mark.parametrize(
    ("changes", "grows"),
    [
        ({}, False),
        ({"K_v": 70.0}, False),
        ({"K_v": 75.0}, True),
        (velocity_loop(690.0), False),
        (velocity_loop(740.0), True),
        ({"K_v": 75.0, "on_table": False}, False),
        ({"T_n": 0.0}, False),
    ],
)
def test_the_whole_loop_swings_as_the_estimate_says(changes: dict[str, Any], grows: bool) -> None:
    """What a ramp of the feed leaves of oscillation decays or grows by the damping ratio told."""
    # Fast enough for the table to slide all the time.
    axis = replace(exact_axis(), feed=0.05, acceleration=1.0, **changes)
    mode = swing(designed(axis))
    assert (mode.damping < 0.0) == grows
    motion = solve(axis, 0.5)
    x_dot = motion.column("x_dot", axis)
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
    """Drive and table against each other are damped by c m_d / (m + m_d) at their frequency."""
    axis = Axis(omega_v=0.0, K_v=0.0, T_n=0.0, d=0.0)
    w = np.sqrt(axis.k / axis.m + axis.k / axis.m_d)
    share = axis.m_d / (axis.m + axis.m_d)
    mode = swing(designed(axis))
    # The next terms are smaller by the damping ratio's square and by the masses'.
    assert mode.w == pytest.approx(w, rel=1e-3)
    assert mode.damping == pytest.approx(0.5 * axis.c * share / (axis.m * w), rel=5e-3)


def test_the_how_to_tells_these_ratios() -> None:
    """The damping ratios in the text of the how-to are those of the swing, to the digit told."""
    drives: list[dict[str, Any]] = [{}, {"K_v": 50.0}, velocity_loop(600.0)]
    found = [damping(**changes) for changes in drives]
    assert [f"{100.0 * ratio:.1f}" for ratio in found] == ["6.6", "3.7", "1.4"]
    on_motor = [damping(K_v=K_v, on_table=False) for K_v in (25.0, 50.0, 75.0)]
    assert [f"{100.0 * ratio:.1f}" for ratio in on_motor] == ["9.1", "10.0", "11.1"]
    for words in (
        "is damped by 6.6 %",
        "leave hardly any damping, 3.7 % and 1.4 %",
        "25, 50, 75 1/s give 9.1, 10.0, 11.1 %",
    ):
        assert words in TEXT


def damping(**changes: Any) -> float:
    """Return the least damping ratio while the table slides."""
    return swing(designed(replace(Axis(), **changes))).damping


def test_the_damping_ratio_estimates_the_limit_as_the_how_to_tells() -> None:
    """Within 7 % but for a stiffer screw and position on the motor, as told."""
    rows = rows_of(DOCUMENT, "creep")
    estimates = {each.name: 1e3 * estimated_critical_feed(designed(each.axis)) for each in CREEPING}
    off = {name: limit / float(rows[name][8]) - 1.0 for name, limit in estimates.items()}
    assert off.pop("stiffer, k = 100 N/µm") == pytest.approx(0.20, abs=0.01)
    assert off.pop("position on the motor") == pytest.approx(0.16, abs=0.01)
    assert max(map(abs, off.values())) < 0.07
    assert f"{estimates['as it is']:.2f}" == "1.59"
    assert f"{estimates['K_v = 50 1/s']:.2f}" == "2.28"
    for words in ("1.59 mm/s as it is, 2.28 mm/s with K_v = 50 1/s", "20 % too high", "and 16 %"):
        assert words in TEXT
