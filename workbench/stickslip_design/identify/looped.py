"""What a record of stick-slip tells of a servo axis: the fit predicts the motion of its loop.

While the table jumps the drive gives way and catches up, so the numbers are those with which the
loop of docs/feed-axis.md moves as the record shows. The drive is taken as its file states it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product
from typing import Final

import numpy as np

from ..axis import Axis, Friction
from ..loop.jumps import loaded
from ..loop.motion import Point, Watched, walk
from ..loop.native import over_sample
from ..loop.system import FORCE, INTEGRAL, LAST, MOTOR, TABLE, Mode, System
from .block import LEVELS, Block, Fitted, figures_of, noise_of, weighed
from .cycles import Run
from .model import Floats, Record

_SETTLED, _SETTLES = 4, 13
"""Cycles whose mean is the period, and after which the start is forgotten."""
_TRIES: Final = 6
"""Of gaps, until the period is that of the record."""
_STIFFNESSES, _MASSES, _DAMPING = (0.5, 0.75, 1.0, 1.4, 2.0), (0.7, 1.3), 0.02
"""Where the search starts: stiffness and mass over those of the axis, and the least damping."""
_STAGES: Final = ((2.4, 3), (4.8, 3), (24.0, 2))
"""Cycles over which the best are searched from, one after the other, and how many of them."""
_ROUGHLY, _ROUGH, _FINELY, _FINE = 20, 1e-4, 50, 1e-6
"""Trials, and the gain of a step at the end: of first searches, and of the last ones."""
_SHIFTS: Final = 256
"""Places over a cycle at which a start is tried."""
_BLOCK: Final = 256
"""Samples of the controller that are followed at once."""
_LATE: Final = 1e-9
"""Of a sample: before it the controller has not yet had its turn."""
_NO: Final = 1e9
"""What a motion without bounds is said to show [m], [N]."""
_FEWEST: Final = 3
"""Cycles that are fitted at least."""
_USUAL: Final = (0.5, 0.5, 0.1, 0.5, 1.0, 1.0, 1.0)
_FARTHEST: Final = ((-1.2, -1.2, -0.1, -2.5), (1.2, 1.2, 1.0, 2.5))
"""Of the numbers but the levels: how far from where a search begins they usually are; and beyond
what the first four are not tried."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Loop(Block):
    """A servo axis over a run of cycles, the table at rest in its first sample.

    The numbers are ln m, ln k, the damping over that at which the table would creep back,
    ln (F_s - F_k); at the first sample the place of the motor, the integral, and the set point;
    each less that of the start; then the levels, that of F the kinetic friction.
    """

    axis: Axis
    """Where the search begins: its table never goes back."""
    state: Floats
    """That of the start at the first sample."""

    @property
    def usual(self) -> tuple[float, ...]:
        """What is soon forgotten the samples do not show: it is as usual."""
        return _USUAL

    def candidate(self, n: Floats) -> Axis:
        """Return the axis with numbers."""
        m, k, c, gap = np.clip(n[:4], *_FARTHEST).tolist()
        axis = self.axis
        other = replace(
            axis,
            m=axis.m * math.exp(m),
            k=axis.k * math.exp(k),
            c=axis.c + c * 2.0 * math.sqrt(axis.k * axis.m),
        )
        return _rubbing(other, axis.F_k, (axis.F_s - axis.F_k) * math.exp(gap))

    @np.errstate(all="ignore")
    def seen(self, n: Floats) -> dict[str, Floats]:
        """Return x [m] and F [N] at the samples, but for their levels."""
        system, t = System(self.candidate(n)), self.run.t - self.run.t[0]
        T_s, layout = system.drive.T_s, system.layout
        place = TABLE if system.drive.on_table else MOTOR
        rows = [place, FORCE if system.drive.lag > 0.0 else layout.commands]
        over = np.array([over_sample(system, Mode(slips, 1)) for slips in (0, 1)])
        shown = np.eye(layout.size)[rows][None].repeat(2, axis=0)
        # Rows at each sample of a block, and what a block makes of the state.
        while shown.shape[1] < _BLOCK * len(rows):
            shown, over = np.concatenate([shown, shown @ over], axis=1), over @ over
        count, at = math.ceil(t[-1] / T_s - 1e-3) + 1, 0
        seen = np.empty((count + _BLOCK, 2))
        motion = walk(system, Mode(0, 1), Point(self._begun(system, n), 0.0), Watched(math.inf))
        while at < count:
            slips, state = motion.mode.table, motion.point.state.copy()
            motion.go_on((count - at) * T_s)
            events = motion.turns(1)
            last = int(events[0].time / T_s) if events else count - 1
            for begin in range(at, last + 1, _BLOCK):
                seen[begin : begin + _BLOCK] = (shown[slips] @ state).reshape(-1, 2)
                state = over[slips] @ state
            at = last + 1
            while events:
                motion.go_on((at - _LATE) * T_s - events[0].time)
                events = motion.turns(1)
        seen = np.nan_to_num(seen[:count] - [0.0, self.axis.F_k], nan=_NO, posinf=_NO, neginf=-_NO)
        # Between the samples of the controller, where the record has others, it is nearly straight.
        x, F = (np.interp(t / T_s, np.arange(count), column) for column in seen.T)
        return {"x": x, "F": F}

    def _begun(self, system: System, n: Floats) -> Floats:
        """Return the state at the first sample."""
        layout, drive, k, state = system.layout, system.drive, system.axis.k, self.state.copy()
        # Some F_s - F_k.
        force = 3.0 * (self.axis.F_s - self.axis.F_k)
        # The spring's force stays as it is where its stiffness varies, and what follows the motor.
        motor = n[4] * force / k + state[MOTOR] * (self.axis.k / k - 1.0)
        state[[MOTOR, LAST]] += motor
        state[layout.command] += motor * (not drive.on_table)
        state[layout.command] += n[6] * force / (drive.K_p * drive.K_v)
        state[INTEGRAL] += n[5] * force
        return state

    def figures(self, n: Floats, axis: Axis | None) -> dict[str, float]:
        """Return what the columns tell of the axis, by name."""
        axis = self.candidate(n)
        m, k, gap = axis.m, axis.k, (axis.F_s - axis.F_k) / axis.k
        return figures_of(k / m, axis.c / m, gap, k, float(n[-1]) + k * gap)

    def unknown(self) -> dict[str, str]:
        """Return numbers that the columns do not tell, and why."""
        why = "without the force of the motor its level is not in the record"
        return {} if "F" in self.noise else dict.fromkeys(LEVELS, why)

    def rhythm(self, n: Floats) -> tuple[float, float, float]:
        """Return the begin and the period [s]; how long a slip is it does not say."""
        return float(self.run.t[0]), self.run.period, math.nan


def _rubbing(axis: Axis, F_k: float, gap: float) -> Axis:
    """Return an axis with kinetic friction, and what static friction is above [N]."""
    N = axis.normal_force
    return replace(axis, friction=Friction(mu_s=(F_k + gap) / N, mu_k=F_k / N))


def _settled(axis: Axis, run: Run) -> tuple[float, Floats] | None:
    """Return the period of settled jumps [s], and the state in the middle of a rest at a sample.

    None where there are none.
    """
    system, most = System(axis), 2 * _SETTLES + 1
    T_s, end = system.drive.T_s, 3.0 * _SETTLES * run.period
    settling = walk(system, Mode(0, 1), loaded(system, run.speed), Watched(end))
    turns = settling.turns(most)
    if len(turns) < most or any(turn.mode.table < 0 for turn in turns):
        return None
    period = (turns[-1].time - turns[-1 - 2 * _SETTLED].time) / _SETTLED
    onward, offset = period - 0.5 * (turns[-1].time - turns[-2].time), settling.point.offset
    settling.go_on(max(round((onward + offset) / T_s), 1) * T_s - offset)
    settling.turns(2)
    state = settling.point.state.copy()
    state[[MOTOR, LAST, system.layout.command, TABLE]] -= state[TABLE]
    return period, state


def _starts(axis: Axis, run: Run, noise: dict[str, float]) -> Iterator[Fitted]:
    """Yield loops whose settled jumps have the period of the run, where they are most like it."""
    # The spring gives way by about half of what the feed goes in a period.
    way = 0.5 * run.speed * run.period
    slides = max(axis.F_k, 4.0 * max(_STIFFNESSES) * axis.k * way)
    for mass, stiffness in product(_MASSES, _STIFFNESSES):
        one = replace(axis, m=mass * axis.m, k=stiffness * axis.k)
        one = replace(one, c=max(axis.c, 2.0 * _DAMPING * math.sqrt(axis.k * axis.m)))
        gap = one.k * way
        for _ in range(_TRIES):
            settled = _settled(begun := _rubbing(one, slides, gap), run)
            if settled is None:
                break
            gap *= run.period / settled[0]
        if settled is not None:
            yield _placed(Loop(run=run, noise=noise, axis=begun, state=settled[1]))


def _placed(loop: Loop) -> Fitted:
    """Return a loop from where in the first cycle it is most like the run, with its levels."""
    run, n = loop.run, np.zeros(len(_USUAL) + len(loop.noise))
    first = _over(run, float(run.t[0]), _STAGES[0][0])
    seen, size = replace(loop, run=first).seen(n), first.t.size
    last = min(int(np.searchsorted(run.t, run.t[0] + run.period)), run.t.size - size)

    def unlike(at: int) -> float:
        pairs = [(run.columns[q][at : at + size] - seen[q], e) for q, e in loop.noise.items()]
        return sum(float(np.var(off)) / e**2 for off, e in pairs)

    begin = float(run.t[min(range(0, last, max(last // _SHIFTS, 1)), key=unlike)])
    placed = replace(loop, run=_over(run, begin, _STAGES[0][0]))
    return Fitted(placed, placed.levelled(n))


def _over(run: Run, begin: float, count: float) -> Run:
    """Return so many cycles of a run."""
    return run.within(begin, begin + count * run.period)


def fitted_loop(record: Record, axis: Axis, run: Run) -> Fitted:
    """Return the fit of a run with its own noise, from the best of several starts.

    ValueError where the axis as stated does not jump at this feed, or a run is too short.
    """
    if math.isnan(run.speed) and "x" in run.columns:
        run = replace(run, speed=float(np.polyfit(run.t, run.columns["x"], 1)[0]))
    if math.isnan(run.speed):
        raise ValueError("the feed is not in the record: state one feed")
    if len(run.highs) <= _FEWEST:
        raise ValueError(f"{len(run.highs)} slips of a servo axis: fewer than {_FEWEST + 1}")
    run = run.within(run.highs[1], math.inf)
    found = [*_starts(axis, run, noise_of(record, run))]
    if not found:
        raise ValueError("the axis as its file states it does not jump at this feed: no start")
    for count, most in _STAGES:
        best = sorted(found, key=lambda one: one.unlikelihood)[:most]
        # Far from the minimum what is usual of a start counts as much as the residual.
        runs = [_over(run, float(one.motion.run.t[0]), count) for one in best]
        found = [
            weighed(Fitted(replace(one.motion, run=more), one.value), _ROUGHLY, _ROUGH)
            for one, more in zip(best, runs, strict=True)
        ]
    return weighed(min(found, key=lambda one: one.unlikelihood), _FINELY, _FINE)
