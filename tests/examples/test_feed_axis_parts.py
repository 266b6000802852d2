"""What lies between a sample and the motion of the motor: filters, dead time, lag, dry friction."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.signal import freqz

from examples.feed_axis.axis import Axis, critically_damped
from examples.feed_axis.monolithic import solve
from examples.feed_axis.servo_drive import filters
from examples.feed_axis.servo_drive.model import ServoDrive
from examples.feed_axis.servo_drive.motion import Inertia, Place, Pull
from examples.feed_axis.servo_drive.table import Settings
from fmukit.model import ModelError

from .in_process import couple
from .running import run_all

EXACT: dict[str, Any] = {"resolution_motor": 0.0, "resolution_table": 0.0}
NOTCH: dict[str, Any] = {"notch": 200.0, "notch_damping": 0.4, "notch_depth": 0.1}

PARTS: dict[str, dict[str, Any]] = {
    "lag": {"lag": 5e-4},
    "lag far below a sample": {"lag": 2e-5},
    "dead time of a sample": {"dead_time": 250e-6},
    "dead time of 2.6 samples": {"dead_time": 650e-6},
    "low pass of first order": {"low_pass": 300.0},
    "low pass of second order": {"low_pass": 300.0, "low_pass_damping": 0.7},
    "notch": NOTCH,
    # The axis hunts after a move, so that the motor stops and breaks away again.
    "dry friction": {"dry": 150.0, "feed": 5e-3, "distance": 3e-4, "K_v": 70.0},
    # A light motor, slow enough to stop while the table jumps.
    "all": {
        "lag": 1e-4,
        "dead_time": 400e-6,
        "low_pass": 500.0,
        "low_pass_damping": 0.7,
        **NOTCH,
        "dry": 300.0,
        "feed": 3e-4,
        "J": 1e-3,
        "omega_v": 150.0,
        "T_n": critically_damped(150.0),
    },
}


@pytest.mark.parametrize("part", PARTS)
def test_drive_and_table_converge_to_the_whole_loop_with_the_square_of_the_step(part: str) -> None:
    """With each part and with all, half the step leaves a quarter of the error."""
    axis = Axis(**EXACT, **PARTS[part])
    truth = solve(axis, 0.5)
    x, times = truth.column("x", axis), np.array(truth.time)
    if axis.dry:
        # It breaks away and stops.
        at_rest = np.diff(truth.column("x_motor", axis)) == 0.0
        assert np.count_nonzero(np.diff(at_rest.astype(int))) >= 2
    errors = [
        float(np.max(np.abs(couple(axis, [h] * round(0.5 / h)).table_at(times) - x)))
        for h in (axis.T_s, 0.5 * axis.T_s)
    ]
    # That of the axis as it is, docs/feed-axis.md, is 0.14 um; here the largest is 0.35 um.
    assert errors[0] < 5e-7
    # The next term is smaller by w h = 0.08 of a period's radian.
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.08)


def test_the_fmus_move_as_the_whole_loop(fmus: Path) -> None:
    """With all parts, both FMUs coupled stay within a hundredth of a jump of the whole loop."""
    changes = {**EXACT, **PARTS["all"]}
    axis = Axis(**changes)
    truth = solve(axis, 0.5)
    ((x, x_motor, F_motor),) = run_all(
        fmus, [(changes, 0.5, axis.T_s, "jacobi")], "x", "x_motor", "F_motor"
    )
    assert np.max(np.abs(x - truth.column("x", axis))) < 2e-7
    assert np.max(np.abs(x_motor - truth.column("x_motor", axis))) < 2e-7
    # What is off by that is the position, and its change over a sample, too: below 1 um/s.
    off = np.abs(F_motor - truth.column("F_motor", axis))
    assert np.max(off) < axis.K_p * (axis.K_v * 2e-7 + 1e-5)
    assert np.max(off) < 0.02 * np.max(F_motor)


@pytest.mark.parametrize("part", PARTS)
def test_a_part_changes_the_motion(part: str) -> None:
    """Each part moves the table by more than what coupling in steps does."""
    axis = Axis(**EXACT, **PARTS[part])
    bare = replace(axis, lag=0.0, dead_time=0.0, low_pass=0.0, notch=0.0, dry=0.0)
    without = solve(bare, 0.5)
    off = solve(axis, 0.5).column("x", axis) - without.column("x", axis)
    coupled = couple(axis, [axis.T_s] * 2000).table_at(np.array(without.time))
    apart = coupled - without.column("x", axis)
    assert np.max(np.abs(off)) > 2e-7
    assert np.max(np.abs(apart - off)) < np.max(np.abs(off))


@pytest.mark.parametrize("lag", [1e-300, 1e-6, 0.1, 0.499, 1.0, 1.001, 3.0, 1e6, 1e300])
def test_any_lag_is_solved_to_rounding(lag: float) -> None:
    """The motion under a decaying force is that of the matrix, for a lag of any length."""
    # Units in which a sample and the inertia are 1; as long a sample as may be.
    k, d = 0.16, 0.18
    place, pull = Place(0.25, -1.0, 4.0), Pull(1.5, 0.5, 0.75)
    found = Inertia(1.0, d, k, lag, 0.0).moved(1.0, place, pull)
    # State: way, speed, motor's force, time, 1. Shorter lags are over at once.
    rates = np.zeros((5, 5))
    rates[0, 1] = rates[3, 4] = 1.0
    rates[1] = -k, -d, 1.0, k * pull.speed, -pull.at_zero
    shortest = max(lag, 1e-8)
    rates[2, [2, 4]] = -1.0 / shortest, pull.command / shortest
    x, v, F_motor, *_ = expm(rates) @ np.array([*place, 0.0, 1.0])
    # Rounding of some numbers around 1, and that of a matrix whose largest entry is 4 / lag.
    assert found == pytest.approx((x, v, F_motor), abs=1e-13 + 1e-15 * 4.0 / shortest)


@pytest.mark.parametrize("d", [0.0, 0.18])
@pytest.mark.parametrize("lag", [0.0, 0.05, 0.7])
@pytest.mark.parametrize("v", [0.3, -0.3, 0.0])
@pytest.mark.parametrize("command", [2.0, 0.9, -2.0])
def test_dry_friction_stops_holds_and_turns(d: float, lag: float, v: float, command: float) -> None:
    """The motion with dry friction is that of friction which rises steeply with the speed."""
    k, dry, steep = 0.16, 1.0, 1e-7
    place = Place(0.25, v, 4.0 if lag else command)
    pull = Pull(command, -0.5, -2.0)

    def rates(t: float, y: NDArray[np.float64]) -> list[float]:
        x, speed, F_motor = y
        force = F_motor - pull.at_zero - k * (x - pull.speed * t) - d * speed
        fall = (command - F_motor) / lag if lag else 0.0
        return [speed, force - dry * math.tanh(speed / steep), fall]

    exact = Inertia(1.0, d, k, lag, dry)
    # The parts of a sample, each from where the one before ended: no state beside the place.
    parts = 4
    for part in range(parts):
        h = 1.0 / parts
        later = pull._replace(at_zero=pull.at_zero - k * pull.speed * h * part)
        place = exact.moved(h, place, later)
    start = [0.25, v, 4.0 if lag else command]
    end = solve_ivp(rates, (0.0, 1.0), start, "Radau", rtol=1e-9, atol=1e-12).y[:, -1]
    # It creeps at some 1e-7 where the other holds, and is as late where the speed passes 0.
    assert place == pytest.approx(tuple(end), abs=2e-6)


def test_a_motor_at_rest_breaks_away_when_the_lag_lets_it() -> None:
    """With a lag T a force of twice the dry friction is told; it breaks away after T ln 2."""
    lag, h = 0.3, 1.0
    place = Inertia(1.0, 0.0, 0.0, lag, 1.0).moved(h, Place(0.0, 0.0, 0.0), Pull(2.0, 0.0, 0.0))
    left = h - lag * math.log(2.0)
    # From there on v' = 1 - exp(-t / T).
    v = left - lag * (1.0 - math.exp(-left / lag))
    assert place.v == pytest.approx(v, abs=1e-14)


def test_a_short_push_backward_stops_the_motor_and_lets_it_go_on() -> None:
    """A speed that would dip below 0 and come back within a sample stops at 0 instead."""
    lag, dry, h = 0.05, 0.1, 1.0
    place, pull = Place(0.0, 0.1, -5.0), Pull(1.0, 0.0, 0.0)
    free = Inertia(1.0, 0.0, 0.0, lag, 0.0)
    without = [free.moved(t, place, pull).v - dry * t for t in np.linspace(0.0, h, 101)]
    assert min(without) < 0.0 < without[-1]
    found = Inertia(1.0, 0.0, 0.0, lag, dry).moved(h, place, pull)
    # At the stop the force is still backward; it moves so, turns, and is off in the end.
    fine = Inertia(1.0, 0.0, 0.0, lag, dry)
    for _ in range(1000):
        place = fine.moved(h / 1000, place, pull)
    assert found == pytest.approx(place, abs=1e-12)
    assert found.v > 0.5


@pytest.mark.parametrize("frequency", [20.0, 300.0, 1900.0])
def test_a_filter_does_at_its_frequency_what_the_continuous_one_does(frequency: float) -> None:
    """A low pass leaves 1/sqrt 2 or 1/(2 damping), a notch its depth, all the force at rest."""
    T_s = 250e-6
    for each, left in (
        (filters.low_pass(frequency, 0.0, T_s), math.sqrt(0.5)),
        (filters.low_pass(frequency, 0.8, T_s), 1.0 / 1.6),
        (filters.notch(frequency, 0.4, 0.15, T_s), 0.15),
        (filters.notch(frequency, 0.4, 1.0, T_s), 1.0),
    ):
        above, below = (each.b0, each.b1, each.b2), (1.0, each.a1, each.a2)
        _, gain = freqz(above, below, [0.0, frequency], fs=1.0 / T_s)
        # Rounding, and poles near 1: 1/(w T_s)^2 = 1e3 of it.
        assert np.abs(gain) == pytest.approx([1.0, left], abs=1e-12)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"dead_time": 0.26}, r"dead_time = 0\.26 s .* at most 1000 T_s, 0\.25 s"),
        ({"low_pass": 2000.0}, r"low_pass = 2000\.0 Hz .* below 1/\(2 T_s\), 2000 Hz"),
        ({"notch": 2500.0, "notch_damping": 0.5}, r"notch = 2500\.0 Hz .* 2000 Hz"),
        ({"notch": 200.0}, r"notch_damping = 0\.0 is out of range: above 0"),
        ({"notch_depth": 1.5}, r"notch_depth = 1\.5 is out of range: .*at most 1"),
        ({"lag": -1.0}, r"lag = -1\.0"),
        ({"dry": -1.0}, r"dry = -1\.0"),
    ],
)
def test_a_part_that_cannot_be_is_refused(changes: dict[str, float], words: str) -> None:
    """Axis and FMU name what is wrong, the value, and the range."""
    with pytest.raises(ValueError, match=words):
        Axis(**changes)  # type: ignore[arg-type]
    settings = Settings.at_start()
    outside = False
    for name, value in changes.items():
        outside |= Settings.table.by_name[name].objection(value) is not None
        settings = settings.changed(name, value)
    if not outside:
        with pytest.raises(ModelError, match=words):
            ServoDrive(settings)
