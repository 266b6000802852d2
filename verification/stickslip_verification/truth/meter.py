"""The cycle meter: its readings from the times of break-away and end of slip. docs/theory.md (16).

In high precision a length of time may be the difference of two times.
"""

from __future__ import annotations

from stickslip_verification.truth.parameters import Context, Number


class Meter:
    """The cycle meter of one run.

    `readings` are its outputs by name, SI, 0 until first written; `stick_start` [s] is when the
    last stick began.
    """

    def __init__(self, context: Context, start_time: Number) -> None:
        zero = context.zero
        names = ("delta_x", "spring_drop", "t_stick", "t_slip", "T", "f", "x_dot_peak")
        self.readings: dict[str, Number] = dict.fromkeys(names, zero)
        self.readings |= {"n_slips": 0, "t_event": start_time}
        self._zero = zero
        self.stick_start = start_time
        self._last_break_away: Number | None = None
        self._slip_start: tuple[Number, Number, Number] | None = None
        self._direction = 0
        self._top_speed = zero

    def begin_slip(self, time: Number, direction: int, x: Number, z: Number) -> None:
        """Mark where a slip begins: time [s], s, mass [m] and spring [m]."""
        self._slip_start = (time, x, z)
        self._direction = direction
        self._top_speed = self._zero

    def break_away(self, time: Number) -> None:
        """Write what a break-away at `time` [s] shows."""
        self.readings["t_stick"] = time - self.stick_start
        if self._last_break_away is not None:
            T = time - self._last_break_away
            self.readings |= {"T": T, "f": 1 / T}
        self._last_break_away = time
        self.readings["t_event"] = time

    def speed_reached(self, top_speed: Number) -> None:
        """Note the largest speed [m/s] along one stretch of the slip under way."""
        self._top_speed = max(self._top_speed, top_speed)

    def end_slip(self, time: Number, x: Number, z: Number) -> None:
        """Write what the end of a slip at `time` [s] shows, mass at x [m], spring at z [m]."""
        assert self._slip_start is not None
        start_time, start_x, start_z = self._slip_start
        self.readings["t_slip"] = time - start_time
        self.readings["delta_x"] = x - start_x
        self.readings["spring_drop"] = start_z - z
        self.readings["x_dot_peak"] = self._direction * self._top_speed
        self.readings["n_slips"] += 1
        self.readings["t_event"] = time
        self._slip_start = None
