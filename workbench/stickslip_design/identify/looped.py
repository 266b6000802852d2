"""What a record of stick-slip tells of a servo axis: the fit predicts the motion of its loop.

While the table jumps the drive gives way and catches up, so the numbers are those with which the
simulated loop of docs/feed-axis.md moves as the record shows. The drive is taken as its file states
it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Final, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from scipy.interpolate import Akima1DInterpolator, CubicHermiteSpline

from ..axis import Axis, Friction
from ..loop.jumps import loaded
from ..loop.motion import Point, Watched, walk
from ..loop.system import FORCE, INTEGRAL, MOTOR, MOTOR_SPEED, SPEED, TABLE, Mode, System
from .cycles import Run
from .model import Floats
from .nonlinear import Columns, Fitted, fit

_SETTLED: Final = 4
_SETTLES: Final = 13
"""Cycles after which the start is forgotten."""
_MOST: Final = 24
"""Cycles that are fitted."""
_FINE: Final = 0.25
"""Step over the time of a swing: a cubic is then within 2e-5 of it."""
_MARGIN: Final = 0.03
"""Of a period after the first break-away, in which it may lie elsewhere."""
_CYCLES, _AGAIN = 5, 1
"""Cycles that are simulated, till what the start left is gone; and the last ones, which come again:
a break-away falls anywhere between two samples of the controller, so no cycle is quite the other.
"""
_COARSE, _RINGS = 0.02, 2.0
"""Step in a stick, of a period, once the drive no longer rings: so long over 1/bandwidth."""
_TRIES: Final = 8
_CLOSE: Final = 1e-8
_FARTHEST: Final = 2.3
"""How far mass and stiffness may be off the file of the axis: ten times."""
_BEST: Final = 3
_SIZES: Final = (1.0, 1.7, 0.6, 3.0, 0.3, 6.0, 0.1)
_STIFFNESSES: Final = (0.4, 1.0, 2.5)
_MASSES: Final = (0.6, 1.0, 1.7)
"""Where the search starts: stiffness and mass over those of the axis."""
_SHIFTS: Final = 40
_ALIKE: Final = 3e-3
"""Of a period: settled cycles are as long as each other to this."""
_UNSEEN, _FEWEST = 4, 3
"""Cycles that a start may change by less than this; and those that are fitted at least."""
_TIES: Final = (1e-3, 1e-5)
_ROUGHLY, _FINELY = 7, 20
"""Evaluations of a search."""
_STEP: Final = 3e-2
_NAMES: Final = ("m", "k", "zeta", "T", "memory", "error", "t_break")
_SIMULATED: Final = 6


_GUESSES: WeakKeyDictionary[Loop, float] = WeakKeyDictionary()


class Simulated(NamedTuple):
    """A simulated motion: some cycles from a break-away on, of which the last ones come again."""

    period: float
    feed: float
    end: float
    """When the simulated cycles end [s], in a break-away."""
    gap: float
    """ln (F_s - F_k)."""
    way: CubicHermiteSpline
    force: Akima1DInterpolator

    def x(self, after: Floats) -> Floats:
        """Return the position since the break-away [m]."""
        beyond = self._beyond(after)
        return np.asarray(self.way(after - beyond * self.period) + self.feed * beyond * self.period)

    def F(self, after: Floats) -> Floats:  # noqa: N802 - the symbol
        """Return the force of the motor [N]."""
        return np.asarray(self.force(after - self._beyond(after) * self.period))

    def _beyond(self, after: Floats) -> Floats:
        return _AGAIN * np.ceil(np.maximum(after - self.end, 0.0) / (_AGAIN * self.period))


@dataclass(frozen=True, eq=False)
class Loop:
    """A servo axis over a run of cycles.

    The numbers are ln m, ln k, zeta of table and spring, ln T of the period, how far the integral
    and the error of the position are off those of a settled cycle, as a force over F_s - F_k; then
    t_break, the level of x, what is to be added to the kinetic friction of the axis, and the delay
    of the force. F_s - F_k is that of which the simulated cycles have the period: so the motion
    stays in step with the record.
    """

    axis: Axis
    run: Run
    noise: dict[str, float]

    @property
    def names(self) -> list[str]:
        """The numbers by name."""
        both = self.run.x is not None and self.run.F is not None
        free = ["x_0"] * (self.run.x is not None) + ["F_0"] * (self.run.F is not None)
        return [*_NAMES, *free, *["delay"] * both]

    def candidate(self, n: Floats, gap: float) -> Axis:
        """Return the axis with numbers, and F_s - F_k [N]; it slides with enough friction."""
        m, k, zeta = math.exp(n[0]), math.exp(n[1]), max(float(n[2]), -0.2)
        axis = replace(self.axis, m=m, k=k, c=2.0 * zeta * math.sqrt(k * m))
        N, F_k = axis.normal_force, max(self.axis.F_k, 2.0 * gap)
        return replace(axis, friction=Friction(mu_s=(F_k + gap) / N, mu_k=F_k / N))

    def simulated(self, n: Floats) -> Simulated | None:
        """Return the motion of the loop with numbers; None where it does not jump in rows."""
        return _simulated(self, tuple(n[:_SIMULATED].tolist()))

    def columns(self, n: Floats) -> Columns:
        """Return the residuals, each over its noise."""
        return self._residuals(self.simulated(n), n)

    def _residuals(self, motion: Simulated | None, n: Floats) -> Columns:
        """Return the residuals of a motion, its time stretched to the period."""
        place, run, columns = {name: i for i, name in enumerate(self.names)}, self.run, []
        after = run.t - n[place["t_break"]]
        faster = motion.period / math.exp(n[place["T"]]) if motion else 1.0
        if run.x is not None:
            way = (
                motion.x(np.maximum(faster * after, 0.0)) / faster if motion else run.speed * after
            )
            columns.append((run.x - n[place["x_0"]] - way) / self.noise["x"])
        if run.F is not None:
            late = faster * (after - (n[place["delay"]] if "delay" in place else 0.0))
            F = motion.F(np.maximum(late, 0.0)) if motion else np.zeros_like(late)
            columns.append((run.F - n[place["F_0"]] - F) / self.noise["F"])
        return columns

    def jacobian(self, n: Floats) -> Columns:
        """Return their derivatives."""
        motion = self.simulated(n)
        base = self._residuals(motion, n)
        J = [np.zeros((r.size, n.size)) for r in base]
        for place, name in enumerate(self.names):
            step, moved, other = _STEP, n.copy(), motion
            if name in self.noise or name[0] in self.noise:
                step = self.noise[name[0]]
            elif name in ("t_break", "delay"):
                step = 2e-3 * _STEP * self.run.period
            moved[place] += step
            if place < _SIMULATED:
                other = self.simulated(moved)
            if name == "T":
                # Another period shifts late cycles far, and changes their shape: both apart.
                shape = self._residuals(other, n)
                moved[place] = n[place] + 1e-6
                ends = [
                    e + (shift - r) * step / 1e-6
                    for e, shift, r in zip(shape, self._residuals(motion, moved), base, strict=True)
                ]
            else:
                ends = list(self._residuals(other, moved))
            below = base
            if place < _SIMULATED and name != "T":
                moved[place] = n[place] - step
                other = self.simulated(moved)
                if other is not None:
                    below, step = self._residuals(other, moved), 2.0 * step
            for j, r, end in zip(J, below, ends, strict=True):
                j[:, place] = (end - r) / step
        return J

    def starts(self) -> list[Floats]:
        """Return numbers near which the motion is most like the record."""
        first = np.zeros(len(self.names))
        zeta = self.axis.c / (2.0 * math.sqrt(self.axis.k * self.axis.m))
        first[:4] = (
            math.log(self.axis.m),
            math.log(self.axis.k),
            max(zeta, 0.02),
            math.log(self.run.period),
        )
        tried = []
        for mass in _MASSES:
            for stiffness in _STIFFNESSES:
                n = first.copy()
                n[:2] += np.log([mass, stiffness])
                tried.append(self._placed(n))
        return [n for _, n in sorted(tried, key=lambda one: one[0])[:_BEST]]

    def _placed(self, n: Floats) -> tuple[float, Floats]:
        """Return the squares at the best break-away, and the numbers with it."""
        motion, run = self.simulated(n), self.run
        if motion is None:
            return math.inf, n
        names, best = self.names, (math.inf, n)
        half = 0.25 * run.period
        for begin in np.linspace(run.t[0] - half, run.t[0] + half, _SHIFTS):
            trial = n.copy()
            trial[names.index("t_break")] = begin
            parts = self._residuals(motion, trial)
            for name, r in zip([s for s in ("x_0", "F_0") if s in names], parts, strict=True):
                trial[names.index(name)] = float(np.mean(r)) * self.noise[name[0]]
            square = sum(float(np.sum((r - np.mean(r)) ** 2)) / r.size for r in parts)
            best = min(best, (square, trial), key=lambda one: one[0])
        return best

    def gap(self, n: Floats) -> float:
        """Return ln (F_s - F_k)."""
        motion = self.simulated(n)
        return motion.gap if motion else math.nan

    def slope_of_gap(self, n: Floats) -> Floats:
        """Return the derivatives of ln (F_s - F_k)."""
        slope, middle = np.zeros_like(n), self.gap(n)
        for place in range(_SIMULATED):
            moved = n.copy()
            moved[place] += _STEP
            slope[place] = (self.gap(moved) - middle) / _STEP
        return slope


class _Settled(NamedTuple):
    """A settled row of jumps at a break-away: system, mode, point, and the period [s]."""

    system: System
    mode: Mode
    point: Point
    period: float


def _settled(axis: Axis, feed: float, longest: float) -> _Settled | None:
    """Return the settled jumps of an axis; None where it does not jump in rows."""
    system = System(axis)
    try:
        settling = walk(system, Mode(0, 1), loaded(system, feed), Watched(longest))
        turns = settling.turns(2 * _SETTLES + 1)
    except (ValueError, OverflowError, np.linalg.LinAlgError):
        return None
    if len(turns) < 2 * _SETTLES + 1 or any(turn.mode.table < 0 for turn in turns):
        return None
    period = (turns[-1].time - turns[-1 - 2 * _SETTLED].time) / _SETTLED
    return _Settled(system, settling.mode, settling.point, period)


def _in_time(loop: Loop, n: Floats) -> tuple[_Settled, float] | None:
    """Return the jumps whose period is that of the numbers, and ln (F_s - F_k) for it."""
    feed, longest, due = loop.run.speed, 3.0 * _SETTLES * loop.run.period, float(n[3])
    gap, found = (
        _GUESSES.get(loop, math.log(max(loop.axis.F_s - loop.axis.F_k, 0.02 * loop.axis.F_s))),
        None,
    )
    beyond = np.abs(n[:2] - np.log([loop.axis.m, loop.axis.k])) > _FARTHEST
    for share in () if beyond.any() or n[2] > 1.0 else _SIZES:
        found = _settled(loop.candidate(n, share * math.exp(gap)), feed, longest)
        if found:
            gap += math.log(share)
            break
    slope, before = 1.0, (gap, math.nan)
    for _ in range(_TRIES):
        if found is None:
            return None
        off = math.log(found.period) - due
        if abs(off) < _CLOSE:
            break
        if before[1] - off:
            steeper = (before[1] - off) / (before[0] - gap) if before[0] != gap else math.nan
            slope = steeper if 0.2 < steeper < 5.0 else slope
        before = gap, off
        gap -= min(max(off / slope, -1.0), 1.0)
        found = _settled(loop.candidate(n, math.exp(gap)), feed, longest)
    if found is None or abs(off) > 1e-3:
        return None
    _GUESSES[loop] = gap
    return found, gap


@lru_cache(maxsize=64)
def _simulated(loop: Loop, numbers: tuple[float, ...]) -> Simulated | None:
    n = np.array(numbers)
    in_time = _in_time(loop, n)
    if in_time is None:
        return None
    (system, mode, point, period), gap = in_time
    axis, drive, layout = system.axis, system.drive, system.layout
    state = point.state.copy()
    if drive.T_n > 0.0:
        state[INTEGRAL] += n[4] * math.exp(gap)
    state[layout.command] += n[5] * math.exp(gap) / (drive.K_p * drive.K_v)
    w = math.sqrt(axis.k / axis.m + axis.k / drive.inertia)
    fine = max(1, round(_FINE / w / drive.T_s)) * drive.T_s
    coarse = max(fine, math.ceil(_COARSE * period / drive.T_s) * drive.T_s)
    place, speed = (TABLE, SPEED) if drive.on_table else (MOTOR, MOTOR_SPEED)
    columns = [place, speed, FORCE if drive.lag > 0.0 else layout.commands]
    following = walk(system, mode, point._replace(state=state), Watched(fine))
    t, rows, passed, left, stopped, slips = [0.0], [state[columns]], 0.0, fine, 0.0, 1
    while slips <= _CYCLES:
        following.go_on(left)
        turns = following.turns(1)
        gone = turns[0].time - passed if turns else left
        passed, left = passed + gone, left - gone
        if turns:
            stopped = passed
            slips += turns[0].event == "forward"
        if left <= 1e-9 * fine:
            quiet = not following.mode.table and passed - stopped > _RINGS / drive.bandwidth
            left = coarse if quiet else fine
        if gone > 1e-6 * fine:
            t.append(passed)
            rows.append(following.point.state[columns])
        if passed > 3.0 * _CYCLES * period:
            return None
    times, motion = np.array(t), np.array(rows)
    x = CubicHermiteSpline(times, motion[:, 0] - motion[0, 0], motion[:, 1])
    F = Akima1DInterpolator(times, motion[:, 2] - axis.F_k + loop.axis.F_k)
    return Simulated(period, loop.run.speed, passed, gap, x, F)


def fitted_loop(loop: Loop) -> tuple[Loop, Fitted]:
    """Return the fit of a loop, with its own noise."""
    rough = [fit(loop.columns, loop.jacobian, n, _ROUGHLY) for n in loop.starts()]
    best = min(rough, key=lambda one: sum(float(r @ r) for r in one.residual))
    sizes = [math.sqrt(float(np.mean(r * r))) for r in best.residual]
    noise = {name: loop.noise[name] * size for name, size in zip(loop.noise, sizes, strict=True)}
    loop = replace(loop, noise=noise)
    return loop, fit(loop.columns, loop.jacobian, best.value, _FINELY)


def settled(run: Run) -> Run:
    """Return the last cycles of a run, all about as long, from a little after a break-away on.

    ValueError of fewer than four slips.
    """
    if len(run.highs) < _FEWEST + 1:
        raise ValueError(f"{len(run.highs)} slips of a servo axis: fewer than {_FEWEST + 1}")
    periods = np.diff(run.highs)
    middle = float(np.median(periods[periods.size // 2 :]))
    allowed = max(_ALIKE * middle, 3.0 * float(np.median(np.diff(run.t))))
    others = np.flatnonzero(np.abs(periods - middle) > allowed)
    first = max(int(others[-1]) + 1 if others.size else 0, min(_UNSEEN, periods.size // 3))
    first = min(first, max(periods.size - _FEWEST, 0))
    begin = run.highs[first] + _MARGIN * middle
    return run.within(begin, min(begin + _MOST * middle, float(run.t[-1])))
