"""Whether the loop of a servo axis is stable, how it swings; the open loop and its margins."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from stickslip_ref import Interval, merged

from ..axis import Axis, Drive
from ..one_thread import one_thread
from .native import over_sample
from .system import (
    INTEGRAL,
    MOTOR,
    SPEED,
    TABLE,
    Line,
    Matrix,
    Mode,
    System,
    Vector,
    line_at,
    system_of,
)

Eigenvalues = NDArray[np.complex128]

_ENDS: Final = ("eigenvalue", "eigenvalue")
_STUCK: Final = Mode(0, 1)
_FLAT: Final = Line(0.0, math.inf, 0.0, 0.0)

_FINER: Final = 1.05
"""Factor from gain to gain in the search for a limit."""
_MOST: Final = 1e3
"""How far beyond a gain its limit is searched."""
_IDLE: Final = 2.0
"""Time constant from which on a loop hardly acts [s]."""
_SLOWEST: Final = 1e-3
_FEEDS: Final = 160
"""Feeds at which the damping of a smooth fall is looked at, and the slowest over the first line's
end."""
_ROUNDING: Final = 1e-9
"""What the integral of a position that does not follow may differ from standing still."""


class Swing(NamedTuple):
    """A motion of a loop that swings."""

    damping: float
    """Damping ratio [-]; below 0 it grows."""
    w: float
    """Undamped frequency [rad/s]."""

    @property
    def frequency(self) -> float:
        """The frequency of the damped swing [Hz]."""
        return self.w * math.sqrt(max(1.0 - self.damping * self.damping, 0.0)) / (2.0 * math.pi)


class GainLimits(NamedTuple):
    """Limits of the gains for a stable loop, its table sliding or stuck; infinite if not found."""

    K_v: float
    """Position gain [1/s], the velocity loop held."""
    bandwidth: float
    """Bandwidth of the velocity loop [rad/s], its integral time times the bandwidth held, and the
    position gain."""


@one_thread
def swing(axis: Axis, *, sliding: bool = True, line: Line | None = None) -> Swing:
    """Return the least damped swing of a servo axis, its table sliding in one direction or stuck.

    `line` is the friction about the feed; else that of a fast table, which no longer falls.
    An eigenvalue z from sample to sample is a motion exp(s t) with s = ln(z)/T_s. Without a swing:
    damping infinite, frequency 0. What grows without a swing has the damping -1.
    """
    system = system_of(axis) if line is None else System(axis, (line,))
    return _swing(system, _eigenvalues(system, system.sliding if sliding else _STUCK))


def _swing(system: System, z: Eigenvalues) -> Swing:
    s = np.log(z[(z.imag > 0.0) | ((z.imag == 0.0) & (np.abs(z) > 1.0 + _ROUNDING))])
    s /= system.drive.T_s
    swings = [Swing(float(-root.real / abs(root)), float(abs(root))) for root in s]
    return min(swings, default=Swing(math.inf, 0.0))


def settling(axis: Axis) -> float:
    """Return the time in which a stable loop settles [s], at length; for `motion.Watched`."""
    drive = axis.drive
    assert drive is not None
    # Position loop and integral: it may wind up, and creep.
    slowest = min(drive.T_n + 1.0 / max(drive.K_v, 1.0 / _IDLE), _IDLE)
    return 8.0 * math.pi * math.sqrt(axis.m / axis.k) + 4.0 * slowest


@lru_cache(maxsize=256)
def decays(system: System, line: int) -> bool:
    """Return whether even motion decays where the friction of the table is one of its lines."""
    return bool(np.abs(_eigenvalues(system, Mode(1, 1, line))).max() < 1.0)


@one_thread
def unstable_feeds(axis: Axis) -> tuple[Interval, ...]:
    """Return the feeds [m/s] at which even motion of a servo axis grows into a swing.

    A falling friction takes damping away where it falls; elsewhere the loop is as `is_stable` says.
    """
    if axis.friction.law != "stribeck":
        return ()

    def damping(feed: float) -> float:
        return swing(axis, line=line_at(axis, feed)).damping

    lines = system_of(axis).lines
    if axis.friction.is_curve:
        grows = zip(lines, _dampings(axis, lines), strict=True)
        return merged([Interval(line.low, line.high, *_ENDS) for line, at in grows if at < 0.0])
    feeds = np.geomspace(_SLOWEST * lines[1].low, lines[-1].low, _FEEDS).tolist()
    values = _dampings(axis, [line_at(axis, feed) for feed in feeds])
    ends = [
        float(brentq(damping, feeds[n], feeds[n + 1], rtol=1e-9))
        for n in range(len(feeds) - 1)
        if (values[n] < 0.0) != (values[n + 1] < 0.0)
    ]
    if values[0] < 0.0:
        ends.insert(0, 0.0)
    return tuple(Interval(*pair, *_ENDS) for pair in zip(ends[::2], ends[1::2], strict=True))


def _dampings(axis: Axis, lines: Sequence[Line]) -> list[float]:
    """Return the damping of the least damped swing on each line of the friction."""
    system = System(axis, tuple(lines))
    modes = (Mode(1, 1, number) for number in range(len(lines)))
    found = np.linalg.eigvals(np.array([_step(system, mode) for mode in modes]))
    return [_swing(system, z.astype(np.complex128)).damping for z in found]


@one_thread
def is_stable(axis: Axis) -> bool:
    """Return whether no motion of a loop grows, table sliding or stuck; none of a rigid drive."""
    return axis.drive is None or _excess(system_of(axis)) < 0.0


@one_thread
def gain_limits(axis: Axis) -> GainLimits:
    """Return up to which gains the loop stays stable, the table sliding or stuck.

    Of a loop that is unstable as it is, below which of them it would be stable; 0 where below none.
    """
    drive = axis.drive
    assert drive is not None
    shape = drive.T_n * drive.bandwidth
    return GainLimits(
        _limit(axis, lambda K_v: replace(drive, K_v=K_v), drive.K_v),
        _limit(axis, lambda w: replace(drive, bandwidth=w, T_n=shape / w), drive.bandwidth),
    )


def _limit(axis: Axis, changed: Callable[[float], Drive], now: float) -> float:
    """Return the end of the stable values next to the one of now, above it if that is stable."""

    def excess(value: float) -> float:
        # Of the friction only its slope counts, and none is left at the highest speeds.
        return _excess(System(replace(axis, drive=changed(value)), (_FLAT,)))

    if now <= 0.0:
        return math.inf
    stable = excess(now) < 0.0
    at = now
    while now / _MOST < at < _MOST * now:
        following = at * _FINER if stable else at / _FINER
        if (excess(following) < 0.0) is not stable:
            return float(brentq(excess, at, following, xtol=1e-12 * at, rtol=1e-12))
        at = following
    return math.inf if stable else 0.0


def _excess(system: System) -> float:
    """Return the logarithm of the largest growth from sample to sample, sliding or stuck."""
    sliding, stuck = (np.abs(_eigenvalues(system, mode)).max() for mode in (system.sliding, _STUCK))
    # The integral over a table that is stuck stands still or grows evenly: an eigenvalue of 1.
    return math.log(max(float(sliding), float(stuck) * (1.0 - _ROUNDING)))


def _eigenvalues(system: System, mode: Mode) -> Eigenvalues:
    return np.linalg.eigvals(_step(system, mode)).astype(np.complex128)


def _step(system: System, mode: Mode) -> Matrix:
    """Return the motion from sample to sample, without set point and what stands still."""
    step = over_sample(system, mode)[system.moving, system.moving]
    still = ([] if mode.table else [TABLE, SPEED]) + ([] if system.drive.T_n > 0.0 else [INTEGRAL])
    return np.delete(np.delete(step, still, axis=0), still, axis=1)


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
    gain: NDArray[np.complex128]
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
    system = system_of(axis)
    drive = system.drive
    step, into, out = _opened(system, cut, system.sliding if sliding else _STUCK)
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
    after = over_sample(system, mode, controlled=False)
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
