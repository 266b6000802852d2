"""The measured curve in the block: exact from band to band, Coulomb where it is constant."""

from __future__ import annotations

import math
import random

import pytest

from fmukit.model import ModelError
from stickslip_fmu.laws.stribeck.points import lines_of
from stickslip_verification import truth
from stickslip_verification.truth import Step
from tests.fmu.blocks import Segment, draw, outputs
from tests.fmu.blocks import drive as drive_coulomb
from tests.laws.exact_slip import curve_slip
from tests.laws.stribeck import Points, curve, drive, make_block

FALLS_TWICE: Points = [(0.0, 0.5), (0.02, 0.3), (0.15, 0.45), (0.4, 0.2), (0.6, 0.25)]


def test_a_flat_curve_is_coulombs_law_to_the_bit() -> None:
    """Two points with one coefficient are Coulomb's law with the gap mu_s - mu_1."""
    generator = random.Random(21)
    for _ in range(100):
        values, segments = draw(generator)
        for segment in segments:
            segment.changes.pop("mu_k", None)
        flat = curve([(0.0, values["mu_k"]), (0.01, values["mu_k"])])
        assert drive({**values, **flat}, segments) == drive_coulomb(values, segments)


def test_points_on_one_line_are_one_band() -> None:
    """Extra points on a flat curve change no bit."""
    segments = [Segment(0.3)] * 10
    flat = [(0.0, 0.3), (0.01, 0.3), (0.02, 0.3), (0.07, 0.3)]
    assert drive(curve(flat), segments) == drive_coulomb({"mu_k": 0.3}, segments)


def test_lines_of_one_slope_begin_with_the_friction_of_the_first() -> None:
    """Two collinear falls, and a flat end joined to the constant friction beyond it."""
    points = ((0.0, 0.5), (0.25, 0.375), (0.5, 0.25), (1.0, 0.25), (2.0, 0.25))
    assert lines_of(points) == ((0.0, 0.5, -0.5, 0.5), (0.5, math.inf, 0.0, 0.25))
    rising = ((0.0, 0.25), (0.5, 0.25), (1.0, 0.5))
    assert lines_of(rising) == (
        (0.0, 0.5, 0.0, 0.25),
        (0.5, 1.0, 0.5, 0.25),
        (1.0, math.inf, 0.0, 0.5),
    )


DEFAULTS = {"m": 1.0, "g": 9.81, "k": 1000.0, "c": 0.0, "mu_s": 0.5, "v": 0.02}
SLIPS: dict[str, tuple[dict[str, float], Points]] = {
    "falls twice": ({"c": 2.0}, FALLS_TWICE),
    "falls twice, undamped": ({}, FALLS_TWICE),
    "falls twice, with a gap": ({"mu_s": 0.7, "v": 0.1}, FALLS_TWICE),
    "starts without a gap, slowly": ({"v": 1e-4}, FALLS_TWICE),
    "steep at the beginning": ({"v": 0.003}, [(0.0, 0.5), (1e-4, 0.3), (0.01, 0.29), (0.05, 0.32)]),
    "narrow bands": ({"v": 0.05}, [(0.0, 0.45), (0.08, 0.4), (0.081, 0.3), (0.082, 0.38)]),
    "knot at the pull": ({"v": 0.02}, [(0.0, 0.45), (0.02, 0.3), (0.03, 0.4)]),
    "overdamped by its slope": ({"v": 0.01, "mu_s": 0.52}, [(0.0, 0.5), (0.02, 0.2), (0.2, 1.5)]),
    "hardly a gap": ({"mu_s": 0.300001, "v": 1e-3}, [(0.0, 0.3), (5e-4, 0.3), (5e-3, 0.29)]),
}


@pytest.mark.parametrize("name", SLIPS)
def test_a_slip_over_a_curve_is_exact(name: str) -> None:
    """Duration, way, relief, peak and heat of the first slip, to 1e-12."""
    own, points = SLIPS[name]
    p = {**DEFAULTS, **own}
    block = make_block(**p, **curve(points))
    block.advance(0.0, p["mu_s"] * p["m"] * p["g"] / (p["k"] * p["v"]))
    exact = curve_slip(p, points, 0.3 / math.sqrt(p["k"] / p["m"]))
    block.advance(0.0, float(exact.duration) * (1.0 + 1e-9))
    found = outputs(block)
    assert found["n_slips"] == 1
    assert found["t_slip"] == pytest.approx(float(exact.duration), rel=1e-12)
    assert found["delta_x"] == pytest.approx(float(exact.way), rel=1e-12)
    assert found["spring_drop"] == pytest.approx(float(exact.relief), rel=1e-12, abs=1e-14)
    assert found["x_dot_peak"] == pytest.approx(float(exact.peak), rel=1e-12)
    assert found["Q_friction"] == pytest.approx(float(exact.heat), rel=2e-12)


def test_a_knot_touched_is_no_event_and_a_knot_passed_is_one() -> None:
    """A swing about the pull that ends a relative 1e-9 below or above a knot stays, or leaves."""
    v, swing = 0.05, 0.02
    for distance in (-1e-9, 1e-9, -1e-7, 1e-7):
        knot = (v + swing) * (1.0 - distance)
        # Constant below the knot and steep above, so a crossing shows in the swing.
        points = [(0.0, 0.3), (knot, 0.3), (2.0 * knot, 1.3)]
        z_steady = 0.3 * 9.81 / 1000.0
        block = make_block(**curve(points), v=v, z_start=z_steady, x_dot_start=v + swing)
        w = math.sqrt(1000.0)
        block.advance(0.0, 2.0 * math.pi / w)
        lost = 1.0 - (outputs(block)["x_dot"] - v) / swing
        # The speed is a parabola above the knot, `beyond` high and 2 t long, once in a turn; the
        # slope N/knot there damps it by 0.4 % at most.
        beyond = max(distance, 0.0) * (v + swing)
        t = math.sqrt(2.0 * beyond / swing) / w
        expected = 9.81 / knot * (4.0 / 3.0) * beyond * t / swing
        assert lost == pytest.approx(expected, rel=5e-3, abs=1e-14)
        assert block.meter.n_slips == 0


@pytest.mark.parametrize("c", [0.0, 3.0])
def test_steady_sliding_on_a_knot_is_one_arc(c: float) -> None:
    """An equilibrium that sits on a knot is kept for a million seconds at once."""
    v = 0.02
    force = 0.3 * 9.81 + c * v
    for slopes in ((0.0, 20.0), (10.0, 20.0), (-10.0, 20.0), (-10.0, -5.0)):
        points = [
            (0.0, 0.3 - slopes[0] * v),
            (v, 0.3),
            (2.0 * v, 0.3 + slopes[1] * v),
        ]
        mu_s = max(0.5, points[0][1])
        block = make_block(
            **curve(points), mu_s=mu_s, v=v, c=c, z_start=force / 1000.0, x_dot_start=v
        )
        arc = block.state.arc
        block.advance(0.0, 1e-3)
        assert outputs(block)["x_dot"] == pytest.approx(v, rel=1e-12)
        if min(slopes) >= 0.0:
            block.advance(0.0, 1e6)
            assert outputs(block)["x_dot"] == pytest.approx(v, rel=1e-12)
            assert block.state.arc is arc


def test_a_swing_that_settles_on_a_knot_comes_to_an_end() -> None:
    """A damped swing about a pull on a knot passes it until rounding, and then no more."""
    v = 0.02
    points = [(0.0, 0.2), (v, 0.3), (2.0 * v, 0.7)]
    block = make_block(**curve(points), v=v, c=2.0, x_dot_start=0.03)
    for _ in range(100):
        block.advance(0.0, 10.0)
    assert block.state.arc.duration == math.inf
    assert outputs(block)["x_dot"] == pytest.approx(v, rel=1e-14)


def falling(mu: float, slope: float) -> dict[str, float]:
    """Return the curve that falls straight from `mu` to 0, by `slope` [s/m]."""
    return curve([(0.0, mu), (mu / slope, 0.0)])


def test_a_slope_that_cancels_the_damping_leaves_the_undamped_motion() -> None:
    """With c = slope N the run is Coulomb's with c = 0, the heat mu_1 N times the way."""
    common = {"g": 8.0, "v": 0.2}
    segments = [Segment(0.125)] * 16
    rows = drive({**common, "c": 4.0, **falling(0.25, 0.5)}, segments)
    undamped = drive_coulomb({**common, "mu_k": 0.25}, segments)
    for row, other in zip(rows, undamped, strict=True):
        for name in ("x", "z", "x_dot", "Q_friction", "t_slip"):
            # Ten slips in 2 s, each to a few units of rounding.
            assert row[name] == pytest.approx(other[name], rel=1e-12, abs=1e-14)


def test_a_sliding_that_hardly_grows_is_taken_to_its_stop_at_once() -> None:
    """A swing of 1e-4 v about steady sliding, growing at 5e-7/s, stops after ln(1e4)/5e-7 s."""
    # Steady sliding has k z = mu_1 N - slope N v.
    z_start = (0.5 * 9.81 - 1e-6 * 0.02) / 1000.0
    start = {"z_start": z_start, "x_dot_start": 0.02 * (1.0 - 1e-4)}
    block = make_block(**falling(0.5, 1e-6 / 9.81), **start)
    # It stops within one period, 0.2 s, of the time at which the swing has grown to v.
    end = block.state.arc.duration
    assert end == pytest.approx(math.log(1e4) / 5e-7, abs=0.2)
    block.advance(0.0, end + 1e-3)
    assert block.meter.n_slips == 1


def test_a_slip_that_grows_fast_stops_or_leaves_its_band_in_time() -> None:
    """At a damping ratio of -490 the spring is nothing to 1e-6: m u' = P + slope N u.

    P is the force on the mass at rest, and the speed is u = (u0 + P/(slope N)) exp(g t) -
    P/(slope N) with g = slope N/m.
    """
    g, u0, knot = 981.0, 1e-5, 3e-3
    fast = {"k": 1.0, "v": 1e-6, "x_dot_start": u0, **falling(0.3, 100.0)}
    # P = -mu_1 N: the speed falls from u0 to 0.
    block = make_block(**fast)
    end = math.log(knot / (knot - u0)) / g
    assert block.state.arc.duration == pytest.approx(end, rel=1e-6)
    block.advance(0.0, 1e-4)
    assert block.meter.n_slips == 1
    assert outputs(block)["t_slip"] == pytest.approx(end, rel=1e-6)
    # P = (mu_s - mu_1) N: it grows from u0 to the knot.
    block = make_block(**fast, z_start=4.905)
    ratio = 2e-3
    end = math.log((knot + ratio) / (u0 + ratio)) / g
    assert block.state.arc.duration == pytest.approx(end, rel=1e-6)
    block.advance(0.0, end)
    assert outputs(block)["x_dot"] == pytest.approx(knot, rel=1e-5)


@pytest.mark.parametrize("distance", [1e-7, 1e-10, 1e-13, 0.0, -1e-13, -1e-10, -1e-7])
def test_beside_the_critical_negative_damping_the_block_is_the_truth(distance: float) -> None:
    """At a damping ratio of -1, where swings end, the block gives the truth's motion.

    N = 8 N, 2 sqrt(k m) = 64 N.s/m, so the ratio is -1 + `distance`.
    """
    values = {"g": 8.0, "k": 1024.0, **falling(0.25, 8.0 * (1.0 - distance))}
    values |= {"v": 2.0**-12, "x_dot_start": 2.0**-13, "z_start": 2.0**-9}
    block = make_block(**values)
    block.advance(0.0, 0.03125)
    (sample,) = truth.run(values, [Step(0.03125)], law="stribeck").samples
    for name in ("x", "z", "x_dot", "Q_friction"):
        # Growth by exp(32 t) amplifies rounding by e.
        assert outputs(block)[name] == pytest.approx(float(sample[name]), rel=1e-13), name


def test_without_a_normal_force_the_mass_swings_without_heat() -> None:
    """At N = 0 the motion from rest is x = v (t - sin(w t)/w), and Q_friction is 0."""
    block = make_block(load=-9.81, **falling(0.3, 0.1))
    block.advance(0.0, 0.7)
    w = math.sqrt(1000.0)
    found = outputs(block)
    assert found["x"] == pytest.approx(0.02 * (0.7 - math.sin(w * 0.7) / w), rel=1e-13)
    assert found["Q_friction"] == 0.0


def test_a_rebase_that_lands_on_a_knot_goes_on() -> None:
    """A change of the pull at a speed that is a knot to the bit: the slip enters the right band."""
    knot = 0.04
    points = [(0.0, 0.5), (knot, 0.3), (0.1, 0.35)]
    for z in (0.0, 0.01):
        block = make_block(**curve(points), x_dot_start=knot, z_start=z)
        # 1000 z against 0.3 N: the speed falls, or rises.
        block.advance(0.0, 1e-4)
        speed = outputs(block)["x_dot"]
        expected = knot + (1000.0 * z - 0.3 * 9.81) * 1e-4
        assert speed == pytest.approx(expected, rel=1e-3)


REFUSED = [
    (curve([(0.0, 0.5), (0.1, 0.3), (0.1, 0.2)]), "u_3 = 0.1 m/s is out .* above u_2 = 0.1 m/s"),
    (curve([(0.0, 0.6), (0.1, 0.3)]), "mu_1 = 0.6 is out of range: it must be at most mu_s = 0.5"),
]


@pytest.mark.parametrize(("values", "told"), REFUSED)
def test_a_curve_that_is_none_is_refused(values: dict[str, float], told: str) -> None:
    """With name, value and range; points beyond n_points and other shapes are not looked at."""
    with pytest.raises(ModelError, match=told):
        make_block(**values)
    make_block(**{**values, "shape": 1})


def test_a_point_that_does_not_count_is_not_checked() -> None:
    """A point beyond n_points may lie anywhere."""
    make_block(**curve([(0.0, 0.5), (0.3, 0.3)]), u_3=0.1, mu_3=7.0)


def test_what_is_ignored_is_said() -> None:
    """The first parameter beyond n_points that is set, and mu_k, are named in one warning."""
    two = curve([(0.0, 0.5), (0.1, 0.3)])
    assert make_block(**two).warning() is None
    assert make_block(**two, mu_k=0.2).warning() == (
        "mu_k = 0.2 is ignored: shape is 3 (Curve), whose friction is mu_1 to mu_2"
    )
    assert make_block(**two, mu_4=0.2, u_5=7.0).warning() == ("mu_4 = 0.2 is ignored: n_points = 2")
    both = make_block(**two, mu_k=0.2, u_12=7.0).warning()
    assert both is not None
    assert both.endswith("mu_1 to mu_2; u_12 = 7.0 is ignored: n_points = 2")
    # The other shapes ignore no mu_k.
    assert "is clamped" in str(make_block(**{**two, "shape": 1}, mu_k=0.6).warning())


def test_mu_k_used_shows_the_last_point() -> None:
    """Friction of high speeds is what mu_k_used shows."""
    assert outputs_of_law(curve(FALLS_TWICE)) == 0.25


def outputs_of_law(values: dict[str, float]) -> float:
    """Return the output mu_k_used."""
    return float(getattr(make_block(**values).state.friction, "mu_k_used"))  # noqa: B009
