"""The digital controller: position P, velocity PI, feed-forward, limit, filters.

It is called once a sample.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from . import filters
from .setpoint import SetPoint


class Gains(NamedTuple):
    """What the controller is set to, SI; the names are those of the FMU's parameters."""

    T_s: float
    K_v: float
    K_p: float
    T_n: float
    on_table: int
    dead_band: float
    velocity_feedforward: float
    friction_feedforward: float
    F_max: float
    resolution_motor: float
    resolution_table: float
    low_pass: float
    low_pass_damping: float
    notch: float
    notch_damping: float
    notch_depth: float


class Controller:
    """The controller and its memory.

    That is the integral [N], the last error and motor position [m], and what its filters remember.

    Parameters
    ----------
    gains
        What it is set to.
    set_point
        What it is told.
    """

    def __init__(self, gains: Gains, set_point: SetPoint) -> None:
        self._gains = gains
        self._set_point = set_point
        self.integral = 0.0
        self.error = 0.0
        self._last_motor = 0.0
        self._filters: list[filters.Filter] = []
        if gains.low_pass > 0.0:
            corner, damping = gains.low_pass, gains.low_pass_damping
            self._filters.append(filters.low_pass(corner, damping, gains.T_s))
        if gains.notch > 0.0:
            damping, depth = gains.notch_damping, gains.notch_depth
            self._filters.append(filters.notch(gains.notch, damping, depth, gains.T_s))
        self._filtered = (0.0,) * (2 * len(self._filters))

    @property
    def memory(self) -> tuple[float, ...]:
        """Everything that the next sample depends on."""
        return (self.integral, self.error, self._last_motor, *self._filtered)

    @memory.setter
    def memory(self, memory: tuple[float, ...]) -> None:
        self.integral, self.error, self._last_motor, *filtered = memory
        self._filtered = tuple(filtered)

    def sample(self, time: float, motor: float, table: float) -> float:
        """Return the force [N] that the motor is told until the next sample.

        Parameters
        ----------
        time
            Time since the start [s].
        motor, table
            Positions of motor (at the slide) and table [m], before the encoders.
        """
        gains = self._gains
        command, speed = self._set_point.at(time)
        motor = _encoded(motor, gains.resolution_motor)
        measured = _encoded(table, gains.resolution_table) if gains.on_table else motor
        velocity = (motor - self._last_motor) / gains.T_s
        self._last_motor = motor
        self.error = command - measured
        acted_on = 0.0 if abs(self.error) <= gains.dead_band else self.error
        wanted = gains.K_v * acted_on + gains.velocity_feedforward * speed
        lack = wanted - velocity
        step = gains.K_p / gains.T_n * gains.T_s * lack if gains.T_n > 0.0 else 0.0
        ahead = gains.friction_feedforward * ((speed > 0.0) - (speed < 0.0))
        force = gains.K_p * lack + self.integral + step + ahead
        limited = force
        if abs(force) > gains.F_max:
            limited = math.copysign(gains.F_max, force)
        # Beyond the limit the integral would wind up without any effect.
        if limited == force or limited * step <= 0.0:
            self.integral += step
        return self._passed(limited)

    def _passed(self, force: float) -> float:
        """Return what the filters make of a force [N]."""
        memory: list[float] = []
        for number, each in enumerate(self._filters):
            force, *own = each.passed(force, *self._filtered[2 * number : 2 * number + 2])
            memory += own
        self._filtered = tuple(memory)
        return force


def _encoded(position: float, resolution: float) -> float:
    """Return the position as an encoder gives it: in whole counts; exact at resolution 0."""
    if resolution <= 0.0:
        return position
    return resolution * math.floor(position / resolution + 0.5)
