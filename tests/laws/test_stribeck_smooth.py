"""Stribeck and hyperbolic friction in the block: exact slips, stops that graze, long sliding."""

from __future__ import annotations

import math
import random
from collections.abc import Callable

import pytest

from fmukit.model import ModelError
from tests.fmu.blocks import Segment, draw, outputs, uneven
from tests.fmu.blocks import drive as drive_coulomb
from tests.laws.exact_slip import hyperbolic, smooth_slip, stribeck
from tests.laws.stribeck import curve, drive, make_block

DEFAULTS = {
    "m": 1.0,
    "g": 9.81,
    "k": 1000.0,
    "c": 0.0,
    "mu_s": 0.5,
    "mu_k": 0.3,
    "v": 0.02,
    "shape": 1,
    "v_s": 0.01,
    "delta": 2.0,
}


SLIPS: dict[str, dict[str, float]] = {
    "defaults": {},
    "damped": {"c": 2.0},
    "heavily damped": {"c": 30.0, "v": 1e-3},
    "exponential": {"delta": 1.0},
    "exponential, hardly any speed": {"delta": 1.0, "v_s": 1e-6},
    "cubic exponent": {"delta": 3.0, "v": 0.1},
    "exponent 20": {"delta": 20.0},
    "exponent 2.7": {"delta": 2.7},
    "exponent 1.5": {"delta": 1.5},
    "exponent next to 1": {"delta": 1.0001},
    "fast fall": {"v_s": 1e-4},
    "slow fall": {"v_s": 0.5, "v": 0.1},
    "no friction at speed": {"mu_k": 0.0},
    "hyperbolic": {"shape": 2},
    "hyperbolic, damped": {"shape": 2, "c": 1.0, "v": 0.1},
    "hyperbolic, fast fall": {"shape": 2, "v_s": 1e-5},
    "hyperbolic, no friction at speed": {"shape": 2, "mu_k": 0.0},
}


@pytest.mark.parametrize("name", SLIPS)
def test_a_slip_is_exact(name: str) -> None:
    """Duration, way, relief, peak and heat of the first slip, to 1e-13."""
    p = {**DEFAULTS, **SLIPS[name]}
    exact = smooth_slip(
        p, (hyperbolic if p["shape"] == 2 else stribeck)(p), 0.3 / math.sqrt(p["k"] / p["m"])
    )
    block = make_block(**p)
    block.advance(0.0, p["mu_s"] * p["m"] * p["g"] / (p["k"] * p["v"]))
    block.advance(0.0, float(exact.duration) * (1.0 + 1e-9))
    found = outputs(block)
    assert found["n_slips"] == 1
    assert found["t_slip"] == pytest.approx(float(exact.duration), rel=1e-13)
    assert found["delta_x"] == pytest.approx(float(exact.way), rel=1e-13)
    assert found["spring_drop"] == pytest.approx(float(exact.relief), rel=1e-13)
    assert found["x_dot_peak"] == pytest.approx(float(exact.peak), rel=1e-13)
    assert found["Q_friction"] == pytest.approx(float(exact.heat), rel=1e-13)


@pytest.mark.parametrize("own", [{}, {"shape": 2}, {"delta": 1.0}, {"delta": 1.5}], ids=str)
def test_a_slip_with_hardly_a_fall_of_friction_keeps_its_digits(own: dict[str, float]) -> None:
    """At lambda = w Delta/v = 1e-6 the length of the slip is exact to 1e-12.

    It follows from a least speed of -5e-13 v, so an error of 1e-16 v is one of 1e-10 there.
    """
    fall = 1e-6 * DEFAULTS["v"] * math.sqrt(1000.0) / 9.81
    p = {**DEFAULTS, "mu_k": 0.5 - fall, "v_s": 1e-3, **own}
    friction = (hyperbolic if p["shape"] == 2 else stribeck)(p)
    exact = smooth_slip(p, friction, 0.3 / math.sqrt(1000.0))
    block = make_block(**p)
    block.advance(0.0, 0.5 * 9.81 / (1000.0 * p["v"]))
    block.advance(0.0, float(exact.duration) * (1.0 + 1e-9))
    found = outputs(block)
    assert found["n_slips"] == 1
    assert found["t_slip"] == pytest.approx(float(exact.duration), rel=1e-12)
    assert found["delta_x"] == pytest.approx(float(exact.way), rel=1e-13)


LEINE = {
    "m": 1.0,
    "g": 1.0,
    "k": 1.0,
    "c": 0.0,
    "mu_s": 1.0,
    "mu_k": 0.0,
    "shape": 2,
    "v_s": 1.0 / 3.0,
}


def test_leine_s_cycle_has_the_published_displacement() -> None:
    """F = F_s/(1 + 3 |u|), m = k = F_s = 1, v = 0.2: z is at most 1.133944669704.

    Leine, van Campen, de Kraker, van den Steen, Nonlinear Dynamics 16 (1998) 41,
    doi:10.1023/A:1008289604683.
    """
    block = make_block(**LEINE, v=0.2)
    block.advance(0.0, 6.0)
    nearest, largest = 1.0, 0.0
    while block.meter.n_slips < 2:
        block.advance(0.0, 2.0**-9)
        found = outputs(block)
        acceleration, lack = found["F"] + found["F_friction"], 0.2 - found["x_dot"]
        if block.mode == 1 and acceleration > 0.0 and abs(lack) < nearest:
            # z is largest where the mass is as fast as the pull; z_ddot = -x_ddot.
            nearest, largest = abs(lack), found["z"] + 0.5 * lack * lack / acceleration
    assert nearest < 1e-3
    assert largest == pytest.approx(1.133944669704, abs=1e-8)


def test_leine_s_slip_at_a_fast_pull_reverses_at_once() -> None:
    """At v = 1 the slip ends with the spring beyond F_s: it reverses and does not stick."""
    block = make_block(**LEINE, v=1.0)
    modes: list[int] = []
    time = 0.0
    for _ in range(4000):
        block.advance(time, 2.0**-8)
        time += 2.0**-8
        if block.mode != (modes[-1] if modes else None):
            modes.append(block.mode)
    first_slip = modes.index(1)
    assert modes[first_slip + 1] == -1


def test_equal_coefficients_are_coulombs_law_to_the_bit() -> None:
    """Without a fall of friction, or without friction, every output is Coulomb's."""
    generator = random.Random(21)
    for number in range(60):
        values, segments = draw(generator)
        for segment in segments:
            segment.changes.pop("mu_k", None)
        values["mu_k"] = values["mu_s"]
        if number % 3 == 0:
            values |= {"mu_s": 0.0, "mu_k": 0.0}
        assert drive({**values, "shape": 1 + number % 2}, segments) == drive_coulomb(
            values, segments
        )


def slip_time(**own: float) -> float:
    """Return the length of the first slip [s]."""
    p = {**DEFAULTS, **own}
    block = make_block(**p)
    block.advance(0.0, p["mu_s"] * p["m"] * p["g"] / (p["k"] * p["v"]) + 0.25)
    return float(outputs(block)["t_slip"])


def order(error: Callable[[float], float], small: float) -> float:
    """Return the exponent with which an error falls from 2 small to small."""
    return float(math.log2(error(2.0 * small) / error(small)))


@pytest.mark.parametrize(("delta", "expected"), [(2.0, 2.0 / 3.0), (3.0, 0.6), (1.5, 0.75)])
def test_a_fast_fall_is_coulombs_law_with_its_rate(delta: float, expected: float) -> None:
    """t_slip tends to Coulomb's as v_s^(delta/(2 delta - 1)).

    From rest m u' = k V t + D (u/v_s)^delta: both terms are alike at u = k V t^2/(2 m), which
    takes ``t ~ v_s^(delta/(2 delta - 1))``.
    """
    limit = (
        2.0
        * (math.pi - math.atan(math.sqrt(1000.0) * 0.2 * 9.81 / 1000.0 / 0.02))
        / math.sqrt(1000.0)
    )

    def error(v_s: float) -> float:
        return float(abs(slip_time(v_s=v_s, delta=delta) - limit))

    assert order(error, 1e-12) == pytest.approx(expected, abs=0.02)


def test_a_fast_exponential_fall_is_coulombs_law_with_its_rate() -> None:
    """At delta = 1 the rate is v_s ln(1/v_s): the slip grows as exp(D t/(m v_s))."""
    limit = (
        2.0
        * (math.pi - math.atan(math.sqrt(1000.0) * 0.2 * 9.81 / 1000.0 / 0.02))
        / math.sqrt(1000.0)
    )
    errors = [abs(slip_time(v_s=v_s, delta=1.0) - limit) / v_s for v_s in (1e-6, 1e-8, 1e-10)]
    # Over v_s the error grows by the same amount for every factor of v_s.
    assert errors[2] - errors[1] == pytest.approx(errors[1] - errors[0], rel=0.02)


def test_closer_points_come_closer_to_the_smooth_curve() -> None:
    """The error of t_slip over a curve falls as the square of the spacing of its points."""
    smooth = slip_time(shape=2, v_s=0.1, v=0.05)

    def error(count: int) -> float:
        speeds = [0.2 * n / (count - 1) for n in range(count)]
        points = [(u, 0.3 + 0.2 / (1.0 + u / 0.1)) for u in speeds]
        return slip_time(**curve(points), v=0.05) - smooth

    assert error(6) / error(11) == pytest.approx(4.0, rel=0.1)


@pytest.mark.parametrize("own", [{"c": 30.0}, {"c": 20.0, "shape": 2}, {"c": 60.0, "delta": 1.3}])
def test_stable_sliding_is_kept_for_ever_at_once(own: dict[str, float]) -> None:
    """Sliding that settles ends in one arc without end, in a step of 1e9 s too."""
    p = {**DEFAULTS, "v": 0.03, **own}
    ratio = p["v"] / p["v_s"]
    fall = 1.0 / (1.0 + ratio) if p["shape"] == 2 else math.exp(-(ratio ** p["delta"]))
    force = 9.81 * (0.3 + 0.2 * fall) + p["c"] * p["v"]
    block = make_block(**p, z_start=force / 1000.0, x_dot_start=0.9 * p["v"])
    block.advance(0.0, 30.0)
    assert block.state.arc.duration == math.inf
    block.advance(30.0, 1e9)
    found = outputs(block)
    assert found["x_dot"] == pytest.approx(p["v"], rel=1e-14)
    assert found["F"] == pytest.approx(force, rel=1e-14)


def test_a_swing_about_sliding_that_never_stops_goes_on() -> None:
    """Where friction is flat at the pull and the swing, the mass swings for ever, undamped."""
    block = make_block(**{**DEFAULTS, "v": 1.0}, z_start=0.3 * 9.81 / 1000.0, x_dot_start=1.5)
    block.advance(0.0, 1e6)
    found = outputs(block)
    assert found["n_slips"] == 0
    w = math.sqrt(1000.0)
    assert found["x_dot"] == pytest.approx(1.0 + 0.5 * math.cos(w * 1e6), abs=1e-6)


def test_unstable_sliding_grows_to_a_stop_at_any_small_start() -> None:
    """A swing of 1e-9 v about unstable sliding grows at -c'/(2 m) to stick-slip.

    With c' = c - D h'(V)/v_s, it stops about ln(1e9) 2 m/(-c') after its start.
    """
    p = {**DEFAULTS, "shape": 2, "v": 0.2, "v_s": 0.1}
    fall = 1.0 / 3.0
    growth = 0.2 * 9.81 / 0.1 * fall * fall / 2.0
    force = 9.81 * (0.3 + 0.2 * fall)
    block = make_block(**p, z_start=force / 1000.0, x_dot_start=0.2 * (1.0 + 1e-9))
    block.advance(0.0, 0.9 * math.log(1e9) / growth)
    assert block.meter.n_slips == 0
    block.advance(0.0, 0.3 * math.log(1e9) / growth)
    assert block.meter.n_slips >= 1


@pytest.mark.parametrize("lack", [1e-4, 1e-8, 1e-12])
def test_a_stop_that_grazes_is_not_missed(lack: float) -> None:
    """The least speed of a slip is a hair below 0 or above it: it stops, or goes on.

    The damping at which the slip from break-away just touches 0 is found by halving; a relative
    `lack` beside it the slip stops, or has not stopped after 100 turns.
    """

    def stops(c: float) -> bool:
        block = make_block(**{**DEFAULTS, "v": 0.1, "v_s": 0.05, "c": c})
        block.advance(0.0, 0.0491)
        block.advance(0.0, 2.0)
        return bool(block.meter.n_slips >= 1)

    low, high = 0.0, 40.0
    while high - low > 1e-15 * high:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        low, high = (middle, high) if stops(middle) else (low, middle)
    assert 0.1 < low < 39.0
    assert stops(low * (1.0 - lack))
    assert not stops(low * (1.0 + lack))


EXTREMES: list[dict[str, float]] = [
    {"v_s": 1e-9},
    {"v_s": 1e-9, "delta": 1.0},
    {"v_s": 1e-9, "shape": 2},
    {"v_s": 1e3},
    {"v_s": 1e3, "delta": 1.3},
    {"v_s": 1e9, "shape": 2},
    {"delta": 1e6},
    {"delta": 1e300},
    {"mu_k": 0.499999},
    {"v": 0.0, "z_start": 0.02},
    {"v": 0.0, "z_start": 0.02, "c": 200.0, "delta": 1.0},
    {"v": 0.0, "z_start": 0.02, "c": 2000.0, "delta": 1.5},
    {"v": -0.02, "x_dot_start": 0.05},
    {"v": 0.02, "x_dot_start": -0.05, "delta": 1.4},
    {"v": 0.02, "x_dot_start": 1e-9, "delta": 1.4},
    {"v": 0.02, "x_dot_start": 5.0, "shape": 2},
    {"load": -9.81},
    {"k": 1e8, "m": 1e-3, "v": 1e-6},
    {"k": 1.0, "m": 1e4, "v": 10.0},
]


@pytest.mark.parametrize("own", EXTREMES, ids=str)
def test_extreme_settings_run_and_do_not_depend_on_the_step(own: dict[str, float]) -> None:
    """Ten turns at once are ten turns in 40 uneven steps, whatever the settings."""
    values = {**DEFAULTS, **own}
    turns = [Segment(60.0 * math.sqrt(values["m"] / values["k"]))]
    once = drive(values, turns)[0]
    often = drive(values, turns, uneven(random.Random(5)))[0]
    scale = max(abs(once["x"]), abs(once["z"]))
    for name in ("x", "z", "x_pull"):
        assert often[name] == pytest.approx(once[name], abs=1e-12 * scale, rel=0.0), name
    assert often["n_slips"] == once["n_slips"]


def test_a_rate_beyond_the_range_is_refused() -> None:
    """With name, value and the reason."""
    with pytest.raises(ModelError, match=r"v_s = 1e-307 m/s is out of range: its rate .* N/\(m v"):
        make_block(v_s=1e-307, m=0.01, load=1e3)
