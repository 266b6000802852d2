"""The servo drive: motion of its motor, filters, set point, controller, and its FMU."""

import json
import math
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from fmi.model import ModelError
from stickslip_drive.model import ServoDrive
from stickslip_drive.motion import Inertia, Place, Pull
from stickslip_drive.setpoint import SetPoint

from .axes import Axis
from .coupled import FILTERED, servo

LONGEST = [(0.5, 0.0), (0.0, 0.5), (0.4, 0.18)]
"""Frequency and damping at the bound T_s (delta + sqrt(delta^2 + w^2)) = 1/2, where T_s is 1."""


@pytest.mark.parametrize(
    ("w", "d", "lag"),
    [(w, d, 0.0) for w, d in LONGEST]
    + [(0.4, 0.18, lag) for lag in (1e-300, 1e-6, 0.1, 0.499, 1.0, 1.001, 3.0, 1e6, 1e300)],
)
def test_a_sample_as_long_as_may_be_is_solved_to_rounding_with_any_lag(
    w: float, d: float, lag: float
) -> None:
    # Units in which a sample and the inertia are 1.
    place = Place(0.25, -1.0, 4.0 if lag else 1.5)
    pull = Pull(1.5, 0.5, 0.75)
    found = Inertia(1.0, d, w * w, lag, 0.0).moved(1.0, place, pull)
    # State: way, speed, motor's force, time, 1. Shorter lags are over at once.
    rates = np.zeros((5, 5))
    rates[0, 1] = rates[3, 4] = 1.0
    rates[1] = -w * w, -d, 1.0, w * w * pull.speed, -pull.at_zero
    fall = 1.0 / max(lag, 1e-8) if lag else 0.0
    rates[2, [2, 4]] = -fall, pull.command * fall
    x, v, F_motor, *_ = expm(rates) @ np.array([*place, 0.0, 1.0])
    # Rounding of some numbers around 1, and that of a matrix whose largest entry is 4 / lag.
    assert found == pytest.approx((x, v, F_motor), abs=1e-13 + 4e-15 * fall)


RAMP = Pull(2.0, -0.5, -2.0)


@pytest.mark.parametrize(
    ("numbers", "start", "pull"),
    [
        # Of viscous friction, spring, lag and dry friction, where the inertia is 1.
        ((0.0, 0.16, 0.0, 1.0), Place(0.25, 0.3, 2.0), RAMP),
        ((0.0, 0.16, 0.0, 1.0), Place(0.25, 0.0, 0.9), RAMP._replace(command=0.9)),
        ((0.18, 0.16, 0.05, 1.0), Place(0.25, 0.3, 4.0), RAMP._replace(command=-2.0)),
        ((0.0, 0.16, 0.7, 1.0), Place(0.25, 0.3, 4.0), RAMP._replace(command=0.9)),
        ((0.18, 0.16, 0.7, 1.0), Place(0.25, -0.3, 4.0), RAMP),
        ((0.0, 0.16, 0.7, 1.0), Place(0.25, 0.0, 4.0), RAMP._replace(command=-2.0)),
        # At rest until the lag lets it break away, at 0.3 ln 2.
        ((0.0, 0.0, 0.3, 1.0), Place(0.0, 0.0, 0.0), Pull(2.0, 0.0, 0.0)),
        # A speed that would dip below 0 within a sample, and be above it at the end.
        ((0.0, 0.0, 0.05, 0.1), Place(0.0, 0.1, -5.0), Pull(1.0, 0.0, 0.0)),
    ],
)
def test_dry_friction_stops_holds_and_turns_as_friction_that_rises_steeply(
    numbers: tuple[float, ...], start: Place, pull: Pull
) -> None:
    d, k, lag, dry = numbers
    inertia = Inertia(1.0, *numbers)

    def rates(t: float, y: NDArray[np.float64]) -> list[float]:
        x, speed, F_motor = y
        force = F_motor - pull.at_zero - k * (x - pull.speed * t) - d * speed
        fall = (pull.command - F_motor) / lag if lag else 0.0
        return [speed, force - dry * math.tanh(speed / 1e-7), fall]

    place, parts = start, 4
    # The parts of a sample, each from where the one before ended: no state beside the place.
    for part in range(parts):
        later = pull._replace(at_zero=pull.at_zero - k * pull.speed * part / parts)
        place = inertia.moved(1.0 / parts, place, later)
    end = solve_ivp(rates, (0.0, 1.0), start, "Radau", rtol=1e-9, atol=1e-12).y[:, -1]
    # It creeps at some 1e-7 where the other holds, and is as late where the speed passes 0.
    assert place == pytest.approx(tuple(end), abs=2e-6)
    if k == 0.0:
        assert inertia.moved(1.0, start, pull) == pytest.approx(place, abs=1e-12)  # of rounding


@pytest.mark.parametrize(
    ("feed", "distance", "end"),
    # Backward; too short to reach the feed; for ever.
    [(-5e-3, 0.01, -0.01), (5e-3, 1e-4, 1e-4), (5e-3, 0.0, 5e-3 * (3.0 - 0.025))],
)
def test_a_move_is_the_integral_of_its_speed_and_ends_where_it_should(
    feed: float, distance: float, end: float
) -> None:
    set_point = SetPoint(feed, 0.1, distance)
    position, speed = np.array([set_point.at(time) for time in np.linspace(0.0, 3.0, 30001)]).T
    # The trapezoidal rule is exact but at the four corners, each off by a h^2 / 8 at most.
    integral = np.concatenate(([0.0], np.cumsum(0.5e-4 * (speed[1:] + speed[:-1]))))
    assert np.max(np.abs(integral - position)) < 4 * 0.1 * 1e-8 / 8 + 1e-15
    assert set_point.at(3.0) == pytest.approx((end, 0.0 if distance else feed), rel=1e-15)
    assert np.max(np.abs(speed)) <= 5e-3 * (1 + 1e-15)
    assert np.max(np.abs(np.diff(speed))) <= 0.1 * 1e-4 * (1 + 1e-9)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"dead_time": 0.26}, r"dead_time = 0\.26 s .* at most 1000 T_s, 0\.25 s"),
        ({"low_pass": 2000.0}, r"low_pass = 2000\.0 Hz .* below 1/\(2 T_s\), 2000 Hz"),
        ({"notch": 2500.0, "notch_damping": 0.5}, r"notch = 2500\.0 Hz .* 2000 Hz"),
        ({"notch": 200.0}, r"notch_damping = 0\.0 is out of range: above 0"),
        # Samples too long for the motion, by spring and by friction.
        ({"T_s": 3.86e-3, "d": 0.0}, r"T_s = 0\.00386 s .* at most 0\.00385 s with k = 4e\+07"),
        ({"d": 1e9}, r"T_s = 0\.00025 s is out of range.*d = 1e\+09"),
        ({"pitch": 1e-300}, r"m_d = .* is out of range"),
    ],
)
def test_the_fmu_refuses_what_cannot_be(changes: dict[str, float], words: str) -> None:
    # The longest sample is allowed.
    servo({"T_s": 3.84e-3, "d": 0.0})
    with pytest.raises(ValueError, match=words):
        servo(changes)


@pytest.mark.parametrize(
    "changes",
    [{"K_v": 60.0, "distance": 1e-4}, {**FILTERED, "lag": 1e-4, "dead_time": 7e-4, "dry": 50.0}],
)
def test_a_state_of_the_drive_goes_on_to_the_bit(changes: dict[str, float]) -> None:
    def go_on(model: ServoDrive) -> list[tuple[float, ...]]:
        shown = []
        for step in range(1, 40):
            model.set("F", 10.0 * step)
            model.set("x", 1e-7 * step)
            model.advance(0.0, 1.7e-4 * step)
            shown.append((model.drive.output, model.drive.x, model.x_command, *model.drive.memory))
        return shown

    model = servo(changes)
    go_on(model)
    frozen, saved = model.freeze(), json.loads(json.dumps(model.save()))
    expected = go_on(model)
    assert go_on(model) != expected
    thawed, restored = servo({}), servo({})
    thawed.thaw(frozen)
    restored.restore(saved)
    assert go_on(thawed) == go_on(restored) == expected
    for bad in ({}, {**saved, "time": None}, {**saved, "memory": saved["memory"][1:]}):
        with pytest.raises(ModelError):
            restored.restore(bad)


def test_the_fmu_starts_as_the_axis_is_and_has_no_findings(fmus: Path) -> None:
    file = str(fmus / "ServoDrive.fmu")
    assert validate_fmu(file) == []
    description = fmpy.read_model_description(file)
    variables = description.modelVariables
    starts = {each.name: float(each.start) for each in variables if each.causality == "parameter"}
    own = Axis().values["drive"]
    assert own == {name: starts[name] for name in own}
    assert not any(starts[name] for name in starts.keys() - own.keys())
    assert float(description.defaultExperiment.stepSize) == own["T_s"]
    assert all(each.dependencies == [] for each in description.outputs)
    assert all(each.unit for each in variables if each.type == "Real")
