"""What axes do where they reverse, against closed forms of its own."""

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

from stickslip_design.axis import Axis, Filter, axis_file_of, example
from stickslip_design.loop.follower import (
    ROLLING,
    SLIDING,
    Follower,
    assumed,
    presliding,
)
from stickslip_design.loop.system import TABLE, Mode, System
from stickslip_design.reversal.circle import ANGLES, POINTS, Circle, measured, paths, reversal_value

FEED, RADIUS = 1.0 / 60.0, 0.05
AXIS = axis_file_of(example()).axis()
COULOMB = replace(AXIS, friction=replace(AXIS.friction, mu_s=AXIS.friction.mu_k))
SMOOTH = replace(AXIS, friction=replace(AXIS.friction, mu_s=0.0, mu_k=0.0))


def changed(axis: Axis, **values: Any) -> Axis:
    """Return an axis with other numbers of its drive, or its own."""
    assert axis.drive is not None
    drive = {name: value for name, value in values.items() if hasattr(axis.drive, name)}
    own = {
        name: value for name, value in values.items() if name not in drive and hasattr(axis, name)
    }
    friction = {name: value for name, value in values.items() if name not in drive | own}
    return replace(
        axis, drive=replace(axis.drive, **drive), friction=replace(axis.friction, **friction), **own
    )


def run(axis: Axis, feed: float = FEED, radius: float = RADIUS, share: float = 0.0) -> Circle:
    follower = Follower(axis)
    return measured(feed, radius, share, paths(follower, follower, feed, radius, share))


def closed_loop(axis: Axis, w: float) -> complex:
    """Return table over command at a frequency, docs/feed-axis.md (1), (2), with exact delays."""
    drive, s = axis.drive, 1j * w
    assert drive is not None
    passes = complex(np.exp(-s * (drive.dead_time + drive.T_s))) / (1.0 + drive.lag * s)
    for each in drive.filters:
        c = 2.0 * math.pi * each.frequency
        if math.isinf(each.damping):
            passes *= c / (s + c)
        else:
            below = s * s + 2.0 * each.damping * c * s + c * c
            notch = s * s + 2.0 * each.depth * each.damping * c * s + c * c
            passes *= (notch if each.kind == "notch" else c * c) / below
    gain = drive.K_p * (1.0 + 1.0 / (drive.T_n * s)) * passes
    # motor: [m_d s^2 + d s + k + gain s] x_m = k x + gain (K_v (r - x_measured) + f_v s r)
    # table: [m s^2 + c s + k] x = k x_m
    motor = drive.inertia * s * s + drive.d * s + axis.k + gain * s
    table = (axis.m * s * s + axis.c * s + axis.k) / axis.k
    wanted = gain * (drive.K_v + drive.velocity_feedforward * s)
    measured = gain * drive.K_v
    left = motor * table - axis.k + (measured if drive.on_table else measured * table)
    return complex(wanted / left)


LOW_PASS, SECOND = Filter("low pass", 400.0), Filter("low pass", 300.0, 0.7)
NOTCH = Filter("notch", 45.0, 0.3, 0.1)


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"on_table": False, "velocity_feedforward": 0.0},
        {"velocity_feedforward": 0.6, "dead_time": 1e-3, "lag": 5e-4},
        {"filters": (LOW_PASS, SECOND, NOTCH), "velocity_feedforward": 0.9},
    ],
    ids=["table", "motor", "late", "filtered"],
)
@pytest.mark.parametrize(("feed", "radius"), [(FEED, RADIUS), (0.1, 0.01)])
def test_without_friction_the_radius_is_the_gain_of_the_closed_loop(
    values: dict[str, Any], feed: float, radius: float
) -> None:
    axis = changed(SMOOTH, **values)
    found = run(axis, feed, radius)
    error = radius * (abs(closed_loop(axis, feed / radius)) - 1.0)
    # Pade's delay is off by (w T)^5/720, the solver by its tolerance.
    assert pytest.approx(error, rel=1e-5, abs=1e-10) == found.D
    assert (found.F_max, found.F_min) == pytest.approx((error, error), rel=1e-5, abs=1e-9)
    for none in (found.G_b, found.G, found.H, found.glitch.height):
        assert none == pytest.approx(0.0, abs=2e-9)


@pytest.mark.parametrize(
    ("values", "within"),
    [({}, 0.01), ({"dead_time": 1e-3, "lag": 5e-4}, 0.01), ({"T_s": 1e-3}, 0.04)],
    ids=["0.25 ms", "late", "1 ms"],
)
def test_a_delay_of_a_sample_stands_for_the_sampled_loop(
    values: dict[str, float], within: float
) -> None:
    # Friction that turns over at once is a step of the force on the table.
    axis = changed(COULOMB, **values)
    assert axis.drive is not None
    system, T_s = System(axis), axis.drive.T_s
    state, sampled = system.holding(axis.F_k, 0.0, axis.F_k / axis.k), []
    for _ in range(round(0.15 / T_s)):
        state = system.control @ state
        for part in system.steps(Mode(-1, 1)):
            state = part @ state
        sampled.append(state[TABLE])
    follower = Follower(axis)
    force = np.zeros(follower.size)
    force[follower.table + 1] = 2.0 * axis.F_k / axis.m
    answer = stepped(follower.rates[:, : follower.size], force, follower.table, T_s, len(sampled))
    # The delay is right to first order in the bandwidth times T_s: 0.075, 0.3.
    assert np.abs(answer - sampled).max() < within * max(sampled)


def stepped(rates: Any, force: Any, place: int, step: float, count: int) -> Any:
    """Return how a place of a linear motion answers a force that begins, step by step."""
    size = len(rates)
    whole = np.zeros((size + 1, size + 1))
    whole[:size, :size], whole[:size, size] = rates, force
    on, state, seen = expm(whole * step), np.eye(size + 1)[size], []
    for _ in range(count):
        state = on @ state
        seen.append(state[place])
    return np.array(seen)


STIFF = changed(COULOMB, k=1e10, T_s=1e-5, d=0.0, c=0.0, presliding=1e-7)
"""Table and motor as one mass, and no delay."""


def of_one_mass(axis: Axis, feed: float, radius: float) -> tuple[float, float]:
    """Return the glitch of one mass under Coulomb's friction, and the most of any circle.

    M x'' = u - F sgn(x') with u = K_p (e_v + integral of e_v / T_n), e_v = K_v (r - x) + r' - x'
    and r = R cos(w t). Where x' is 0 the mass stands until u has come from F + M x'' to -F. The
    most is the answer to a step of the force by 2 F.
    """
    drive, F, w = axis.drive, axis.F_k, feed / radius
    assert drive is not None
    M, K_p, K_v, T_n = axis.m + drive.inertia, drive.K_p, drive.K_v, drive.T_n
    poly = np.array([M, K_p, K_p * (K_v + 1.0 / T_n), K_p * K_v / T_n])
    whole = radius - radius * M * (1j * w) ** 3 / complex(np.polyval(poly, 1j * w))
    turn = -float(np.angle(whole)) / w

    def wave(of: complex, order: int, t: float) -> float:
        return float((of * (1j * w) ** order * np.exp(1j * w * t)).real)

    def risen(order: int, t: float) -> float:
        return wave(radius, order, t) - wave(radius, order, turn)

    def force(t: float) -> float:
        """Return u, the mass at rest since it turned."""
        e_v = K_v * risen(0, t) + risen(1, t)
        integral = K_v * (risen(-1, t) - abs(whole) * (t - turn)) + risen(0, t)
        return F + M * wave(whole, 2, turn) + K_p * (e_v + integral / T_n)

    free = turn
    if force(turn) > -F:
        free = brentq(lambda t: force(t) + F, turn, turn + 0.5 / w, xtol=1e-15)
    # From then on x less that without friction swings freely, of third order.
    rates = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], -poly[:0:-1] / M])
    step, found = 1e-5, []
    on, times = expm(rates * step), free - turn + step * np.arange(30_000)
    begun = [abs(whole), 0.0, 0.0 if free > turn else wave(whole, 2, turn) + 2.0 * F / M]
    for state in (
        begun - np.array([wave(whole, order, free) for order in range(3)]),
        np.array([0.0, 0.0, 2.0 * F / M]),
    ):
        way = [(state := on @ state)[0] for _ in times]
        found.append(way)
    return float(np.max(found[0] * np.cos(w * times))), max(found[1])


@pytest.mark.parametrize(("feed", "radius"), [(FEED, RADIUS), (0.1, 0.1), (0.05, 0.01)])
def test_without_presliding_the_glitch_is_that_of_coulombs_friction(
    feed: float, radius: float
) -> None:
    found, (glitch, most) = run(STIFF, feed, radius), of_one_mass(STIFF, feed, radius)
    # The spring yields by 0.15 um, the contact by 0.1 um.
    assert found.glitch.height == pytest.approx(glitch, abs=2.5e-7)
    assert glitch < most


def test_where_the_axis_turns_fast_the_glitch_is_the_answer_to_a_step() -> None:
    # At 10 m/s2 inertia reverses the axis before its controller does.
    glitch, most = of_one_mass(STIFF, 10.0, 10.0)
    assert glitch == pytest.approx(most, rel=1e-3)
    assert run(STIFF, 10.0, 10.0).glitch.height == pytest.approx(most, rel=0.02)


RIGID = replace(COULOMB, drive=None)
"""The spring is pulled by the command itself."""


@pytest.mark.parametrize("way", [2e-6, 25e-6, 2e-4])
def test_a_slow_circle_on_a_rigid_drive_draws_friction_over_the_spring(way: float) -> None:
    axis, radius = changed_way(RIGID, way), 0.02
    found = run(axis, 1e-4, radius)
    # The table comes back by a way over which friction turns over from -F to F; the command by what
    # the spring gives way besides. The other axis lags by F/k throughout, this one does before.
    back = np.geomspace(1e-9, 5e-3, 100_000)
    turned = 1.0 - 2.0 * np.exp(-back / way)
    cosine = 1.0 - (back + axis.F_k / axis.k * (1.0 + turned)) / radius
    radial = turned * cosine - np.sqrt(1.0 - cosine**2)
    before = math.sin(math.radians(5.0)) - math.cos(math.radians(5.0))
    height = axis.F_k / axis.k * (radial.max() - before)
    # Viscous friction is 0.4 N of 736 N.
    assert found.glitch.height == pytest.approx(height, rel=1e-3)


def changed_way(axis: Axis, way: float) -> Axis:
    return replace(axis, friction=replace(axis.friction, presliding=way))


def test_an_axis_knows_no_direction() -> None:
    follower, w = Follower(changed_way(COULOMB, 1e-5)), FEED / RADIUS
    at = np.linspace(0.0, 2.0 * math.pi / w, 500, endpoint=False)
    knots = tuple(0.5 * math.pi / w * quarter for quarter in range(5))

    def along(sign: float) -> Any:
        return follower.follow(
            lambda t: sign * FEED * math.cos(w * t),
            lambda t: -sign * FEED * w * math.sin(w * t),
            knots, at, 300.0,
        )  # fmt: skip

    # The solver's differences for its Jacobian are upward on both ways.
    np.testing.assert_allclose(along(1.0), -along(-1.0), rtol=0.0, atol=5e-11)


def test_friction_presliding_radius_and_feed_scale_the_deviations_alike() -> None:
    one, scale = changed_way(COULOMB, 1e-5), 3.0
    friction = replace(one.friction, mu_s=scale * one.friction.mu_s, mu_k=scale * one.friction.mu_k)
    other = changed_way(replace(one, friction=friction), scale * 1e-5)
    small, large = run(one), run(other, scale * FEED, scale * RADIUS)
    for name in ("G_b", "G", "H", "D"):
        # Two solutions, each to a nanometre.
        assert getattr(large, name) == pytest.approx(scale * getattr(small, name), abs=1e-9), name
    assert large.glitch.height == pytest.approx(scale * small.glitch.height, abs=1e-9)


def test_two_axes_have_each_their_own_glitch() -> None:
    one, other = Follower(changed_way(COULOMB, 1e-5)), Follower(SMOOTH)
    found = measured(FEED, RADIUS, 0.0, paths(one, other, FEED, RADIUS, 0.0))
    # At 0 and 180 degrees the first one reverses.
    heights = [each.height for each in found.glitches]
    own = measured(FEED, RADIUS, 0.0, paths(one, one, FEED, RADIUS, 0.0)).glitch.height
    assert heights[::2] == pytest.approx([own, own], rel=1e-3)
    assert np.abs(heights[1::2]).max() < 0.01 * own


@pytest.mark.gate
def test_friction_fed_forward_ends_the_glitch_of_a_stiff_axis() -> None:
    # It reverses faster than 0.4 um of presliding takes: 0.3 ms.
    without, with_it, twice = (run(STIFF, 10.0, 10.0, x).glitch.height for x in (0.0, 1.0, 2.0))
    assert abs(with_it) < 0.05 * without
    # Twice the friction is as wrong as none, to the other side.
    assert twice == pytest.approx(-without, rel=0.05)


@pytest.mark.parametrize("acceleration", [0.003, 0.01])
def test_the_reversal_value_is_friction_over_the_spring(acceleration: float) -> None:
    axis = changed_way(RIGID, 1e-6)
    follower = Follower(axis)
    found = reversal_value(follower, FEED, acceleration)
    # The spring brakes the table: it holds F - m a when that stops, its swings long ended. What
    # then swings in the contact is m a over both stiffnesses.
    force = axis.F_k - axis.m * acceleration
    swing = axis.m * acceleration / (axis.k + axis.F_s / 1e-6)
    assert found == pytest.approx(-2.0 * force / axis.k, abs=4.0 * swing + 1e-9)


def test_the_reversal_value_is_the_difference_of_the_means_of_two_directions() -> None:
    axis = changed(changed_way(COULOMB, 1e-5), on_table=False)
    follower = Follower(axis)
    rests: dict[float, list[float]] = {1.0: [], -1.0: []}
    for feed in (FEED, 0.9 * FEED, 1.1 * FEED):
        for sign, found in rests.items():
            found += stopped(follower, sign * feed, feed / 0.1)
    values = [reversal_value(follower, feed, 0.1) for feed in (FEED, 0.9 * FEED, 1.1 * FEED)]
    assert np.mean(rests[1.0]) - np.mean(rests[-1.0]) == pytest.approx(np.mean(values), rel=1e-6)
    # The integral brings the motor to its target, and so the table within friction over spring.
    assert all(-2.0 * axis.F_s / axis.k < value < 0.0 for value in values)


def stopped(follower: Follower, feed: float, slows: float) -> list[float]:
    """Return where the table rests 2 s after a command stopped evenly within a time."""
    rests = follower.follow(
        lambda t: feed * max(1.0 - t / slows, 0.0),
        lambda t: -feed / slows if t < slows else 0.0,
        (0.0, slows, slows + 3.0), np.array([slows + 2.0]), 0.0,
    )  # fmt: skip
    return [float(rests[0])]


def test_a_scale_on_the_table_and_an_integral_leave_no_reversal_value() -> None:
    assert abs(reversal_value(Follower(changed_way(COULOMB, 1e-5)), FEED, None)) < 1e-9


def shaped(shape: Callable[[Any], Any], other: Callable[[Any], Any] | None = None) -> Circle:
    return measured(FEED, RADIUS, 0.0, np.array([shape(ANGLES), (other or shape)(ANGLES)]))


def test_the_letters_of_iso_230_4() -> None:
    oval = shaped(lambda a: 5e-6 + 2e-6 * np.cos(2.0 * a) + 30e-6 * np.cos(a) - 9e-6 * np.sin(a))
    # Where the instrument is centred is none of it.
    assert (oval.G_b, oval.G, oval.H, oval.D) == pytest.approx((4e-6, 4e-6, 0.0, 5e-6), abs=1e-12)
    assert (oval.F_max, oval.F_min) == pytest.approx((7e-6, 3e-6), abs=1e-12)
    two = shaped(lambda a: 3e-6 * np.sin(2.0 * a), lambda a: -3e-6 * np.sin(2.0 * a) - 1e-6)
    assert pytest.approx((6e-6, 7e-6, -0.5e-6), abs=1e-12) == (two.G, two.H, two.D)
    assert two.G_b == pytest.approx(7e-6, abs=1e-12)


def test_height_and_width_of_a_glitch() -> None:
    def spike(angles: Any) -> Any:
        # A triangle of 4 um, 6 degrees wide, after the reversal at 90 degrees.
        away = np.abs(np.degrees(angles) - 95.0)
        return 1e-6 + 4e-6 * np.maximum(1.0 - away / 3.0, 0.0)

    found = shaped(spike).glitches
    assert [each.height for each in found] == pytest.approx([0.0, 4e-6, 0.0, 0.0], abs=1e-12)
    assert found[1].angle == pytest.approx(0.5 * math.pi)
    step = 2.0 * math.pi / POINTS * RADIUS
    assert found[1].width == pytest.approx(RADIUS * math.radians(3.0), abs=1.5 * step)
    assert shaped(lambda a: -spike(a)).glitch.height == pytest.approx(-4e-6, abs=1e-12)


def test_presliding_is_that_of_the_file_or_as_usual_for_the_way() -> None:
    rolling = (
        example().replace("mu_s = 0.20", "mu_s = 0.006").replace("mu_k = 0.15", "mu_k = 0.005")
    )
    stated = example().replace("mu_k = 0.15", 'mu_k = 0.15\npresliding = "7 um"')
    for text, way, words in (
        (example(), SLIDING, "2 µm"), (rolling, ROLLING, "25 µm"), (stated, 7e-6, ""),
        (stated.replace("7 um", "0 um"), SLIDING, "2 µm"),
    ):  # fmt: skip
        axis = axis_file_of(text).axis()
        taken = {each.key: each.value for each in assumed(axis)}
        assert (presliding(axis), taken.pop("friction.presliding", "")) == (way, words)
        assert taken == {"friction.v_s": "1 mm/s"}


def test_an_unstable_loop_has_no_circle() -> None:
    with pytest.raises(ValueError, match=r"^X axis: its loop is unstable"):
        Follower(changed(COULOMB, K_v=2000.0))


def test_the_equations_written_out_and_solved_by_radau_give_the_same_course() -> None:
    friction = replace(AXIS.friction, mu_s=0.06, mu_k=0.045, presliding=15e-6)
    axis = changed(replace(AXIS, friction=friction), T_s=1e-6, velocity_feedforward=0.8)
    drive, way, w = axis.drive, 15e-6, 0.5
    assert drive is not None
    sigma_0 = axis.F_s / way
    sigma_1 = 2.0 * math.sqrt(sigma_0 * axis.m)
    v_d = 0.1 * math.sqrt(2.0 * math.e) * axis.F_k / sigma_1
    R, forward = FEED / w, 0.5 * axis.F_k

    def rates(t: float, y: Any) -> list[float]:
        x_m, v_m, x, v, integral, z = y
        g = axis.F_k + (axis.F_s - axis.F_k) * math.exp(-((v / 1e-3) ** 2))
        z_dot = v - sigma_0 * abs(v) * z / g
        dry = sigma_0 * z + sigma_1 * math.exp(-((v / v_d) ** 2)) * z_dot
        r, r_dot = R * math.sin(w * t), FEED * math.cos(w * t)
        e_v = drive.K_v * (r - x) + 0.8 * r_dot - v_m
        force = drive.K_p * e_v + integral + math.copysign(forward, r_dot)
        spring = axis.k * (x_m - x)
        v_m_dot = (force - spring - drive.d * v_m) / drive.inertia
        v_dot = (spring - dry - axis.c * v) / axis.m
        return [v_m, v_m_dot, v, v_dot, drive.K_p / drive.T_n * e_v, z_dot]

    # Even motion to begin with, as there.
    stretch = (axis.F_k + axis.c * FEED) / axis.k
    x = -0.2 * FEED / drive.K_v
    held = axis.F_k + (axis.c + drive.d) * FEED - forward
    y: Any = [x + stretch, FEED, x, FEED, held, axis.F_k / sigma_0]
    knots, found = (0.0, 0.5 * math.pi / w, math.pi / w), []
    at = np.linspace(0.0, knots[2], 402)[1:-1]
    for begin, end in pairwise(knots):
        times = [*at[(at > begin) & (at < end)], end]
        run = solve_ivp(rates, (begin, end), y, "Radau", times, rtol=1e-8, atol=1e-11)
        y = run.y[:, -1]
        found += (run.y[2, :-1] - R * np.sin(w * run.t[:-1])).tolist()
    course = Follower(axis).follow(
        lambda t: FEED * math.cos(w * t), lambda t: -FEED * w * math.sin(w * t), knots, at, forward
    )
    # What is left is the delay of a sample, 3e-4 of the bandwidth, of 20 um.
    assert np.ptp(course) > 5e-6
    np.testing.assert_allclose(course, found, rtol=0.0, atol=2e-8)


def test_an_axis_that_judders_without_end_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("stickslip_design.loop.follower._MOST", 1000)
    with pytest.raises(RuntimeError, match="judders on and on"):
        run(AXIS)


def test_the_other_direction_is_the_mirror_image() -> None:
    follower = Follower(changed_way(COULOMB, 1e-5))
    one, other = paths(follower, follower, FEED, RADIUS, 0.5)
    np.testing.assert_allclose(other, np.roll(one[::-1], 1), atol=1e-12)
    # The glitches of both stand side by side.
    assert np.abs(one - other).max() > 0.9 * np.ptp(one)


def test_dry_friction_of_the_motor_acts_as_that_of_the_table_where_they_are_one_mass() -> None:
    friction = replace(STIFF.friction, mu_s=0.0, mu_k=0.0)
    motor = changed(replace(STIFF, friction=friction), dry=STIFF.F_k)
    table = changed(STIFF, presliding=ROLLING)
    # Damping of the presliding, which goes with the mass, adds a tenth of friction at most.
    assert run(motor).glitch.height == pytest.approx(run(table).glitch.height, rel=0.1)


def test_two_coefficients_are_stribecks_friction_over_1_mm_per_s() -> None:
    law = 'law = "stribeck"\nv_s = "1 mm/s"\ndelta = 2\npresliding = "50 um"\n'
    stribeck = axis_file_of(example().replace("mu_s = 0.20", f"{law}mu_s = 0.20")).axis()
    assert not list(assumed(stribeck))
    assert run(stribeck).G_b == pytest.approx(run(changed_way(AXIS, 5e-5)).G_b, abs=1e-9)
