"""The digital controller: position P, velocity PI, feed-forward, limit; one call a sample."""

from __future__ import annotations

import math
from typing import NamedTuple

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


class Controller:
    """The controller and its memory: integral [N], last motor position [m], last error [m]."""

    def __init__(self, gains: Gains, set_point: SetPoint) -> None:
        self._gains = gains
        self._set_point = set_point
        self.integral = 0.0
        self.error = 0.0
        self._last_motor = 0.0

    @property
    def memory(self) -> tuple[float, float, float]:
        """Everything that the next sample depends on."""
        return self.integral, self.error, self._last_motor

    @memory.setter
    def memory(self, memory: tuple[float, float, float]) -> None:
        self.integral, self.error, self._last_motor = memory

    def sample(self, time: float, motor: float, table: float) -> float:
        """Return the motor force [N] to hold until the next sample.

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
        if abs(force) > gains.F_max:
            force = math.copysign(gains.F_max, force)
            if force * step > 0.0:
                # Beyond the limit the integral would wind up without any effect.
                return force
        self.integral += step
        return force


def _encoded(position: float, resolution: float) -> float:
    """Return the position as an encoder gives it: in whole counts; exact at resolution 0."""
    if resolution <= 0.0:
        return position
    return resolution * math.floor(position / resolution + 0.5)
