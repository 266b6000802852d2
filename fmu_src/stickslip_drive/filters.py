"""The way of the torque command to the motor: filters, a low pass and a notch, sampled.

By the bilinear transform with the frequency kept, s/w = (z - 1)/((z + 1) t), t = tan(w T_s/2),
docs/feed-axis.md (2).
"""

from __future__ import annotations

import math
from typing import NamedTuple

# Samples that a command may wait: each is part of the state.
_LONGEST = 1000


class Filter(NamedTuple):
    """A filter y = b0 u + b1 u' + b2 u'' - a1 y' - a2 y'', whose strokes are samples before."""

    b0: float
    b1: float
    b2: float
    a1: float
    a2: float

    def passed(self, force: float, first: float, second: float) -> tuple[float, float, float]:
        """Return what a sample makes of a force [N] and of the two numbers that it remembers."""
        out = self.b0 * force + first
        first = self.b1 * force - self.a1 * out + second
        return out, first, self.b2 * force - self.a2 * out


def low_pass(frequency: float, damping: float, T_s: float) -> Filter:
    """Return a low pass.

    Parameters
    ----------
    frequency
        Its corner [Hz], below half the sampling.
    damping
        Damping ratio [-]; 0: of first order.
    T_s
        Sample time [s].
    """
    t = math.tan(math.pi * frequency * T_s)
    if damping <= 0.0:
        b = t / (1.0 + t)
        return Filter(b, b, 0.0, (t - 1.0) / (1.0 + t), 0.0)
    scale = 1.0 + 2.0 * damping * t + t * t
    b = t * t / scale
    return Filter(b, 2.0 * b, b, *_poles(damping, t))


def notch(frequency: float, damping: float, depth: float, T_s: float) -> Filter:
    """Return a notch.

    Parameters
    ----------
    frequency
        What it takes out [Hz], below half the sampling.
    damping
        Damping ratio of its poles [-], above 0; its width is twice that, times the frequency.
    depth
        What it leaves at its frequency [-].
    T_s
        Sample time [s].
    """
    t = math.tan(math.pi * frequency * T_s)
    scale = 1.0 + 2.0 * damping * t + t * t
    left = 2.0 * depth * damping * t
    a1, a2 = _poles(damping, t)
    return Filter((1.0 + left + t * t) / scale, a1, (1.0 - left + t * t) / scale, a1, a2)


def objection(
    T_s: float, dead_time: float, low_pass: float, notch: float, notch_damping: float
) -> str | None:
    """Return why a command cannot go this way to the motor, with name, value, range; else None.

    Parameters
    ----------
    T_s, dead_time
        Sample time, and the time from a sample to when its command acts [s].
    low_pass, notch
        Frequencies of the filters [Hz]; 0: none.
    notch_damping
        Damping ratio of the notch's poles [-].
    """
    if dead_time > _LONGEST * T_s:
        return (
            f"dead_time = {dead_time!r} s is out of range: it must be at most {_LONGEST} T_s, "
            f"{_LONGEST * T_s:.4g} s"
        )
    for name, frequency in (("low_pass", low_pass), ("notch", notch)):
        if not frequency * T_s < 0.5:
            return (
                f"{name} = {frequency!r} Hz is out of range: it must be below 1/(2 T_s), "
                f"{0.5 / T_s:.4g} Hz"
            )
    if notch > 0.0 and not notch_damping > 0.0:
        return f"notch_damping = {notch_damping!r} is out of range: above 0 where there is a notch"
    return None


def _poles(damping: float, t: float) -> tuple[float, float]:
    """Return a1 and a2 of poles of a damping ratio."""
    scale = 1.0 + 2.0 * damping * t + t * t
    return 2.0 * (t * t - 1.0) / scale, (1.0 - 2.0 * damping * t + t * t) / scale
