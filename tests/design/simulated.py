"""A feed axis in a simulation without events: smooth friction, a stiff solver, the loop sampled.

It shares nothing with `stickslip_design.loop` but the numbers of an axis. The equations are those
of docs/feed-axis.md (1), (2) and docs/theory.md (19), (26); `simulated.c` solves them. Counts of
encoders and a dead band are left out.
"""

from __future__ import annotations

import ctypes
import math
import subprocess
from functools import cache
from pathlib import Path
from tempfile import mkdtemp
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.signal import bilinear

from stickslip_design.axis import Axis, Filter

Floats = NDArray[np.float64]
Start = Literal["rest", "rising", "falling", "loaded", "blow"]
STARTS: Final[tuple[Start, ...]] = ("rest", "rising", "falling", "loaded", "blow")

_MOTOR, _V_D, _TABLE, _U, _FORCE, _AGE, _INTEGRAL, _LAST, _FILTERED, _QUEUE = (*range(9), 16)
_SIZE: Final = 36
_C, _DRY = 2, 41

EVEN: Final = 0.01
"""A table moves evenly whose speed swings by less than this from peak to peak, over the feed."""
_STEADY: Final = 0.97
"""A swing that falls by less from one third of a run to the next has come to stay."""
_LONGEST: Final = 12
"""How often a run whose swing falls goes on, by 20 cycles at first, then by half more each time."""


class _Record(ctypes.Structure):
    _fields_ = [
        *((name, ctypes.c_double) for name in ("least", "most", "stops", "enough", "h")),
        ("stopped", ctypes.c_int),
    ]  # fmt: skip


@cache
def _library() -> ctypes.CDLL:
    source, made = Path(__file__).with_name("simulated.c"), Path(mkdtemp()) / "simulated.so"
    line = ["cc", "-O2", "-shared", "-fPIC", str(source), "-o", str(made), "-lm"]
    subprocess.run(line, check=True)
    library = ctypes.CDLL(str(made))
    library.run.argtypes = [
        np.ctypeslib.ndpointer(np.float64), np.ctypeslib.ndpointer(np.float64), ctypes.c_long,
        ctypes.c_double, ctypes.c_double, ctypes.POINTER(_Record),
    ]  # fmt: skip
    library.run.restype = None
    library.sliding.argtypes = [np.ctypeslib.ndpointer(np.float64), ctypes.c_double]
    library.sliding.restype = ctypes.c_double
    return library


def _filter(each: Filter, T_s: float) -> tuple[float, ...]:
    """Return b0, b1, b2, a1, a2 of a filter, with the frequency kept by the bilinear transform."""
    poles = [1.0, 1.0] if math.isinf(each.damping) else [1.0, 2.0 * each.damping, 1.0]
    zeros = [1.0] if each.kind == "low pass" else [1.0, 2.0 * each.depth * each.damping, 1.0]
    b, a = bilinear(zeros, poles, 0.5 / math.tan(math.pi * each.frequency * T_s))
    b, a = (np.pad(side, (0, 3 - len(side))) for side in (b, a))
    return (*b, *a[1:])


def _numbers(axis: Axis, width: float, scale: float) -> Floats:
    own, drive = axis.friction.own, axis.drive
    at = own.get("shape", 1.0 if axis.friction.law == "stribeck" else 0.0)
    n = int(own.get("n_points", 0))
    curve = [[own.get(f"{name}_{i}", 0.0) for i in range(1, 13)] for name in ("u", "mu")]
    table = [axis.m, axis.k, axis.c, axis.normal_force, axis.along, axis.friction.mu_s]
    table += [axis.friction.mu_k, own.get("tau_s", 0.0), own.get("B", 0.0), own.get("t_0", 1.0)]
    table += [at, own.get("v_s", 0.01), own.get("delta", 2.0), n, *curve[0], *curve[1]]
    if drive is None:
        return np.array([*table, *[0.0] * 35, width, scale])
    motor = [1.0, drive.inertia, drive.d, drive.dry, drive.lag, drive.T_s, drive.dead_time]
    motor += [drive.K_v, drive.inertia * drive.bandwidth, drive.T_n, drive.on_table]
    motor += [drive.velocity_feedforward, drive.friction_feedforward]
    motor += [drive.F_max if drive.F_max < math.inf else 1e300, len(drive.filters)]
    filters = [q for each in drive.filters for q in _filter(each, drive.T_s)]
    return np.array([*table, *motor, *filters, *[0.0] * (20 - len(filters)), width, scale])


class Simulation:
    """An axis at a feed [m/s], with friction that is smooth over `width` times the feed."""

    def __init__(self, axis: Axis, feed: float, width: float = 1e-4) -> None:
        self.axis, self.feed, self.drive = axis, feed, axis.drive
        self._numbers = _numbers(axis, width * feed, min(1.0, width / 1e-4) * feed)
        self.x = np.zeros(_SIZE)
        self._record = _Record()

    def advance(
        self, time: float, start: float, end: float, enough: int = 0
    ) -> tuple[float, float, int]:
        """Go on for a time [s] while the feed goes from one value to another [m/s].

        Until the table has stopped `enough` times, if that is earlier; 0: never. Returns its least
        and greatest speed [m/s], and how often it stopped.
        """
        record, self._record.enough = self._record, enough
        record.least, record.most, record.stops = math.inf, -math.inf, 0.0
        T_s = self.drive.T_s if self.drive else math.sqrt(self.axis.m / self.axis.k)
        samples = max(1, math.ceil(time / T_s))
        _library().run(self._numbers, self.x, samples, start, end, ctypes.byref(record))
        return record.least, record.most, int(record.stops)

    def times(self, feed: float) -> tuple[float, float]:
        """Return about the longest cycle, and the time in which a start is over [s]."""
        axis, drive = self.axis, self.drive
        loop = drive.K_p * drive.K_v if drive else math.inf
        k = 1.0 / (1.0 / axis.k + 1.0 / loop)
        force = axis.friction.mu_s * axis.normal_force
        gap = force - axis.friction.mu_k * axis.normal_force
        cycle = 2.0 * math.pi * math.sqrt(axis.m / k) + 2.0 * gap / (k * feed)
        servo = 5.0 / drive.K_v + 5.0 * drive.T_n if drive else 0.0
        return cycle, (force + abs(axis.along)) / (k * feed) + servo

    def started(self, start: Start) -> float:
        """Return by how much the table's speed swings after a start, peak to peak, over the feed.

        Seen in the last third of 20 cycles, or of more where the swing still falls.
        "rest": the feed at once on an axis at rest. "rising", "falling": slowly from half and twice
        the feed, from what a start from rest leads to there. "loaded", "blow": the table at rest,
        the motor at the feed, the spring at break-away, or a third beyond it.
        """
        self._record.h, self._record.stopped = 0.0, 0
        if start in ("loaded", "blow"):
            self.x = self.loaded(1.0 if start == "loaded" else 4.0 / 3.0)
        else:
            first = {"rest": 1.0, "rising": 0.5, "falling": 2.0}[start] * self.feed
            self.x = np.zeros(_SIZE)
            self.x[_LAST] = first * self.drive.T_s if self.drive else 0.0
            cycle, over = self.times(first)
            self.advance(over, first, first)
            if first != self.feed:
                self.advance(10 * cycle, first, first, 10)
                self.advance(20 * max(cycle, self.times(self.feed)[0]), first, self.feed)
        third, before = 20.0 / 3.0 * self.times(self.feed)[0], math.inf
        for n in range(_LONGEST):
            least, most, _ = self.advance(third, self.feed, self.feed, 7)
            swing = (most - least) / self.feed
            if n > 1 and not EVEN <= swing < _STEADY * before:
                break
            third, before = third * (1.5 if n > 1 else 1.0), swing
        return swing

    def even(self) -> Floats:
        """Return the state in which the table moves evenly at the feed; of a servo at a sample."""
        axis, drive, v, x = self.axis, self.drive, self.feed, np.zeros(_SIZE)
        x[[_V_D, _U]] = v
        x[_TABLE] = -(_library().sliding(self._numbers, v) + axis.c * v - axis.along) / axis.k
        if drive is None:
            return x
        force = -axis.k * x[_TABLE] + drive.d * v + drive.dry
        e = (1.0 - drive.velocity_feedforward) * v / drive.K_v
        if drive.T_n == 0.0:
            e += (force - drive.friction_feedforward) / drive.K_p / drive.K_v
        else:
            x[_INTEGRAL] = force - drive.friction_feedforward
        shift = -e - x[_TABLE] if drive.on_table else -e
        x[[_MOTOR, _LAST]] = shift
        x[_TABLE] += shift
        x[_FORCE], x[_QUEUE:] = force, force
        for i, each in enumerate(drive.filters):
            _, b1, b2, a1, a2 = _filter(each, drive.T_s)
            x[_FILTERED + 2 * i] = (b1 + b2 - a1 - a2) * force
            x[_FILTERED + 2 * i + 1] = (b2 - a2) * force
        return x

    def loaded(self, part: float) -> Floats:
        """Return `even`, but the table at rest and the spring at a part of the break-away force."""
        axis, x = self.axis, self.even()
        extension = (part * axis.F_s - axis.along) / axis.k
        x[[_U, _AGE]] = 0.0, axis.F_s / (axis.k * self.feed)
        if self.drive and self.drive.on_table:
            x[[_MOTOR, _LAST]] = x[_TABLE] + extension
        else:
            x[_TABLE] = x[_MOTOR] - extension
        return x

    def growth(self, *, stuck: bool = False) -> float:
        """Return the greatest growth rate of a small deviation from even motion [1/s].

        `stuck`: of a servo that holds a position, its table too damped to move, its motor without
        dry friction. By central differences of the map over one sample; deviations of 1e-5
        of the feed, and a solver tolerance of 1e-12 of it.
        """
        even, drive, axis = self.even(), self.drive, self.axis
        feed, numbers = self.feed, self._numbers.copy()
        w = math.sqrt(axis.k / axis.m)
        numbers[-1] *= 1e-6
        if stuck:
            even, feed, numbers[[_C, _DRY]] = np.zeros(_SIZE), 0.0, (1e30, 0.0)
        size = np.full(_SIZE, 1e-5 * axis.k * self.feed / w)
        size[[_MOTOR, _TABLE, _LAST]] = 1e-5 * self.feed / w
        size[[_V_D, _U]] = 1e-5 * self.feed
        moving = [] if stuck else [_TABLE, _U]
        if drive:
            moving += [_MOTOR, _V_D, _LAST]
            moving += [_FORCE] * (drive.lag > 0.0) + [_INTEGRAL] * (drive.T_n > 0.0)
            moving += range(_FILTERED, _FILTERED + 2 * len(drive.filters))
            moving += range(_QUEUE, _SIZE)
        columns = []
        for n in moving:
            ends = []
            for side in (1.0, -1.0):
                self.x = even.copy()
                self.x[n] += side * size[n]
                _library().run(numbers, self.x, 1, feed, feed, ctypes.byref(_Record()))
                ends.append(self.x[moving] / size[moving])
            columns.append((ends[0] - ends[1]) / 2.0)
        T_s = drive.T_s if drive else 1.0 / w
        return float(np.log(np.abs(np.linalg.eigvals(np.array(columns).T)).max()) / T_s)
