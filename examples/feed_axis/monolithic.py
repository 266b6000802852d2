"""The whole loop as one simulation, without FMUs: the second opinion on the co-simulation.

Between two samples, and between two transitions of the friction, everything is linear, so the
motion is a matrix exponential; transitions are located by root finding. Nothing here is shared
with the drive's FMU or with the block.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm
from scipy.optimize import brentq

from .axis import Axis

Vector = NDArray[np.float64]

# State: motor position and speed, table position and speed, motor force, friction, viscous part
# of the slideway's friction being in the matrix.
_X_MOTOR, _V_MOTOR, _X, _X_DOT, _F_MOTOR, _FRICTION = range(6)

_LOOKS = 8
"""Looks for a transition per sample: 31 us of a slip that lasts 9 ms or more."""


@dataclass
class Trajectory:
    """The motion at the samples: times [s], and a row of the state for each."""

    time: list[float] = field(default_factory=list)
    state: list[Vector] = field(default_factory=list)
    command: list[float] = field(default_factory=list)
    jumps: list[tuple[float, float]] = field(default_factory=list)
    """Time [s] and length [m] of each completed slip."""

    def column(self, name: str, axis: Axis) -> Vector:
        """Return `time`, `x`, `x_dot`, `x_motor`, `F` or `x_command` [SI] at the samples."""
        if name == "time":
            return np.array(self.time)
        if name == "x_command":
            return np.array(self.command)
        states = np.array(self.state)
        if name == "F":
            stretch: Vector = states[:, _X_MOTOR] - states[:, _X]
            return axis.k * stretch
        where = {"x": _X, "x_dot": _X_DOT, "x_motor": _X_MOTOR, "F_motor": _F_MOTOR}[name]
        chosen: Vector = states[:, where]
        return chosen


def solve(axis: Axis, stop_time: float) -> Trajectory:
    """Simulate the loop from rest; one row at each sample of the controller, the end included.

    Parameters
    ----------
    axis
        The numbers of the axis.
    stop_time
        End [s].
    """
    plant, control = _Plant(axis), _Control(axis)
    result = Trajectory()
    state = np.zeros(6)
    samples = round(stop_time / axis.T_s)
    for sample in range(samples + 1):
        time = sample * axis.T_s
        result.time.append(time)
        result.state.append(state.copy())
        result.command.append(_commanded(axis, time)[0])
        state[_F_MOTOR] = control.force(time, state[_X_MOTOR], state[_X])
        state = plant.advance(time, state, axis.T_s, result.jumps)
    return result


class _Plant:
    """Drive and table; `mode` is the direction in which the table slips, 0 while it sticks."""

    def __init__(self, axis: Axis) -> None:
        self._k = axis.k
        self._F_s = axis.mu_s * axis.m * axis.g
        self._F_k = axis.mu_k * axis.m * axis.g
        self._mode = 0
        self._left_at = 0.0
        self._glance = axis.T_s / _LOOKS
        self._rates = {0: _rates(axis, slips=False), 1: _rates(axis, slips=True)}
        self._glances = {key: expm(rates * self._glance) for key, rates in self._rates.items()}

    def advance(
        self, time: float, state: Vector, duration: float, jumps: list[tuple[float, float]]
    ) -> Vector:
        end = time + duration
        while end - time > 1e-15:
            h = min(self._glance, end - time)
            after = self._moved(state, h)
            margin = self._margin(after)
            if margin > 0.0:
                state, time = after, time + h
                continue
            # A transition within this glance: go up to it, and begin anew there.
            crossing = h if self._margin(state) <= 0.0 else self._crossing(state, h)
            state, time = self._moved(state, crossing), time + crossing
            self._turn(time, state, jumps)
        return state

    def _crossing(self, state: Vector, h: float) -> float:
        """Return when within h [s] the margin vanishes."""
        return float(brentq(lambda tau: self._margin(self._moved(state, tau)), 0.0, h, xtol=1e-17))

    def _moved(self, state: Vector, h: float) -> Vector:
        key = abs(self._mode)
        step = self._glances[key] if h == self._glance else expm(self._rates[key] * h)
        moved: Vector = step @ state
        return moved

    def _margin(self, state: Vector) -> float:
        """Return what is left before the next transition: of force in stick, of speed in slip."""
        if self._mode == 0:
            return float(self._F_s - abs(self._k * (state[_X_MOTOR] - state[_X])))
        # A slip begins at rest; that is no end of it.
        speed = self._mode * float(state[_X_DOT])
        return speed if speed != 0.0 else self._F_s

    def _turn(self, time: float, state: Vector, jumps: list[tuple[float, float]]) -> None:
        pull = self._k * float(state[_X_MOTOR] - state[_X])
        if self._mode == 0:
            self._mode = 1 if pull > 0.0 else -1
            self._left_at = float(state[_X])
        else:
            jumps.append((time, float(state[_X]) - self._left_at))
            self._left_at = float(state[_X])
            self._mode = 0 if abs(pull) <= self._F_s else -self._mode
        state[_X_DOT] = 0.0
        state[_FRICTION] = self._mode * self._F_k


def _rates(axis: Axis, *, slips: bool) -> Vector:
    """Return the matrix of d state/dt = rates @ state."""
    rates = np.zeros((6, 6))
    rates[_X_MOTOR, _V_MOTOR] = 1.0
    rates[_V_MOTOR, [_X_MOTOR, _X]] = -axis.k / axis.m_d, axis.k / axis.m_d
    rates[_V_MOTOR, _V_MOTOR] = -axis.d / axis.m_d
    rates[_V_MOTOR, _F_MOTOR] = 1.0 / axis.m_d
    if slips:
        rates[_X, _X_DOT] = 1.0
        rates[_X_DOT, [_X_MOTOR, _X]] = axis.k / axis.m, -axis.k / axis.m
        rates[_X_DOT, _X_DOT] = -axis.c / axis.m
        rates[_X_DOT, _FRICTION] = -1.0 / axis.m
    return rates


class _Control:
    """The sampled controller, written from docs/feed-axis.md (2)."""

    def __init__(self, axis: Axis) -> None:
        self._axis = axis
        self._integral = 0.0
        self._before = 0.0

    def force(self, time: float, x_motor: float, x: float) -> float:
        axis = self._axis
        command, command_speed = _commanded(axis, time)
        motor = _counted(x_motor, axis.resolution_motor)
        speed = (motor - self._before) / axis.T_s
        self._before = motor
        error = command - (_counted(x, axis.resolution_table) if axis.on_table else motor)
        if abs(error) <= axis.dead_band:
            error = 0.0
        deviation = axis.K_v * error + axis.velocity_feedforward * command_speed - speed
        growth = axis.K_p * deviation * axis.T_s / axis.T_n if axis.T_n else 0.0
        feed_forward = axis.friction_feedforward * float(np.sign(command_speed))
        unlimited = axis.K_p * deviation + self._integral + growth + feed_forward
        force = float(np.clip(unlimited, -axis.F_max, axis.F_max))
        if force == unlimited or growth * force <= 0.0:
            self._integral += growth
        return force


def _counted(position: float, resolution: float) -> float:
    return resolution * float(np.floor(position / resolution + 0.5)) if resolution else position


def _commanded(axis: Axis, time: float) -> tuple[float, float]:
    """Return position and speed of the set point: the integral of a trapezoid, by its corners."""
    peak = abs(axis.feed)
    if axis.distance:
        peak = min(peak, float(np.sqrt(axis.acceleration * axis.distance)))
    if peak == 0.0:
        return 0.0, 0.0
    ramp = peak / axis.acceleration
    corners = [0.0, ramp]
    speeds = [0.0, peak]
    if axis.distance:
        corners += [axis.distance / peak, axis.distance / peak + ramp]
        speeds += [peak, 0.0]
    speed = float(np.interp(time, corners, speeds))
    inside = [corner for corner in corners if corner < time]
    points = [*inside, time]
    values = [*(float(np.interp(corner, corners, speeds)) for corner in inside), speed]
    position = float(np.trapezoid(values, points))
    sign = float(np.sign(axis.feed))
    return sign * position, sign * speed
