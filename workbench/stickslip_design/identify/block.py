"""The block on its spring over runs of a record, fitted by least squares.

The motion from break-away to break-away is the closed form of docs/theory.md (3) to (6). Of the
position it hangs on w, zeta, the gap of the spring, the feed and the first break-away alone; the
force adds the stiffness and the level at break-away.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np

from stickslip_score import Solution, scatter_of, solved

from .cycles import Run
from .model import Floats, Record
from .nonlinear import Columns, Fitted, fit

_LEAST_ZETA, _MOST_ZETA = -0.3, 0.95
_SLOWLY: Final = 1.0
"""w D/v from which a feed is slow: its period hangs on the gap as much as on w."""
_SHARES: Final = (0.85, 1.0, 1.2)
_DAMPINGS: Final = (0.02, 0.15)
_FAST: Final = (0.3, 0.7, 1.5, 3.0)
_BEST: Final = 2
_SHIFTS: Final = (-0.1, -0.03, 0.0, 0.03, 0.1)
"""Where the search starts: w over that of the turns, damping ratios, w D/v of fast feeds, and
break-aways in periods."""
_SOME: Final = 700
"""Samples with which it does."""
_CLEARER: Final = 0.7
"""Of the mean square: what a later beginning leaves of it, where the record begins in no cycle."""
_MOST_CYCLES: Final = 24
"""Cycles that are fitted one by one, where they differ."""


@dataclass(frozen=True)
class Block:
    """The block on its spring over some runs, with one spring and one damping.

    The numbers are ln w, zeta, ln k (of a force), then of each run t_break, ln D, and what else is
    free: ln v, the level of x, the force at break-away, its delay, and its drift.
    """

    runs: tuple[Run, ...]
    continued: tuple[bool, ...]
    noise: dict[str, float]
    """Standard deviations of x [m] and F [N]."""
    by_period: bool = False
    """Whether ln T of the period is the number instead of ln D: of slow feeds it is independent."""
    extras: frozenset[str] = frozenset()
    """Of "speed", "delay", "drift": what is free besides."""

    @property
    def has_force(self) -> bool:
        """Whether there is a spring's force."""
        return self.runs[0].F is not None

    def names(self, run: Run) -> list[str]:
        """Return the numbers of a run."""
        free = ["t_break", "D"]
        if "speed" in self.extras or (math.isnan(run.speed) and run.x is not None):
            free.append("v")
        free += ["x_0"] if run.x is not None else []
        if run.F is not None:
            free += ["F_b"] + ["delay"] * ("delay" in self.extras)
            free += ["drift 1", "drift 2", "drift 3"] * ("drift" in self.extras)
        return free

    @property
    def common(self) -> int:
        """How many numbers all runs share."""
        return 3 if self.has_force else 2

    def places(self) -> Iterator[tuple[Run, bool, dict[str, int]]]:
        """Yield runs, whether cycles went before, and where their numbers stand."""
        at = self.common
        for run, continued in zip(self.runs, self.continued, strict=True):
            names = self.names(run)
            shared = ["w", "zeta", "k"][: self.common]
            yield run, continued, {n: i for i, n in [*enumerate(shared), *enumerate(names, at)]}
            at += len(names)

    def solution(self, run: Run, continued: bool, place: dict[str, int], n: Floats) -> Solution:
        """Return the motion of a run."""
        v = math.exp(n[place["v"]]) if "v" in place else run.speed
        v = 1.0 if math.isnan(v) else v
        w, zeta = math.exp(n[0]), min(max(float(n[1]), _LEAST_ZETA), _MOST_ZETA)
        size = math.exp(min(max(n[place["D"]], -80.0), 40.0))
        if self.by_period:
            return of_period(size, w, zeta, v, continued)
        return Solution(w, zeta, v, size, continued)

    def of_run(self, run: Run, continued: bool, place: dict[str, int], n: Floats) -> Columns:
        """Return x [m] and F [N] of a run, as far as it has them."""
        solution, columns = self.solution(run, continued, place, n), []
        after = run.t - n[place["t_break"]]
        way = _mean_way(solution, after, run.half)
        if run.x is not None:
            columns.append(n[place["x_0"]] + way)
        if run.F is not None:
            if "delay" in place:
                after = after - n[place["delay"]]
                way = _mean_way(solution, after, run.half)
            F = n[place["F_b"]] + math.exp(n[place["k"]]) * (solution.v * after - way)
            if "drift 1" in place:
                s = 2.0 * (run.t - run.t[0]) / (run.t[-1] - run.t[0]) - 1.0
                some = n[[place[f"drift {i}"] for i in (1, 2, 3)]]
                F = F + np.polynomial.legendre.legval(s, [0.0, *some])
            columns.append(F)
        return columns

    def columns(self, n: Floats) -> Columns:
        """Return the residuals, each over its noise."""
        return [
            (is_ - seems) / self.noise[name]
            for run, continued, place in self.places()
            for name, is_, seems in zip(
                shown(run), measured(run), self.of_run(run, continued, place, n), strict=True
            )
        ]

    def jacobian(self, n: Floats) -> Columns:
        """Return their derivatives."""
        parts = []
        for run, continued, place in self.places():
            names = shown(run)
            J = [np.zeros((run.t.size, n.size)) for _ in names]
            for number, at in place.items():
                step = self._step(number, n, place)
                move = np.zeros_like(n)
                move[at] = step
                ends = [self.of_run(run, continued, place, n + s * move) for s in (1.0, -1.0)]
                for j, name, high, low in zip(J, names, *ends, strict=True):
                    j[:, at] = (low - high) / (2.0 * step * self.noise[name])
            parts += J
        return parts

    def _step(self, number: str, n: Floats, place: dict[str, int]) -> float:
        if number in ("t_break", "delay"):
            return 1e-5 / math.exp(n[place["w"]])
        if number == "x_0":
            return self.noise["x"]
        return self.noise["F"] if number in ("F_b", "drift 1", "drift 2", "drift 3") else 1e-5

    def start(self, solutions: list[Solution], breaks: list[float]) -> Floats:
        """Return numbers at which the runs are as given solutions, their levels at best."""
        n = np.zeros(self.common + sum(len(self.names(run)) for run in self.runs))
        n[:2] = math.log(solutions[0].w), solutions[0].zeta
        ratios = []
        for solution, begin, (run, _, place) in zip(solutions, breaks, self.places(), strict=True):
            n[[place["t_break"], place["D"]]] = begin, self._size(solution)
            if "v" in place:
                n[place["v"]] = math.log(solution.v)
            after = run.t - begin
            way = solution.position(after)
            if run.x is not None:
                n[place["x_0"]] = float(np.mean(run.x - way))
            if run.F is not None:
                slope, n[place["F_b"]] = np.polyfit(solution.v * after - way, run.F, 1)
                ratios.append(float(slope))
        if ratios:
            n[2] = math.log(max(float(np.median(ratios)), 1e-300))
        return n

    def _size(self, solution: Solution) -> float:
        return math.log(solution.figures()["period"] if self.by_period else solution.D)

    def carried(self, other: Block, n: Floats) -> Floats:
        """Return numbers of another block of the same runs as those of this one, others 0."""
        new = np.zeros(self.common + sum(len(self.names(run)) for run in self.runs))
        for (run, _, to), (_, _, at) in zip(self.places(), other.places(), strict=True):
            for name, place in to.items():
                new[place] = (
                    n[at[name]] if name in at else math.log(run.speed) if name == "v" else 0.0
                )
        return new


def of_period(period: float, w: float, zeta: float, v: float, continued: bool) -> Solution:
    """Return the solution of a period [s], by the end of its slip: docs/theory.md (3) to (6).

    Where a slip would end at a time, the extension D at its begin follows in closed form.
    """
    decay, turn = zeta * w, w * math.sqrt(1.0 - zeta * zeta)

    def cycle(y: float) -> tuple[float, float, float]:
        t_slip = (math.pi + math.exp(y)) / turn
        e, s = math.exp(-decay * t_slip), -math.sin(math.exp(y))
        h0, h1 = e * (-math.cos(math.exp(y)) + decay / turn * s), e * s / turn
        D = -v / w * ((1.0 - h0) / (w * h1) + 2.0 * zeta)
        return D, t_slip, (D * (1.0 - h0) - v * h1) / v + t_slip

    # Slow feeds: ln T is nearly linear in y.
    y = math.log(min(max(4.0 / max(w * period - math.pi, 1e-9), 1e-12), 2.0))
    for _ in range(40):
        D, t_slip, seen = cycle(y)
        slope = (math.log(cycle(y + 1e-5)[2]) - math.log(cycle(y - 1e-5)[2])) / 2e-5
        if slope >= -1e-6:
            break
        step = math.log(seen / period) / -slope
        y = min(y + min(max(step, -2.0), 2.0), 0.5 * (y + 1.1) if y + step > 1.1 else 1.1)
        if abs(step) < 1e-13:
            break
    found = Solution(w, zeta, v, max(D, 1e-12 * v / w), continued)
    if D > 0.0 and abs(seen / period - 1.0) < 1e-9:
        # Known so far to the last digit, it need not be sought.
        found.__dict__["t_slip"] = t_slip
    return found


def _mean_way(solution: Solution, after: Floats, half: float) -> Floats:
    """Return the way at times, or its means over times that scatter by `half`."""
    if half == 0.0:
        return solution.position(after)
    return 0.5 * (solution.position(after - half) + solution.position(after + half))


def shown(run: Run) -> list[str]:
    """Return which columns a run has, of "x" and "F"."""
    return [name for name in ("x", "F") if getattr(run, name) is not None]


def measured(run: Run) -> Columns:
    """Return the columns of a run: x [m] and F [N], turned forward."""
    return [s for s in (run.x, run.F) if s is not None]


def noise_of(record: Record, runs: list[Run]) -> dict[str, float]:
    """Return about the noise of x and F in the runs: their scatter, or their digits."""
    noise = {}
    for name, column in (("x", "position"), ("F", "force")):
        some = [(run.t, s) for run in runs if (s := getattr(run, name)) is not None]
        if some:
            of = [scatter_of(*one) for one in some]
            digits = record.rounding.get(column, 0.0) / math.sqrt(3.0)
            least = 1e-9 * max(float(np.ptp(s)) for _, s in some)
            noise[name] = max(float(np.nanmedian([*of, 0.0][: len(of)])), digits, least)
    return noise


def fitted(block: Block) -> tuple[Block, Fitted]:
    """Return the fit of runs, from the best of several starts, with its own noise."""
    begun, starts = [], []
    for run in block.runs:
        part = _searched(replace(block, runs=(run,), continued=(False,)))
        begun.append(part[0])
        starts.append(part[1])
    block = replace(
        block,
        by_period=False,
        runs=tuple(b.runs[0] for b in begun),
        continued=tuple(b.continued[0] for b in begun),
    )
    solutions, breaks = [], []
    for one, n in zip(begun, starts, strict=True):
        ((run, continued, place),) = one.places()
        solutions.append(one.solution(run, continued, place, n))
        breaks.append(float(n[place["t_break"]]))
    if len(begun) > 1:
        w = float(np.median([s.w for s in solutions]))
        zeta = float(np.median([s.zeta for s in solutions]))
        periods = [s.figures()["period"] for s in solutions]
        solutions = [
            s if math.isnan(T) else _with_period(replace(s, w=w, zeta=zeta), T)
            for s, T in zip(solutions, periods, strict=True)
        ]
    block = _slow(block, solutions)
    found = fit(block.columns, block.jacobian, block.start(solutions, breaks))
    return reweighted(block, found)


def _slow(block: Block, solutions: list[Solution]) -> Block:
    lam = [s.w * s.D / s.v for s in solutions]
    return replace(
        block, by_period=min(lam) > _SLOWLY and all(s.t_slip < math.inf for s in solutions)
    )


def reweighted(block: Block, found: Fitted) -> tuple[Block, Fitted]:
    """Return the fit with the noise that its residual has."""
    names = [name for run in block.runs for name in shown(run)]
    noise = {}
    for name, size in block.noise.items():
        parts = [r for r, n in zip(found.residual, names, strict=True) if n == name]
        rms = math.sqrt(float(np.mean(np.concatenate(parts) ** 2)))
        noise[name] = size * max(rms, 1e-3)
    block = replace(block, noise=noise)
    return block, fit(block.columns, block.jacobian, found.value)


def _with_period(solution: Solution, period: float) -> Solution:
    v, w = solution.v, solution.w
    return solved(solution, "period", period, "D", 1e-3 * v / w, 0.5 * v * period)


def _searched(block: Block) -> tuple[Block, Floats]:
    """Return a block of one run, as it begins, and numbers near its best."""
    (run,) = block.runs
    later = run.within(0.5 * (run.lows[0] + run.highs[1]), math.inf)
    ways = [(run, False)]
    if run.start == -math.inf:
        ways += [(run, True)]
        if len(later.highs) > 1 and later.lows:
            ways += [(later, False)]
    tried = []
    for begun, continued in ways:
        one = replace(block, runs=(_strided(begun),), continued=(continued,))
        best: dict[Solution, tuple[float, float]] = {}
        for s, at in _starts(begun, continued):
            square = float(sum(r @ r for r in one.columns(one.start([s], [at]))))
            best[s] = min(best.get(s, (math.inf, at)), (square, at))
        for s in sorted(best, key=lambda s: best[s])[:_BEST]:
            slow = _slow(one, [s])
            found = fit(slow.columns, slow.jacobian, slow.start([s], [best[s][1]]))
            square = _CLEARER * float(np.mean(np.concatenate(found.residual) ** 2))
            if begun is later:
                square /= _CLEARER
            tried.append((square, begun, continued, slow.by_period, found.value))
    _, begun, continued, by_period, value = min(tried, key=lambda one: one[0])
    return replace(block, runs=(begun,), continued=(continued,), by_period=by_period), value


def _strided(run: Run) -> Run:
    stride = -(-run.t.size // _SOME)
    x, F = (None if s is None else s[::stride] for s in (run.x, run.F))
    return replace(run, t=run.t[::stride], x=x, F=F)


def _starts(run: Run, continued: bool) -> Iterator[tuple[Solution, float]]:
    first, period = run.first(), run.period
    if math.isnan(run.speed) and run.x is not None:
        places = np.interp([run.highs[0], run.highs[-1]], run.t, run.x)
        first = replace(first, v=float(np.diff(places)[0]) / (run.highs[-1] - run.highs[0]))
    tried = []
    for zeta in _DAMPINGS:
        for share in _SHARES:
            w = max(share * first.w, 1.02 * math.pi / period)
            tried.append(_with_period(replace(first, w=w, zeta=zeta), period))
        for lam in _FAST:
            # The period without damping: so fast it hardly depends on the gap.
            w = 2.0 * (lam + math.pi - math.atan(lam)) / period
            tried.append(replace(first, w=w, zeta=0.2 * lam * zeta, D=lam * first.v / w))
    for one in tried:
        if math.isnan(one.figures()["period"]):
            continue
        turn = math.atan2(one.v, one.w * one.D) / one.w
        one = replace(one, continued=continued)
        yield from ((one, run.highs[0] - turn + shift * period) for shift in _SHIFTS)


def one_by_one(block: Block, found: Fitted) -> tuple[Block, Fitted]:
    """Return the fit with each cycle on its own: one spring and damping, a gap for each slip."""
    runs, solutions, breaks = [], [], []
    for run, continued, place in block.places():
        solution = block.solution(run, continued, place, found.value)
        middles = [0.5 * (low + high) for low, high in zip(run.lows, run.highs[1:], strict=False)]
        edges = [float(run.t[0]), *middles, float(run.t[-1])]
        every = -(-len(edges) // _MOST_CYCLES)
        for begin, end in list(pairwise(edges))[::every]:
            part = run.within(begin, end)
            if part.highs and part.lows and part.t.size > 10:
                runs.append(part)
                turn = math.atan2(solution.v, solution.w * solution.D) / solution.w
                solutions.append(Solution(solution.w, solution.zeta, solution.v, solution.D))
                breaks.append(part.highs[0] - turn)
    if len(runs) < 2:
        return block, found
    keep = block.extras - {"speed", "drift"}
    new = replace(
        block, runs=tuple(runs), continued=(False,) * len(runs), extras=keep, by_period=False
    )
    return reweighted(new, fit(new.columns, new.jacobian, new.start(solutions, breaks)))
