"""How well the drive damps the table that slides: the estimate, and the whole loop in time."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from examples.feed_axis.axis import Axis, critically_damped
from examples.feed_axis.document import exact_axis
from examples.feed_axis.estimates import critical_feed
from examples.feed_axis.monolithic import solve
from examples.feed_axis.sliding import sliding_mode
from examples.feed_axis.study import CREEPING, rows_of
from stickslip_ref import critical_velocity

from .running import ROOT

DOCUMENT = (ROOT / "docs/feed-axis.md").read_text(encoding="utf-8")
TEXT = " ".join(DOCUMENT.split())


def velocity_loop(omega_v: float) -> dict[str, Any]:
    """Return the changes that make a velocity loop of this bandwidth [rad/s]."""
    return {"omega_v": omega_v, "T_n": critically_damped(omega_v)}


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
    mode = sliding_mode(axis)
    assert (mode.damping < 0.0) == grows
    motion = solve(axis, 0.5)
    x_dot = motion.column("x_dot", axis)
    assert x_dot[40:].min() > 0.0
    # All else has decayed by exp(-25 * 0.2) = 7e-3 or more by now, and is smooth: of that a second
    # difference over half a period, 11 ms, leaves (25 * 0.011)^2 = 8 %, 5e-4 in all.
    late = x_dot[1000:]
    half = round(np.pi / (mode.w * axis.T_s))
    swing = late[2 * half :] - 2.0 * late[half:-half] + late[: -2 * half]
    # A pair z, z* obeys y[n+2] = 2 Re(z) y[n+1] - |z|^2 y[n].
    before, now, after = swing[:-2], swing[1:-1], swing[2:]
    (_, square), *_ = np.linalg.lstsq(np.column_stack((now, -before)), after)
    found = -0.5 * np.log(square) / (mode.w * axis.T_s)
    assert found == pytest.approx(mode.damping, abs=5e-4)


def test_with_the_scale_a_stiffer_drive_shakes_the_table_by_itself() -> None:
    """On the scale damping ends at K_v = 72 1/s or omega_v = 716 1/s; on the motor it does not."""
    by_gain = brentq(lambda K_v: sliding_mode(Axis(K_v=K_v)).damping, 60.0, 90.0)
    by_loop = brentq(
        lambda w: sliding_mode(replace(Axis(), **velocity_loop(w))).damping, 600.0, 900.0
    )
    assert by_gain == pytest.approx(72.0, abs=0.5)
    assert by_loop == pytest.approx(716.0, abs=0.5)
    on_motor = [sliding_mode(Axis(K_v=K_v, on_table=False)).damping for K_v in (25.0, 50.0, 75.0)]
    assert on_motor == pytest.approx([0.091, 0.100, 0.111], abs=5e-4)


def test_without_control_the_slideway_damps_alone() -> None:
    """Drive and table against each other are damped by c m_d / (m + m_d) at their frequency."""
    axis = Axis(omega_v=0.0, K_v=0.0, T_n=0.0, d=0.0)
    w = np.sqrt(axis.k / axis.m + axis.k / axis.m_d)
    share = axis.m_d / (axis.m + axis.m_d)
    mode = sliding_mode(axis)
    # The next terms are smaller by the damping ratio's square and by the masses'.
    assert mode.w == pytest.approx(w, rel=1e-3)
    assert mode.damping == pytest.approx(0.5 * axis.c * share / (axis.m * w), rel=5e-3)


def test_the_how_to_tells_these_ratios() -> None:
    """The damping ratios in the text of the how-to are those of the estimate, to the digit told."""
    drives: list[dict[str, Any]] = [{}, {"K_v": 50.0}, velocity_loop(600.0)]
    found = [sliding_mode(replace(Axis(), **changes)).damping for changes in drives]
    assert [f"{100.0 * ratio:.1f}" for ratio in found] == ["6.6", "3.7", "1.4"]
    for words in ("is damped by 6.6 %", "leave hardly any damping, 3.7 % and 1.4 %"):
        assert words in TEXT


def limit_by_damping(axis: Axis) -> float:
    """Return the limit feed [m/s] of a rigid drive whose slideway damps as the table that slides.

    docs/theory.md (14).
    """
    slideway = axis.slideway
    ratio = sliding_mode(axis).damping
    c = 2.0 * ratio * np.sqrt(axis.k * axis.m)
    return float(critical_velocity(replace(slideway, c=c)))


def test_the_damping_ratio_estimates_the_limit_as_the_how_to_tells() -> None:
    """Within 9 % of the last jump but for a stiffer screw and position on the motor, as told."""
    rows = rows_of(DOCUMENT, "creep")
    off = {
        each.name: 1e3 * limit_by_damping(each.axis) / float(rows[each.name][7]) - 1.0
        for each in CREEPING
    }
    assert off.pop("stiffer, k = 100 N/µm") == pytest.approx(0.22, abs=0.01)
    assert off.pop("position on the motor") == pytest.approx(0.18, abs=0.01)
    assert max(map(abs, off.values())) < 0.09
    assert f"{1e3 * limit_by_damping(Axis()):.2f}" == "1.59"
    assert f"{1e3 * limit_by_damping(Axis(K_v=50.0)):.2f}" == "2.28"
    for words in ("1.59 mm/s as it is, 2.28 mm/s with K_v = 50 1/s", "22 % too high", "and 18 %"):
        assert words in TEXT


@pytest.mark.soak
@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({}, "1.55 mm/s as it is"),
        ({"K_v": 50.0}, "2.43 mm/s with K_v = 50 1/s"),
        (velocity_loop(600.0), "4.2 mm/s with a velocity loop of 600 1/s"),
    ],
)
def test_the_slower_the_feed_rises_the_higher_the_last_jump(
    changes: dict[str, Any], told: str
) -> None:
    """When the feed rises in 20 s, jumping ends within 1 % of the limit that the how-to tells."""
    axis = replace(Axis(), **changes)
    top, duration = 1.15 * critical_feed(axis), 20.0
    rising = replace(axis, feed=top, acceleration=top / duration)
    last, _ = solve(rising, duration).jumps[-1]
    assert 1e3 * last * rising.acceleration == pytest.approx(float(told.split()[0]), rel=0.01)
    assert told in TEXT
