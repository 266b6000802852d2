"""The open loop of a servo axis over frequency, with its margins."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from ..axis import Axis
from ..one_thread import one_thread
from .system import MOTOR, TABLE, Mode, System, Vector

Complex = NDArray[np.complex128]
Cut = Literal["force", "position"]

_POINTS: Final = 600
_NOTHING: Final = 1e-9
"""A gain that is rounding alone."""
_LOWEST: Final = 1e-2
"""The lowest frequency, relative to the position gain."""


@dataclass(frozen=True)
class Response:
    """The open loop, cut at one place."""

    cut: Cut
    """"force": where the motor's force is commanded; "position": at the position error."""
    sliding: bool
    """Whether the table slides, or is stuck."""
    frequency: Vector
    """[Hz], rising, up to half the sampling."""
    gain: Complex
    """Of the open loop, complex [-]; the loop closes with its negative."""
    gain_margin: float
    phase_margin: float
    """The smallest factor on the gain, above 1, at which the closed loop is at its limit, and the
    smallest lag that brings it there [rad]; infinite without one."""
    gain_margin_at: float
    phase_margin_at: float
    """Their frequencies [Hz]; NaN without one."""
    delay_margin: float
    """The shortest dead time that brings it there [s]; infinite without one."""

    @property
    def passes(self) -> bool:
        """Whether anything passes the open loop: no motion of a table that is stuck."""
        return float(np.abs(self.gain).max()) > _NOTHING


@one_thread
def open_loop(axis: Axis, cut: Cut, *, sliding: bool = True) -> Response:
    """Return the open loop of a servo axis, its table sliding in one direction or stuck."""
    system = System(axis)
    drive = system.drive
    step, into, out = _opened(system, cut, system.sliding if sliding else Mode(0, 1))
    low, high = _LOWEST * max(drive.K_v, 1.0) / (2.0 * math.pi), 0.5 / drive.T_s
    frequency = np.geomspace(low, 0.999 * high, _POINTS)

    def gain(f: float) -> complex:
        z = np.exp(2j * math.pi * f * drive.T_s)
        return complex(-(out @ np.linalg.solve(z * np.eye(len(step)) - step, into)))

    values = np.array([gain(float(f)) for f in frequency])
    turned = np.flatnonzero((values.imag[:-1] * values.imag[1:] < 0.0) & (values.real[:-1] < 0.0))
    crossings = _roots(lambda f: gain(f).imag, frequency, turned)
    factors = [(-1.0 / gain(f).real, f) for f in crossings if gain(f).real < 0.0]
    size = np.abs(values)
    passed = np.flatnonzero((size[:-1] - 1.0) * (size[1:] - 1.0) < 0.0)
    unit = _roots(lambda f: abs(gain(f)) - 1.0, frequency, passed)
    lags = [((math.pi + np.angle(gain(f))) % (2.0 * math.pi), f) for f in unit]
    delays = [lag / (2.0 * math.pi * f) for lag, f in lags]
    none = (math.inf, math.nan)
    gain_margin = min((factor for factor in factors if factor[0] > 1.0), default=none)
    phase_margin = min(lags, default=none)
    return Response(
        cut, sliding, frequency, values,
        gain_margin[0], float(phase_margin[0]), gain_margin[1], phase_margin[1],
        float(min(delays, default=math.inf)),
    )  # fmt: skip


def _opened(system: System, cut: Cut, mode: Mode) -> tuple[NDArray[np.float64], Vector, Vector]:
    """Return the motion with the loop open, how what is fed in enters, and what comes out.

    The state is that just before a sample.
    """
    moving, layout, drive = system.moving, system.layout, system.drive
    after = np.eye(layout.size)
    for part in system.steps(mode):
        after = part @ after
    control = system.control.copy()
    if cut == "force":
        out = control[layout.commands].copy()
        control[layout.commands] = 0.0
        into = after[:, layout.commands]
    else:
        place = TABLE if drive.on_table else MOTOR
        out = np.zeros(layout.size)
        out[place] = -1.0
        # What the error does in the controller is what the command does.
        by_error = control[:, layout.command].copy()
        by_error[layout.command] = 0.0
        control[:, place] += by_error
        into = after @ by_error
    step = (after @ control)[moving, moving]
    return step, into[moving], out[moving]


def _roots(f: Callable[[float], float], at: Vector, places: NDArray[np.intp]) -> list[float]:
    """Return the roots of a function between some of the frequencies and the next ones."""
    return [float(brentq(f, at[place], at[place + 1], rtol=1e-12)) for place in places]
