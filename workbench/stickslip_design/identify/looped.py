"""What a record of stick-slip tells of a servo axis: the fit predicts the motion of its loop.

While the table jumps the drive gives way and catches up, so the numbers are those with which the
loop of docs/feed-axis.md moves as the record shows. The drive is taken as its file states it.
Between events the motion is linear, so its derivatives by the numbers are followed exactly: across
an event they jump by what its shift in time makes (di Bernardo et al. 2008,
doi:10.1007/978-1-84628-708-4, 2.5).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product
from typing import Final, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg import expm
from scipy.optimize import brentq
from scipy.signal import correlate, detrend

from ..axis import Axis, Friction
from ..loop.jumps import loaded
from ..loop.motion import Watched, walk
from ..loop.system import FORCE, INTEGRAL, LAST, MOTOR, MOTOR_SPEED, SPEED, TABLE, Mode, System
from .cycles import Run
from .model import Floats
from .nonlinear import Columns, Fitted

_SETTLED, _SETTLES = 4, 13
"""Cycles whose mean is the period, and after which the start is forgotten."""
_MOST: Final = 24
"""Cycles that are fitted."""
_BLOCK: Final = 128
"""Samples of the controller that are followed at once."""
_TERMS: Final = 18
"""Of a Taylor series over no more than the time of the quickest rate: 1/18! is rounding."""
_FARTHEST: Final = 2.5
"""How far the logarithms of mass, stiffness and gap may be off a start."""
_TRIES, _CLOSE = 8, 1e-4
_BEST, _SHORT, _ROUGHLY, _FINELY = 3, (2.4, 1.4), 8, 30
"""Starts that are followed, over how many cycles at first, and steps of a search."""
_STIFFNESSES: Final = (0.5, 0.75, 1.0, 1.4, 2.0)
_MASSES: Final = (0.7, 1.3)
"""Where the search starts: stiffness and mass over those of the axis."""
_AS_GOOD: Final = 9.0
_SAME, _HOPELESS = 0.03, 20.0
_AHEAD, _BENT, _GAIN = 0.1, 0.75, 1e-3
_WEIGHED: Final = 2
_PLACED, _SHIFTS = 2.0, 64
_FINENESS: Final = 2e-4
_UNSEEN, _FEWEST = 4, 3
"""Cycles of the start, and those that are fitted at least."""
_NAMES: Final = ("m", "k", "c", "F_s - F_k", "motor", "speed", "force", "integral", "command")
_STARTS: Final = slice(4, 9)
"""Those of the start."""
_NEAR: Final = np.array([0.5, 0.5, 0.1, 0.5])
"""How far from where a search begins its numbers usually are."""
_LINEAR: Final = 3
"""Numbers on which the matrices depend."""


class _Slides(NamedTuple):
    """The table at rest or in slip: matrices, and their derivatives by ln m, ln k and c.

    `rates` of each part of a sample, `steps` over each part, `powers` over whole samples with the
    controller: each with its derivatives, shapes (4, n, n) and (samples + 1, 4, n, n).
    """

    rates: list[Floats]
    steps: list[Floats]
    powers: Floats


def _slides(
    system: System, slips: bool, parts: list[tuple[float, int]], c: float, count: int
) -> _Slides:
    """Return a mode with `count` matrices each, 4 or 1; `c` is the unit of the damping [N.s/m]."""
    n, rates = system.layout.size, []
    for _, late in parts:
        A = np.zeros((4, n, n))
        A[0] = system.rates(Mode(int(slips), 1), late)
        A[1, SPEED] = -A[0, SPEED]
        places = np.ix_([SPEED, MOTOR_SPEED], [MOTOR, TABLE])
        A[2][places] = A[0][places]
        A[3, SPEED, SPEED] = -c / system.axis.m if slips else 0.0
        rates.append(A[:count])

    def whole(A: Floats) -> Floats:
        both = np.kron(np.eye(count), A[0])
        both[n:, :n] = A[1:].reshape(-1, n)
        return both

    steps = [expm(whole(A) * length) for A, (length, _) in zip(rates, parts, strict=True)]
    sample = np.kron(np.eye(count), system.control)
    for step in steps:
        sample = step @ sample
    powers = np.empty((_BLOCK + 1, count * n, n))
    powers[0] = np.eye(count * n)[:, :n]
    for number in range(_BLOCK):
        powers[number + 1] = sample @ powers[number]
    return _Slides(
        rates, [step[:, :n].reshape(-1, n, n) for step in steps], powers.reshape(-1, count, n, n)
    )


def _moved(by: Floats, Z: Floats) -> Floats:
    """Return what matrices with derivatives, (..., 4, n, n), make of a state with derivatives."""
    after = by[..., 0, :, :] @ Z
    if Z.shape[1] == 1:
        return after
    after[..., 1 : 1 + _LINEAR] += (by[..., 1:, :, :] @ Z[:, 0]).swapaxes(-1, -2)
    return after


def _onward(A: Floats, Z: Floats, time: float) -> Floats:
    """Return a state with derivatives after a part of a part of a sample."""
    total, term = Z.copy(), Z
    for order in range(1, _TERMS):
        term = _moved(A, term) * (time / order)
        total += term
    return total


@dataclass(frozen=True, eq=False)
class Loop:
    """A servo axis over a run of cycles, the table at rest in its first sample.

    The numbers are ln m, ln k, the damping over that at which the axis as stated would creep back,
    ln (F_s - F_k); how far place, speed and force of the motor, integral and set point are off
    `start` at the first sample; then the level of x and the kinetic friction.
    """

    axis: Axis
    """As its file states it."""
    slides: float
    """Kinetic friction of the simulation [N]: the table never goes back."""
    run: Run
    noise: dict[str, float]
    first: Floats
    """Numbers at which the search began."""
    start: Floats
    """State at the first sample."""
    searched: bool = True
    """Whether numbers are searched: near `first`, as far as the samples do not tell them."""

    @property
    def names(self) -> list[str]:
        """The numbers by name."""
        free = ["x_0"] * (self.run.x is not None) + ["F_k"] * (self.run.F is not None)
        return [*_NAMES, *free]

    @property
    def unit(self) -> float:
        """Unit of the damping [N.s/m]."""
        return 2.0 * math.sqrt(self.axis.k * self.axis.m)

    def candidate(self, n: Floats) -> Axis:
        """Return the axis with numbers."""
        axis = replace(self.axis, m=math.exp(n[0]), k=math.exp(n[1]), c=float(n[2]) * self.unit)
        N = axis.normal_force
        mu_s, mu_k = (self.slides + math.exp(n[3])) / N, self.slides / N
        return replace(axis, friction=Friction(mu_s=mu_s, mu_k=mu_k))

    def columns(self, n: Floats) -> Columns:
        """Return the residuals, each over its noise; last what a start is off, over what is usual.

        What is soon forgotten the samples do not show.
        """
        seen = self.seen(n, False)[:, :, 0]
        parts = [(s - seen[:, i] - level) / e for i, (s, e, level) in enumerate(self._shown(n))]
        near = (n[: _STARTS.start] - self.first[: _STARTS.start]) / _NEAR
        return [*parts, np.append(n[_STARTS], self.searched * near)]

    def jacobian(self, n: Floats) -> Columns:
        """Return their derivatives."""
        seen, columns = self.seen(n, True), []
        for i, (s, e, _) in enumerate(self._shown(n)):
            J = np.zeros((s.size, n.size))
            J[:, : len(_NAMES)], J[:, len(_NAMES) + i] = seen[:, i, 1:], 1.0
            columns.append(J / -e)
        near = np.eye(n.size)[: _STARTS.start] / _NEAR[:, None]
        return [*columns, np.concatenate([np.eye(n.size)[_STARTS], self.searched * near])]

    def _shown(self, n: Floats) -> list[tuple[Floats, float, float]]:
        """Return columns of the run, their noise and level."""
        columns, noise = [s for s in (self.run.x, self.run.F) if s is not None], self.noise
        return list(zip(columns, noise.values(), n[len(_NAMES) :].tolist(), strict=True))

    def seen(self, n: Floats, derivatives: bool) -> Floats:
        """Return the columns and their derivatives at the samples, shape (n, columns, 1 + p)."""
        seen = _simulated(self, tuple(n[: len(_NAMES)].tolist()), derivatives)
        return seen[:, [name in self.noise for name in ("x", "F")]]

    def within(self, cycles: float) -> Loop:
        """Return the loop over some cycles."""
        begin = float(self.run.t[0])
        run = self.run.within(begin, begin + cycles * self.run.period)
        return replace(self, run=replace(run, highs=self.run.highs))


class _Follower:
    """The motion of a loop with its derivatives from sample to sample."""

    def __init__(self, loop: Loop, n: Floats, derivatives: bool) -> None:
        self.system = System(loop.candidate(n))
        drive = self.system.drive
        self.parts = [
            (part.length / count, part.late)
            for part in self.system.parts
            for count in [math.ceil(part.length / drive.lag) if drive.lag > 0.0 else 1]
            for _ in range(count)
        ]
        count = 4 if derivatives else 1
        self.modes = [
            _slides(self.system, slips, self.parts, loop.unit, count) for slips in (False, True)
        ]
        self.gap, self.pull = math.exp(n[3]), np.zeros(self.system.layout.size)
        self.pull[[MOTOR, TABLE]] = self.system.axis.k, -self.system.axis.k

    def margin(self, slips: bool, states: Floats) -> Floats:
        """Return the speed in a slip, what holds more than the spring pulls at rest."""
        if slips:
            return np.asarray(states[..., SPEED])
        held = self.system.axis.F_s - self.system.axis.along
        return np.asarray(held - states @ self.pull)

    def over_sample(self, Z: Floats, slips: bool) -> tuple[Floats, bool]:
        """Return the state after a sample with events, and whether the table then slips."""
        Z = self.system.control @ Z
        for number, (length, _) in enumerate(self.parts):
            left = length
            while True:
                mode = self.modes[slips]
                A = mode.rates[number]
                whole = left == length
                after = _moved(mode.steps[number], Z) if whole else _onward(A, Z, left)
                if self.margin(slips, after[:, 0]) >= 0.0:
                    break
                terms = [Z[:, 0]]
                for order in range(1, _TERMS):
                    terms.append(A[0] @ terms[-1] / order)
                series = np.array(terms[::-1])
                at = (
                    float(
                        brentq(
                            lambda time, s=series, slips=slips: float(
                                self.margin(slips, time ** np.arange(_TERMS - 1.0, -1.0, -1.0) @ s)
                            ),
                            0.0,
                            left,
                            xtol=1e-15,
                        )
                    )
                    if self.margin(slips, Z[:, 0]) > 0.0
                    else 0.0
                )
                Z, left = self._across(_onward(A, Z, at), slips, number), left - at
                slips = not slips
            Z = after
        return Z, slips

    def _across(self, Z: Floats, slips: bool, number: int) -> Floats:
        """Return the state after an event, whose time the numbers shift."""
        before, after = (self.modes[which].rates[number][0] for which in (slips, not slips))
        rate, row = before @ Z[:, 0], np.zeros(len(Z))
        row[SPEED] = 1.0
        row = row if slips else -self.pull
        rise = row @ Z[:, 1:]
        if not slips and rise.size:
            rise[1] -= self.pull @ Z[:, 0]
            rise[3] += self.gap
        shift = -rise / (row @ rate)
        Z = Z.copy()
        Z[:, 1:] += np.outer(rate, shift)
        if slips:
            Z[SPEED] = 0.0
        Z[:, 1:] -= np.outer(after @ Z[:, 0], shift)
        return Z


@lru_cache(maxsize=4)
def _simulated(loop: Loop, numbers: tuple[float, ...], derivatives: bool) -> Floats:
    """Return position and force, and their derivatives, at the samples, shape (n, 2, 1 + p)."""
    n, t = np.array(numbers), loop.run.t - loop.run.t[0]
    if np.abs(n - loop.first)[[0, 1, 3]].max() > _FARTHEST or abs(n[2]) > 1.0:
        return np.full((t.size, 2, 1 + n.size), math.inf)
    follower = _Follower(loop, n, derivatives)
    system, layout = follower.system, follower.system.layout
    T_s, on_table = system.drive.T_s, system.drive.on_table
    rows = [TABLE if on_table else MOTOR, FORCE if system.drive.lag > 0.0 else layout.commands]
    Z, slips, sample = _begun(loop, system, n), False, 0
    Z = Z if derivatives else Z[:, :1]
    count = math.ceil(t[-1] / T_s - 1e-3) + 1
    seen = np.empty((count, 2, Z.shape[1]))
    seen[0] = Z[rows]
    while sample < count - 1:
        powers = follower.modes[slips].powers[: count - sample]
        ends = np.flatnonzero(follower.margin(slips, powers[1:, 0] @ Z[:, 0]) < 0.0)
        whole = int(ends[0]) if ends.size else len(powers) - 1
        seen[sample + 1 : sample + 1 + whole] = _moved(powers[1 : 1 + whole][:, :, rows], Z)
        Z, sample = _moved(powers[whole], Z), sample + whole
        if ends.size:
            Z, slips = follower.over_sample(Z, slips)
            sample += 1
            seen[sample] = Z[rows]
    seen[:, 1, 0] -= loop.slides
    every = t / T_s
    near = np.round(every).astype(int)
    if np.abs(every - near).max() < 1e-3:
        return np.asarray(seen[near])
    return np.asarray(CubicSpline(np.arange(count), seen)(every))


def _begun(loop: Loop, system: System, n: Floats) -> Floats:
    """Return the state at the first sample, with its derivatives."""
    layout = system.layout
    # Some F_s - F_k.
    scale = 3.0 * math.exp(loop.first[3])
    pushed = system.holding(1.0, 0.0) - system.holding(0.0, 0.0)
    pushed[[INTEGRAL, layout.command, MOTOR, LAST]] = 0.0
    pushed[FORCE] = float(system.drive.lag > 0.0)
    Z = np.zeros((layout.size, 1 + len(_NAMES)))
    unit, place = np.eye(layout.size), len(_NAMES) - 4
    # The spring's force stays as it is where its stiffness varies, and what follows the motor.
    stretched = unit[MOTOR] + unit[LAST]
    if not system.drive.on_table:
        stretched = stretched + unit[layout.command]
    Z[:, place] = stretched * scale / system.axis.k
    Z[:, place + 1] = unit[MOTOR_SPEED] * loop.run.speed
    Z[LAST, place + 1] = -system.drive.T_s * loop.run.speed
    Z[:, place + 2] = pushed * scale
    Z[:, place + 3] = unit[INTEGRAL] * scale
    Z[:, place + 4] = unit[layout.command] * scale / (system.drive.K_p * system.drive.K_v)
    Z[:, 0] = loop.start + Z[:, place:] @ n[place - 1 :]
    Z[:, 0] += stretched * loop.start[MOTOR] * (math.exp(loop.first[1] - n[1]) - 1.0)
    Z[:, 2] = -stretched * Z[MOTOR, 0]
    return Z


def _settled(loop: Loop, n: Floats) -> tuple[float, Floats] | None:
    """Return the period of settled jumps [s], and the state in the middle of a rest at a sample.

    None where there are none.
    """
    system, period = System(loop.candidate(n)), loop.run.period
    T_s = system.drive.T_s
    settling = walk(
        system, Mode(0, 1), loaded(system, loop.run.speed), Watched(3.0 * _SETTLES * period)
    )
    turns = settling.turns(2 * _SETTLES + 1)
    if len(turns) < 2 * _SETTLES + 1 or any(turn.mode.table < 0 for turn in turns):
        return None
    period = (turns[-1].time - turns[-1 - 2 * _SETTLED].time) / _SETTLED
    onward = period - 0.5 * (turns[-1].time - turns[-2].time)
    start = settling.point
    onward = max(round((onward + start.offset) / T_s), 1) * T_s - start.offset
    settling.go_on(onward)
    settling.turns(2)
    state = settling.point.state.copy()
    state[[MOTOR, LAST, system.layout.command, TABLE]] -= state[TABLE]
    return period, state


def _in_time(loop: Loop, n: Floats) -> Loop | None:
    """Return the loop whose settled jumps have the period of the run; None where there is none."""
    n = n.copy()
    for _ in range(_TRIES):
        try:
            found = _settled(loop, n)
        except (ValueError, OverflowError, np.linalg.LinAlgError):
            return None
        if found is None:
            return None
        period, state = found
        off = math.log(period / loop.run.period)
        if abs(off) < _CLOSE:
            break
        n[3] -= off
    return replace(loop, first=n, start=state)


def _placed(loop: Loop) -> tuple[Loop, Floats]:
    """Return a loop where it is most like the run, and its numbers."""
    whole, n = loop.run, np.append(loop.first, np.zeros(len(loop.names) - loop.first.size))
    loop = loop.within(_PLACED)
    size = loop.run.t.size
    seen = loop.seen(loop.first, False)[:, :, 0].T
    columns = [s for s in (whole.x, whole.F) if s is not None]
    last = min(int(np.searchsorted(whole.t, whole.t[0] + whole.period)), whole.t.size - size)

    def squares(at: int) -> float:
        parts = zip(columns, seen, loop.noise.values(), strict=True)
        return sum(float(np.var(s[at : at + size] - y)) / e**2 for s, y, e in parts)

    step = max(last // _SHIFTS, 1)
    rough = min(range(0, last, step), key=squares)
    at = min(range(max(rough - step, 0), min(rough + step, last)), key=squares)
    for i, (s, y) in enumerate(zip(columns, seen, strict=True)):
        n[len(_NAMES) + i] = np.mean(s[at : at + size] - y)
    run = whole.within(float(whole.t[at]), math.inf)
    return replace(loop, run=replace(run, highs=whole.highs)), n


def _starts(axis: Axis, run: Run, noise: dict[str, float]) -> list[tuple[Loop, Floats]]:
    """Return loops and numbers near which the motion is most like the record."""
    # The spring gives way by about half of what the feed goes in a period.
    way = 0.5 * run.speed * run.period
    slides = max(axis.F_k, 4.0 * max(_STIFFNESSES) * axis.k * way)
    loop = Loop(axis, slides, run, noise, np.zeros(len(_NAMES)), np.zeros(0))
    placed = []
    for mass, stiffness in product(_MASSES, _STIFFNESSES):
        m, k = mass * axis.m, stiffness * axis.k
        first = np.zeros(len(_NAMES))
        first[:4] = math.log(m), math.log(k), max(axis.c / loop.unit, 0.02), math.log(k * way)
        begun = _in_time(loop, first)
        if begun is not None:
            placed.append(_placed(begun))
    return placed


def _searched(loop: Loop, n: Floats, cycles: float, most: int) -> tuple[float, Floats]:
    """Return the mean square after a search over some cycles, and the numbers there."""
    some = loop.within(cycles)
    # Far from the minimum what is usual of a start counts as much as the residual.
    n = _least(_own(some, some.columns(n)), n, most)
    r = np.concatenate(some.columns(n)[:-1])
    return float(r @ r) / r.size, n


@np.errstate(over="ignore", invalid="ignore")
def _least(loop: Loop, n: Floats, most: int) -> Floats:
    """Return where the squares are least.

    By Levenberg's and Marquardt's steps, bent as the valley is: Transtrum and Sethna 2012,
    arXiv:1201.5885. It ends where a step would gain little.
    """
    damping, r = 1e-2, np.concatenate(loop.columns(n))
    for _ in range(most):
        J = np.concatenate(loop.jacobian(n))
        scale = np.sqrt(np.sum(J * J, axis=0))
        scale[~(scale > 0.0)] = 1.0
        J /= scale
        normal, square = J.T @ J, float(r @ r)
        while True:
            inverse = np.linalg.inv(normal + damping * np.eye(n.size))
            step = -inverse @ (J.T @ r)
            ahead = np.concatenate(loop.columns(n + _AHEAD * step / scale))
            bent = (2.0 / _AHEAD) * ((ahead - r) / _AHEAD - J @ step)
            bend = -0.5 * inverse @ (J.T @ bent)
            size = float(np.linalg.norm(bend) / np.linalg.norm(step))
            if size < _BENT:
                trial = n + (step + bend) / scale
                new = np.concatenate(loop.columns(trial))
                if float(new @ new) < square:
                    break
            damping *= 5.0
            if damping > 1e8:
                return n
        gain = square - float(new @ new)
        n, r = trial, new
        if gain < _GAIN * square / r.size and damping < 1e-2:
            break
        damping = max(0.1 * damping, 1e-12)
    return n


def _own(loop: Loop, residual: Columns) -> Loop:
    """Return the loop with the noise that a residual shows."""
    sizes = [math.sqrt(float(np.mean(r * r))) for r in residual[:-1]]
    noise = {name: e * size for (name, e), size in zip(loop.noise.items(), sizes, strict=True)}
    return replace(loop, noise=noise)


def fitted_loop(axis: Axis, run: Run, noise: dict[str, float]) -> tuple[Loop, Fitted, list[Fitted]]:
    """Return the loop with its own noise, its best fit, and others that are as good.

    ValueError where the axis as stated does not jump at this feed.
    """
    starts = _starts(axis, run, noise)
    if not starts:
        raise ValueError(
            "the axis as its file states it does not jump at this feed: nothing to fit"
        )
    for cycles in _SHORT:
        loop, found, others = _followed(starts, cycles)
        if found.left_is_little:
            break
    return loop, found, others


def _followed(
    starts: list[tuple[Loop, Floats]], cycles: float
) -> tuple[Loop, Fitted, list[Fitted]]:
    """Return what is found over more and more cycles."""
    best = [(*_searched(loop, n, cycles, _ROUGHLY), loop) for loop, n in starts]
    while cycles < min(len(starts[0][0].run.highs), _MOST):
        best = _apart([(*_searched(loop, n, cycles, _ROUGHLY), loop) for _, n, loop in best])
        cycles *= 2.0
    fits = []
    for _, n, loop in best:
        loop = replace(loop.within(_MOST), searched=False)
        for _ in range(_WEIGHED):
            loop = _own(loop, loop.columns(n))
            n = _least(loop, n, _FINELY)
        square = sum(
            r.size * math.log(float(r @ r) * e**2)
            for r, e in zip(loop.columns(n)[:-1], loop.noise.values(), strict=True)
        )
        fits.append((square, loop, Fitted(loop.columns, loop.jacobian, n)))
    fits.sort(key=lambda one: one[0])
    least, loop, found = fits[0]
    return loop, found, [other for square, _, other in fits[1:] if square - least < _AS_GOOD]


_Found = tuple[float, Floats, Loop]


def _apart(found: list[_Found]) -> list[_Found]:
    """Return what was found at different numbers and is not hopeless, the best first."""
    kept: list[_Found] = []
    for one in sorted(found, key=lambda one: one[0]):
        if one[0] < _HOPELESS * (kept or [one])[0][0] and all(
            np.abs(one[1] - other[1])[:2].max() > _SAME for other in kept
        ):
            kept.append(one)
    return kept[:_BEST]


def begun(run: Run) -> Run:
    """Return a run without the cycles of its start, between highs one period apart.

    ValueError of fewer than four slips. The period is that at which the record, turned about the
    mean of its ends, is most like itself: of the motor the turns are not those of the table.
    """
    if len(run.highs) < _FEWEST + 1:
        raise ValueError(f"{len(run.highs)} slips of a servo axis: fewer than {_FEWEST + 1}")
    count = len(run.highs) - 1
    step = (run.t[-1] - run.t[0]) / (run.t.size - 1)
    about = float(np.median(np.diff(run.highs)[count // 2 :]))
    some = run.within(run.highs[min(_UNSEEN, count // 3)], math.inf)
    level = some.F if some.x is None else some.x - some.speed * some.t
    s = detrend(level if some.F is None else some.F)
    like = correlate(s, s, "full")[s.size - 1 :] / np.arange(s.size, 0, -1)
    tried = about / step * np.arange(0.8, 1.25, _FINENESS)
    multiples = np.arange(1, max(int(0.6 * s.size / (1.25 * about / step)), 1) + 1)
    alike = np.interp(np.outer(tried, multiples), np.arange(s.size), like).mean(axis=1)
    period = step * float(tried[int(np.argmax(alike))])
    return replace(some, highs=tuple(np.arange(some.t[0], some.t[-1], period).tolist()))
