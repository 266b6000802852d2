"""The set point: a feed that starts smoothly and goes on, or a move over a distance and a hold."""

from __future__ import annotations

import math
from typing import NamedTuple


class SetPoint(NamedTuple):
    """A trapezoid of speed over time, from rest at position 0.

    Attributes
    ----------
    feed
        Speed [m/s]; its sign is the direction.
    acceleration
        Acceleration and deceleration [m/s2], > 0.
    distance
        Length of the move [m]; 0 lets the feed go on for ever.
    """

    feed: float
    acceleration: float
    distance: float

    def at(self, time: float) -> tuple[float, float]:
        """Return commanded position [m] and speed [m/s] at a time [s] after the start."""
        speed = abs(self.feed)
        if self.distance > 0.0:
            # A short move brakes before it has reached the feed.
            speed = min(speed, math.sqrt(self.acceleration * self.distance))
        if time <= 0.0 or speed == 0.0:
            return 0.0, 0.0
        position, now = self._of_trapezoid(time, speed)
        return math.copysign(position, self.feed), math.copysign(now, self.feed)

    def _of_trapezoid(self, time: float, speed: float) -> tuple[float, float]:
        ramp = speed / self.acceleration
        if time < ramp:
            return 0.5 * self.acceleration * time * time, self.acceleration * time
        braking = self.distance / speed if self.distance > 0.0 else math.inf
        if time < braking:
            return speed * (time - 0.5 * ramp), speed
        left = braking + ramp - time
        if left <= 0.0:
            return self.distance, 0.0
        return self.distance - 0.5 * self.acceleration * left * left, self.acceleration * left
