"""The block on its spring over runs of a record, fitted by least squares.

The motion from break-away to break-away is the closed form of docs/theory.md (3) to (6). Of the
position it hangs on w, zeta, the gap of the spring, the feed and the first break-away alone; the
force adds the stiffness and the level at break-away.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise, product
from typing import Final

import numpy as np

from stickslip_score import Solution, scatter_of, solved

from .cycles import Run, digit_of
from .model import Floats, Record
from .nonlinear import Columns, Fitted, fit

_LEAST_ZETA, _MOST_ZETA = -0.3, 0.95
_SHARES, _DAMPINGS, _FAST = (0.85, 1.0, 1.2), (0.02, 0.15), (0.3, 0.7, 1.5, 3.0)
_SHIFTS: Final = (-0.1, -0.03, 0.0, 0.03, 0.1)
"""Where the search starts: w over that of the turns, damping ratios, w D/v of fast feeds, and
break-aways in periods."""
_BEST: Final = 2
_SOME: Final = 700
"""Samples with which it does."""
_MOST_CYCLES: Final = 24
"""Cycles that are fitted one by one, where they differ."""
_EXACT: Final = 1e-7
"""Of the range of a column, what is no noise but a solver's tolerance."""
DRIFTS: Final = ("drift 1", "drift 2", "drift 3")


@dataclass(frozen=True)
class Block:
    """The block on its spring over some runs, with one spring and one damping.

    The numbers are ln w, zeta, ln k (of a force), then of each run t_break, ln D, and what else is
    free: ln v, the level of x, the force at break-away, its delay, and its drift.
    """

    runs: tuple[Run, ...]
    """Each begins in a rest."""
    noise: dict[str, float]
    """Standard deviations of x [m] and F [N]."""
    extras: tuple[str, ...] = ()
    """"delay" or the drifts, free besides."""

    @property
    def has_force(self) -> bool:
        """Whether there is a spring's force."""
        return self.runs[0].F is not None

    def places(self) -> Iterator[tuple[Run, dict[str, int]]]:
        """Yield runs, and where their numbers stand."""
        shared = ["w", "zeta", "k"][: 3 if self.has_force else 2]
        at = len(shared)
        for run in self.runs:
            names = ["t_break", "D"]
            if run.x is not None:
                names += ["v", "x_0"] if math.isnan(run.speed) else ["x_0"]
            names += ["F_b", *self.extras] if run.F is not None else []
            yield run, {n: i for i, n in [*enumerate(shared), *enumerate(names, at)]}
            at += len(names)

    def solutions(self, n: Floats) -> list[Solution]:
        """Return the motions of the runs."""
        w, zeta, motions = _exp(n[0]), min(max(float(n[1]), _LEAST_ZETA), _MOST_ZETA), []
        for run, place in self.places():
            v = _exp(n[place["v"]]) if "v" in place else run.speed
            D = _exp(n[place["D"]])
            motions.append(Solution(w, zeta, 1.0 if math.isnan(v) else v, D))
        return motions

    def columns_of(self, n: Floats) -> list[Columns]:
        """Return x [m] and F [N] of the runs, as far as they have them."""
        every: list[Columns] = []
        for (run, place), motion in zip(self.places(), self.solutions(n), strict=True):
            after, columns = run.t - n[place["t_break"]], list[Floats]()
            way = motion.position(after)
            if run.x is not None:
                columns.append(n[place["x_0"]] + way)
            if run.F is not None:
                if "delay" in place:
                    after = after - n[place["delay"]]
                    way = motion.position(after)
                F = n[place["F_b"]] + _exp(n[place["k"]]) * (motion.v * after - way)
                if "drift 1" in place:
                    s = 2.0 * (run.t - run.t[0]) / (run.t[-1] - run.t[0]) - 1.0
                    F += np.polynomial.legendre.legval(s, [0.0, *(n[place[d]] for d in DRIFTS)])
                columns.append(F)
            every.append(columns)
        return every

    def columns(self, n: Floats) -> Columns:
        """Return the residuals, each over its noise."""
        return [
            (is_ - seems) / self.noise[name]
            for run, model in zip(self.runs, self.columns_of(n), strict=True)
            for name, is_, seems in zip(shown(run), measured(run), model, strict=True)
        ]

    def jacobian(self, n: Floats) -> Columns:
        """Return their derivatives."""
        places = [place for run, place in self.places() for _ in shown(run)]
        J = [np.zeros((r.size, n.size)) for run in self.runs for r in measured(run)]
        steps = {"x_0": self.noise.get("x", 0.0)} | dict.fromkeys(("t_break", "delay"), 1e-5)
        steps |= dict.fromkeys(("F_b", *DRIFTS), self.noise.get("F", 0.0))
        for name in dict.fromkeys(name for place in places for name in place):
            # A number of its own moves the columns of its run alone: of all runs at once.
            step, move = steps.get(name, 1e-5), np.zeros_like(n)
            if name in ("t_break", "delay"):
                step /= _exp(n[0])
            move[[place[name] for place in places if name in place]] = step
            ends = [self.columns(n + side * move) for side in (1.0, -1.0)]
            for j, place, high, low in zip(J, places, *ends, strict=True):
                if name in place:
                    j[:, place[name]] = (high - low) / (2.0 * step)
        return J

    def start(self, solutions: list[Solution], breaks: list[float]) -> Floats:
        """Return numbers at which the runs are as given solutions, their levels at best."""
        places = list(self.places())
        n = np.zeros(1 + max(places[-1][1].values()))
        n[:2], ratios = (math.log(solutions[0].w), solutions[0].zeta), []
        for solution, begin, (run, place) in zip(solutions, breaks, places, strict=True):
            n[[place["t_break"], place["D"]]] = begin, math.log(solution.D)
            after = run.t - begin
            way = solution.position(after)
            if "v" in place:
                n[place["v"]] = math.log(solution.v)
            if run.x is not None:
                n[place["x_0"]] = float(np.mean(run.x - way))
            if run.F is not None:
                slope, n[place["F_b"]] = np.polyfit(solution.v * after - way, run.F, 1)
                ratios.append(float(slope))
        if ratios:
            n[2] = math.log(max(float(np.median(ratios)), 1e-300))
        return n

    def carried(self, other: Block, n: Floats) -> Floats:
        """Return numbers of another block of the same runs as those of this one, new ones 0."""
        pairs = list(zip(self.places(), other.places(), strict=True))
        new = np.zeros(1 + max(pairs[-1][0][1].values()))
        for (_, to), (_, at) in pairs:
            new[[to[name] for name in at if name in to]] = n[[at[m] for m in at if m in to]]
        return new

    def fitted(self, start: Floats) -> tuple[Block, Fitted]:
        """Return the fit from a start, with the noise that its residual has."""
        found = fit(self.columns, self.jacobian, start)
        names, noise = [name for run in self.runs for name in shown(run)], {}
        for name, size in self.noise.items():
            parts = [r for r, n in zip(found.residual, names, strict=True) if n == name]
            noise[name] = size * max(float(np.sqrt(np.mean(np.concatenate(parts) ** 2))), 1e-3)
        block = replace(self, noise=noise)
        return block, fit(block.columns, block.jacobian, found.value)


def _exp(n: float) -> float:
    """Return a number by its logarithm, above 0 however far a step of the search goes."""
    return math.exp(min(max(n, -80.0), 80.0))


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
            scatter = float(np.median(np.nan_to_num([scatter_of(*one) for one in some])))
            digits = record.rounding.get(column, 0.5 * digit_of(some[0][1])) / math.sqrt(3.0)
            noise[name] = max(scatter, digits, _EXACT * max(float(np.ptp(s)) for _, s in some))
    return noise


def fitted(block: Block) -> tuple[Block, Fitted]:
    """Return the fit of runs, from the best of several starts of each, with its own noise."""
    best = [_searched(replace(block, runs=(run,))) for run in block.runs]
    if len(best) > 1:
        w, zeta = (float(np.median([getattr(s, n) for s, _ in best])) for n in ("w", "zeta"))
        best = [
            (_with_period(replace(s, w=w, zeta=zeta), T), at)
            for (s, at), T in zip(best, (s.figures()["period"] for s, _ in best), strict=True)
        ]
    return block.fitted(block.start([s for s, _ in best], [at for _, at in best]))


def _with_period(solution: Solution, period: float) -> Solution:
    v, w = solution.v, solution.w
    if math.isnan(period):
        return solution
    return solved(solution, "period", period, "D", 1e-3 * v / w, 0.5 * v * period)


def _searched(block: Block) -> tuple[Solution, float]:
    """Return the motion nearest to a run, and its first break-away [s]."""
    run = block.runs[0].at(slice(None, None, -(-block.runs[0].t.size // _SOME)))
    one, found = replace(block, runs=(run,)), []
    starts = [one.start([s], [at]) for s, at in _starts(block.runs[0])]
    squares = np.array([sum(float(r @ r) for r in one.columns(n)) for n in starts])
    nearest = squares.reshape(-1, len(_SHIFTS))
    for motion in np.argsort(nearest.min(axis=1))[:_BEST].tolist():
        at = motion * len(_SHIFTS) + int(nearest[motion].argmin())
        found.append(fit(one.columns, one.jacobian, starts[at]))
    best = min(found, key=lambda each: sum(float(r @ r) for r in each.residual)).value
    return one.solutions(best)[0], float(best[next(one.places())[1]["t_break"]])


def _starts(run: Run) -> Iterator[tuple[Solution, float]]:
    """Yield solutions of about the period of a run, and their first break-aways [s]."""
    period, v = run.period, run.speed
    if math.isnan(v):
        v = 1.0 if run.x is None else float(np.polyfit(run.t, run.x, 1)[0])
    half = float(np.median(np.subtract(run.lows, run.highs[: len(run.lows)])))
    # Highest and lowest extension lie half a free swing apart.
    first, tried = max(math.pi / half, 1.05 * math.pi / period), []
    for share, zeta in product(_SHARES, _DAMPINGS):
        w = max(share * first, 1.02 * math.pi / period)
        tried.append(_with_period(Solution(w, zeta, v, v / w), period))
    for lam, zeta in product(_FAST, _DAMPINGS):
        # The period without damping: so fast it hardly depends on the gap.
        w = 2.0 * (lam + math.pi - math.atan(lam)) / period
        tried.append(Solution(w, 0.2 * lam * zeta, v, lam * v / w))
    for s in tried:
        turn = math.atan2(s.v, s.w * s.D) / s.w
        if math.isfinite(s.t_slip):
            yield from ((s, run.highs[0] - turn + shift * period) for shift in _SHIFTS)


def one_by_one(block: Block, found: Fitted) -> tuple[Block, Fitted]:
    """Return the fit with each cycle on its own: one spring and damping, a gap for each slip."""
    runs, solutions, breaks = [], [], []
    for run, s in zip(block.runs, block.solutions(found.value), strict=True):
        middles = [0.5 * (low + high) for low, high in zip(run.lows, run.highs[1:], strict=False)]
        edges = [float(run.t[0]), *middles, float(run.t[-1])]
        for begin, end in list(pairwise(edges))[:: -(-len(edges) // _MOST_CYCLES)]:
            part = run.within(begin, end)
            if part.highs and part.lows and part.t.size > 10:
                runs.append(part)
                solutions.append(s)
                breaks.append(part.highs[0] - math.atan2(s.v, s.w * s.D) / s.w)
    if len(runs) < 2:
        return block, found
    extras = tuple(name for name in block.extras if name not in DRIFTS)
    new = replace(block, runs=tuple(runs), extras=extras)
    return new.fitted(new.start(solutions, breaks))
