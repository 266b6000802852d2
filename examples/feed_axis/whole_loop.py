"""The whole loop as one simulation, without FMUs: the second opinion on the co-simulation.

Between two commands of the motor's force, and between two transitions of the friction, everything
is linear, so the motion is a matrix exponential; transitions are located by root finding. Nothing
here is shared with the drive's FMU or with the block.
"""

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
from numpy.typing import NDArray
from scipy import signal
from scipy.linalg import expm
from scipy.optimize import brentq

from fmi.system import Values

Vector = NDArray[np.float64]

# State: motor position and speed, table position and speed, motor force; then what is constant
# between transitions and commands: friction of the slideway, without its viscous part, which is in
# the matrix, dry friction of the motor, and the force that the motor's tends to.
_X_MOTOR, _V_MOTOR, _X, _X_DOT, _F_MOTOR, _FRICTION, _DRY, _COMMAND = range(8)
_SIZE = 8
_COLUMNS = {"x": _X, "x_dot": _X_DOT, "x_motor": _X_MOTOR, "F_motor": _F_MOTOR}
_LOOKS = 8
"""Looks for a transition per stretch: at most 31 us apart, in a slip that lasts 9 ms or more."""
_SAME = 1e-9
"""Times closer than this, relative to a sample, are the same."""


_FILTERS = ("low_pass", "low_pass_damping", "notch", "notch_damping", "notch_depth")


class _Numbers(SimpleNamespace):
    """The parameters of both FMUs by name, and `m_d`, the inertia of the drive at the slide."""


@dataclass
class Trajectory:
    """Times [s] and states at the samples; times [s] and lengths [m] of the completed slips."""

    k: float
    time: list[float] = field(default_factory=list)
    state: list[Vector] = field(default_factory=list)
    jumps: list[tuple[float, float]] = field(default_factory=list)

    def column(self, name: str) -> Vector:
        """Return `x`, `x_dot`, `x_motor`, `F_motor` or `F` [SI] at the samples."""
        states = np.array(self.state)
        if name == "F":
            force: Vector = self.k * (states[:, _X_MOTOR] - states[:, _X])
            return force
        chosen: Vector = states[:, _COLUMNS[name]]
        return chosen


def solve(
    values: Values, stop_time: float, course: Sequence[tuple[float, float]] | None = None
) -> Trajectory:
    """Simulate the loop from rest; one row at each sample of the controller, the end included.

    Parameters
    ----------
    values
        Start values of both FMUs, `system.start_values`.
    stop_time
        End [s].
    course
        Times [s] and speeds [m/s] between which the set point's speed changes evenly; None: as the
        drive's own.
    """
    axis = _Numbers(**{**dict.fromkeys(_FILTERS, 0.0), **values["drive"], **values["table"]})
    axis.m_d = axis.J * (2.0 * math.pi / axis.pitch) ** 2
    plant, control = _Plant(axis), _Control(axis)
    result = Trajectory(axis.k)
    state = np.zeros(_SIZE)
    times = axis.T_s * np.arange(round(stop_time / axis.T_s) + 1.0)
    positions, speeds = _commanded(_course(axis) if course is None else course, times)
    delay = axis.dead_time / axis.T_s
    whole = math.floor(delay + _SAME)
    late = max(delay - whole, 0.0) * axis.T_s
    late = late if late > _SAME * axis.T_s else 0.0
    waiting = deque([0.0] * (whole + 1))
    rows = zip(times.tolist(), positions.tolist(), speeds.tolist(), strict=True)
    for time, position, speed in rows:
        result.time.append(time)
        result.state.append(state.copy())
        waiting.append(control.force(position, speed, float(state[_X_MOTOR]), float(state[_X])))
        # For the first part of the sample the command of one sample more ago still acts.
        waiting.popleft()
        if late:
            state = plant.advance(time, state, late, result.jumps)
        plant.command(state, waiting[0])
        state = plant.advance(time + late, state, axis.T_s - late, result.jumps)
    return result


class _Plant:
    """Drive and table: `table` and `motor` are the directions of motion, 0 at rest.

    Without dry friction the motor always moves.
    """

    def __init__(self, axis: _Numbers) -> None:
        self._axis = axis
        self._k, self._dry = axis.k, axis.dry
        self._F_s = axis.mu_s * axis.m * axis.g
        self._F_k = axis.mu_k * axis.m * axis.g
        self._table = 0
        self._motor = 0 if axis.dry else 1
        self._left_at = 0.0
        self._rates = {
            (slips, moves): _rates(axis, slips=slips, moves=moves)
            for slips in (False, True)
            for moves in (False, True)
        }
        self._looks: dict[tuple[tuple[bool, bool], float], Vector] = {}

    def command(self, state: Vector, force: float) -> None:
        state[_COMMAND] = force
        if not self._axis.lag:
            state[_F_MOTOR] = force

    def advance(
        self, time: float, state: Vector, duration: float, jumps: list[tuple[float, float]]
    ) -> Vector:
        """Return the state after a duration [s], and add the slips that were completed."""
        whole = duration
        while duration > 0.0:
            margins = self._margins(state[None])[0]
            if margins.min() < 0.0:
                # A command has moved the motor off at once.
                self._turn(int(margins.argmin()), time, state, jumps)
            looks = self._seen(duration, keep=duration == whole) @ state
            ended = self._margins(looks) <= 0.0
            if not ended.any():
                last: Vector = looks[-1]
                return last
            # A transition before this look: go up to it, and begin anew there.
            look = int(ended.any(axis=1).argmax())
            start, end = duration / _LOOKS * look, duration / _LOOKS * (look + 1)
            crossing, which = min(
                (self._crossing(state, which, start, end), which)
                for which in np.flatnonzero(ended[look]).tolist()
            )
            state = self._moved(state, crossing)
            time, duration = time + crossing, duration - crossing
            self._turn(which, time, state, jumps)
        return state

    def _crossing(self, state: Vector, which: int, start: float, end: float) -> float:
        """Return when between two times [s] a margin vanishes."""

        def margin(tau: float) -> float:
            return float(self._margins(self._moved(state, tau)[None])[0, which])

        if margin(start) <= 0.0:
            # What begins at rest rises first, or does not move.
            inside = np.linspace(start, end, 2 * _LOOKS)[1:-1].tolist()
            start = next((tau for tau in inside if margin(tau) > 0.0), end)
        return float(brentq(margin, start, end, xtol=1e-17)) if start < end else end

    def _seen(self, duration: float, *, keep: bool) -> Vector:
        """Return the matrices of the looks in a duration [s]."""
        key = self._mode, duration
        found = self._looks.get(key)
        if found is None:
            step = expm(self._rates[self._mode] * (duration / _LOOKS))
            found = np.array([np.linalg.matrix_power(step, n + 1) for n in range(_LOOKS)])
            if keep:
                self._looks[key] = found
        return found

    @property
    def _mode(self) -> tuple[bool, bool]:
        return self._table != 0, self._motor != 0

    def _moved(self, state: Vector, h: float) -> Vector:
        moved: Vector = expm(self._rates[self._mode] * h) @ state
        return moved

    def _margins(self, states: Vector) -> Vector:
        """Return what is left before the next transition, of table and motor, for rows of states.

        It is force in stick and speed in slip.
        """
        pull = self._k * (states[:, _X_MOTOR] - states[:, _X])
        of_table = self._table * states[:, _X_DOT] if self._table else self._F_s - np.abs(pull)
        if not self._dry:
            of_motor = np.ones(len(states))
        elif self._motor:
            of_motor = self._motor * states[:, _V_MOTOR]
        else:
            of_motor = self._dry - np.abs(states[:, _F_MOTOR] - pull)
        return np.column_stack((of_table, of_motor))

    def _turn(
        self, which: int, time: float, state: Vector, jumps: list[tuple[float, float]]
    ) -> None:
        """Make the transition of the table (0) or of the motor (1)."""
        pull = self._k * float(state[_X_MOTOR] - state[_X])
        push = float(state[_F_MOTOR]) - pull
        if which == 1:
            stops = self._motor != 0 and abs(push) <= self._dry
            self._motor = 0 if stops else int(np.sign(push))
            state[_V_MOTOR] = 0.0
            state[_DRY] = self._motor * self._dry
            return
        if self._table == 0:
            self._table = 1 if pull > 0.0 else -1
        else:
            jumps.append((time, float(state[_X]) - self._left_at))
            self._table = 0 if abs(pull) <= self._F_s else -self._table
        self._left_at = float(state[_X])
        state[_X_DOT] = 0.0
        state[_FRICTION] = self._table * self._F_k


def _rates(axis: _Numbers, *, slips: bool, moves: bool) -> Vector:
    """Return the matrix of d state/dt = rates @ state, by whether table and motor move."""
    rates = np.zeros((_SIZE, _SIZE))
    if moves:
        rates[_X_MOTOR, _V_MOTOR] = 1.0
        rates[_V_MOTOR, [_X_MOTOR, _X]] = -axis.k / axis.m_d, axis.k / axis.m_d
        rates[_V_MOTOR, _V_MOTOR] = -axis.d / axis.m_d
        rates[_V_MOTOR, [_F_MOTOR, _DRY]] = 1.0 / axis.m_d, -1.0 / axis.m_d
    if axis.lag:
        rates[_F_MOTOR, [_F_MOTOR, _COMMAND]] = -1.0 / axis.lag, 1.0 / axis.lag
    if slips:
        rates[_X, _X_DOT] = 1.0
        rates[_X_DOT, [_X_MOTOR, _X]] = axis.k / axis.m, -axis.k / axis.m
        rates[_X_DOT, _X_DOT] = -axis.c / axis.m
        rates[_X_DOT, _FRICTION] = -1.0 / axis.m
    return rates


class _Control:
    """The sampled controller, written from docs/feed-axis.md (2)."""

    def __init__(self, axis: _Numbers) -> None:
        self._axis = axis
        self._integral = self._before = 0.0
        self._filters = [_Sampled(*each, axis.T_s) for each in _filters(axis)]

    def force(self, command: float, command_speed: float, x_motor: float, x: float) -> float:
        """Return the force [N] that the motor is told, by set point and positions at a sample."""
        axis = self._axis
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
        force = float(min(max(unlimited, -axis.F_max), axis.F_max))
        if force == unlimited or growth * force <= 0.0:
            self._integral += growth
        for each in self._filters:
            force = each.passed(force)
        return force


class _Sampled:
    """A filter of the force, sampled, in state space.

    Its transfer function has coefficients above and below of (s/w)^n downwards; at the frequency
    [Hz], that of w, the sampled filter does what the other does.
    """

    def __init__(
        self, above: Sequence[float], below: Sequence[float], frequency: float, T_s: float
    ) -> None:
        w = 2.0 / T_s * math.tan(math.pi * frequency * T_s)
        powers = w ** -np.arange(len(below) - 1.0, -1.0, -1.0)
        sampled = signal.bilinear(above * powers, below * powers, fs=1.0 / T_s)
        self._A, self._B, self._C, self._D = signal.tf2ss(*sampled)
        self._state = np.zeros((len(below) - 1, 1))

    def passed(self, force: float) -> float:
        out = float((self._C @ self._state)[0, 0]) + float(self._D[0, 0]) * force
        self._state = self._A @ self._state + self._B * force
        return out


def _filters(axis: _Numbers) -> list[tuple[list[float], list[float], float]]:
    found: list[tuple[list[float], list[float], float]] = []
    if axis.low_pass and axis.low_pass_damping:
        found.append(([0, 0, 1], [1, 2 * axis.low_pass_damping, 1], axis.low_pass))
    elif axis.low_pass:
        found.append(([0, 1], [1, 1], axis.low_pass))
    if axis.notch:
        width = 2 * axis.notch_damping
        found.append(([1, width * axis.notch_depth, 1], [1, width, 1], axis.notch))
    return found


def _counted(position: float, resolution: float) -> float:
    return resolution * math.floor(position / resolution + 0.5) if resolution else position


def _course(axis: _Numbers) -> Sequence[tuple[float, float]]:
    """Return the corners of the trapezoid of the set point: times [s] and speeds [m/s]."""
    peak = axis.feed
    if axis.distance:
        peak = min(peak, math.sqrt(axis.acceleration * axis.distance))
    corners = [(0.0, 0.0), (peak / axis.acceleration, peak)]
    if axis.distance:
        end = axis.distance / peak
        corners += [(end, peak), (end + peak / axis.acceleration, 0.0)]
    return corners


def _commanded(course: Sequence[tuple[float, float]], times: Vector) -> tuple[Vector, Vector]:
    """Return positions and speeds of the set point, whose speed is linear between its corners."""
    corners, at_corners = np.array(course).T
    speeds = np.interp(times, corners, at_corners)
    ways = 0.5 * (at_corners[1:] + at_corners[:-1]) * np.diff(corners)
    passed = np.concatenate(([0.0], np.cumsum(ways)))
    last = np.searchsorted(corners, times, side="right") - 1
    positions = passed[last] + 0.5 * (at_corners[last] + speeds) * (times - corners[last])
    return positions, speeds
