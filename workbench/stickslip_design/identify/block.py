"""The block on its spring over a run of a record, fitted by least squares.

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

from stickslip_score import Solution, scatter_of

from ..axis import Axis
from .cycles import Run, digit_of
from .model import Floats, Record
from .nonlinear import Columns, Fitted, Motion, fit, weighed

_LEAST_ZETA, _MOST_ZETA, _USUAL_ZETA = -0.3, 0.95, 0.5
_RATIOS, _DAMPINGS = (0.3, 0.6, 1.2, 2.0, 3.0, 4.5, 7.0, 11.0, 18.0, 30.0), (0.02, 0.15)
_SHIFTS: Final = (-0.1, -0.03, 0.0, 0.03, 0.1)
"""Where the search starts: w D/v, damping ratios, and break-aways in periods."""
_BEST: Final = 2
_SOME: Final = 700
"""Samples with which it does."""
_EXACT: Final = 1e-7
"""Of the range of a column, what is no noise but a solver's tolerance."""
_STEP: Final = 1e-5
"""Of a difference quotient: of a number, or of the period."""
LEVELS, COEFFICIENTS = ("friction.F_s", "friction.F_k"), ("friction.mu_s", "friction.mu_k")
LOAD_UP: Final = (
    "the position tells (F_s - F_k)/k; a load-up from a relaxed spring tells them apart"
)
_BY_SPEED: Final = ("gap", "axis.stiffness", "axis.mass", "axis.c")
_EDGE: Final = 1e-3
"""Of the damping ratio: how near to a slip without an end a fit tells nothing by its slopes."""
DRIFTS: Final = ("drift 1", "drift 2", "drift 3")


@dataclass(frozen=True, eq=False)
class Block(Motion):
    """The block on its spring over a run that begins in a rest."""

    extras: tuple[str, ...] = ()
    """"delay" or the drifts, free besides."""

    @property
    def names(self) -> list[str]:
        """The numbers, of w, D, k and v their logarithms."""
        names = ["w", "zeta", "t_break", "D"]
        if "x" in self.noise:
            names += ["v", "x_0"] if math.isnan(self.run.speed) else ["x_0"]
        return [*names, "k", "F_b", *self.extras] if "F" in self.noise else names

    def by_name(self, n: Floats) -> dict[str, float]:
        """Return the numbers by name."""
        q = dict(zip(self.names, n.tolist(), strict=True))
        # However far a step of the search goes.
        return q | {name: math.exp(min(max(q[name], -80.0), 80.0)) for name in "wDkv" if name in q}

    @property
    def steps(self) -> Floats:
        """Steps of difference quotients."""
        period = float(np.ptp(self.run.t)) / len(self.run.highs)
        steps = dict.fromkeys(("t_break", "delay"), _STEP * period)
        steps |= dict.fromkeys(("F_b", *DRIFTS), self.noise.get("F", 0.0))
        steps["x_0"] = self.noise.get("x", 0.0)
        return np.array([steps.get(name, _STEP) for name in self.names])

    @property
    def usual(self) -> Floats:
        """A damping ratio beyond its limits shows nothing: it comes back from there."""
        return np.array([_USUAL_ZETA if name == "zeta" else math.inf for name in self.names])

    def motion(self, n: Floats) -> Solution:
        """Return the motion of the block."""
        q, v = self.by_name(n), self.run.speed
        v = q.get("v", 1.0 if math.isnan(v) else v)
        return Solution(q["w"], min(max(q["zeta"], _LEAST_ZETA), _MOST_ZETA), v, q["D"])

    def columns(self, n: Floats) -> Columns:
        """Return the residuals."""
        q, motion, t = self.by_name(n), self.motion(n), self.run.t
        after, seems = t - q["t_break"], {}
        if "x" in self.noise:
            seems["x"] = q["x_0"] + motion.position(after)
        if "F" in self.noise:
            after = after - q.get("delay", 0.0)
            level = [q["F_b"], *(q.get(name, 0.0) for name in DRIFTS)]
            seems["F"] = q["k"] * (motion.v * after - motion.position(after))
            seems["F"] += np.polynomial.legendre.legval(np.linspace(-1.0, 1.0, t.size), level)
        return [(self.run.columns[name] - s) / self.noise[name] for name, s in seems.items()]

    def start(self, motion: Solution, begin: float) -> Floats:
        """Return the numbers of a motion that breaks away at a time, its levels at best."""
        after, columns = self.run.t - begin, self.run.columns
        way = motion.position(after)
        q = {"w": math.log(motion.w), "zeta": motion.zeta, "t_break": begin}
        q |= {"D": math.log(motion.D), "v": math.log(motion.v)}
        if "x" in columns:
            q["x_0"] = float(np.mean(columns["x"] - way))
        if "F" in columns:
            k, q["F_b"] = np.polyfit(motion.v * after - way, columns["F"], 1).tolist()
            q["k"] = math.log(max(k, 1e-300))
        return np.array([q.get(name, 0.0) for name in self.names])

    def more(self, found: Fitted[Block], *extras: str) -> Fitted[Block]:
        """Return the fit with more that is free, from one without it."""
        wider = replace(self, extras=(*self.extras, *extras))
        return weighed(fit(wider, np.append(found.value, np.zeros(len(extras)))))

    def figures(self, n: Floats, axis: Axis | None) -> dict[str, float]:
        """Return what the columns tell of the axis, by name."""
        q, motion = self.by_name(n), self.motion(n)
        w2, c_m = motion.w**2, 2.0 * float(n[1]) * motion.w
        gap = motion.D + 2.0 * motion.zeta * motion.v / motion.w
        g, load, m = (axis.g, axis.load, axis.m) if axis else (9.81, 0.0, 1.0)
        along = self.run.sign * axis.along if axis else 0.0
        figures = {"k/m": w2, "c/m": c_m, "gap": gap}
        if "k" in q:
            k, F_s = q["k"], q["F_b"] + along
            figures |= {"axis.stiffness": k, "axis.mass": k / w2, "axis.c": c_m * k / w2}
            figures |= {"F_s - F_k": k * gap, "friction.F_s": F_s, "friction.F_k": F_s - k * gap}
        elif self.run.start > -math.inf:
            mu_s = w2 * motion.v * (q["t_break"] - self.run.start) + along / m
            figures["friction.mu_s"] = mu_s / (g + load / m)
            figures["friction.mu_k"] = (mu_s - w2 * gap) / (g + load / m)
        return figures

    def unknown(self) -> dict[str, str]:
        """Return numbers that the columns do not tell, and why."""
        unknown, why = dict[str, str](), "the speed of the spring's end is not in the record"
        if math.isnan(self.run.speed) and "x" not in self.noise:
            unknown = dict.fromkeys(_BY_SPEED, f"{why}: state one feed")
        if "F" not in self.noise and self.run.start == -math.inf:
            unknown = dict.fromkeys(COEFFICIENTS, LOAD_UP)
        drifts = dict.fromkeys(LEVELS, "the zero of the force drifts")
        return unknown | drifts if DRIFTS[0] in self.extras else unknown

    def creep(self, n: Floats) -> Floats:
        """Return what a creep between slips would change in the residuals."""
        after, period = self.cycles(n)
        t_slip = self.motion(n).t_slip
        within = after % period
        rise = (within - t_slip) / (period - t_slip) - 0.5
        way = np.where(within < t_slip, 0.5 - within / t_slip, rise) * (after >= 0.0)
        by = {"x": 1.0, "F": -self.by_name(n).get("k", 0.0)}
        return np.concatenate([way * by[name] / e for name, e in self.noise.items()])

    def cycles(self, n: Floats) -> tuple[Floats, float]:
        """Return the times since the first break-away, and the period [s].

        NaN where a slip would soon have no end.
        """
        motion = self.motion(n)
        damped = replace(motion, zeta=motion.zeta + _EDGE)
        period = motion.figures()["period"] if math.isfinite(damped.t_slip) else math.nan
        return self.run.t - self.by_name(n)["t_break"], period

    def segments(self, n: Floats) -> Iterator[tuple[float, float, str]]:
        """Yield parts of the run: begin and end [s], and what they are."""
        after, period = self.cycles(n)
        begin, t_slip = float(self.run.t[0] - after[0]), self.motion(n).t_slip
        for at in begin + period * np.arange(len(self.run.highs) * math.isfinite(period)):
            yield at, at + t_slip, "slips"
            yield at + t_slip, at + period, "rests"

    def parts(self, n: Floats, most: int) -> Iterator[Fitted[Block]]:
        """Yield fits of single cycles, at most so many."""
        run, motion = self.run, self.motion(n)
        turn = math.atan2(motion.v, motion.w * motion.D) / motion.w
        middles = [0.5 * (low + high) for low, high in zip(run.lows, run.highs[1:], strict=False)]
        edges = [float(run.t[0]), *middles, float(run.t[-1])]
        for begin, end in list(pairwise(edges))[:: -(-len(edges) // most)]:
            part = run.within(begin, end)
            if part.highs and part.lows and part.t.size > 10:
                speed = run.speed if "x" not in self.noise else motion.v
                some = replace(self, run=replace(part, speed=speed), extras=())
                yield weighed(fit(some, some.start(motion, part.highs[0] - turn)))


def noise_of(record: Record, run: Run) -> dict[str, float]:
    """Return about the noise of x and F in a run: their scatter, or their digits."""
    noise = {}
    for name, s in run.columns.items():
        half = record.rounding.get({"x": "position", "F": "force"}[name], 0.5 * digit_of(s))
        scatter = float(np.nan_to_num(scatter_of(run.t, s)))
        noise[name] = max(scatter, half / math.sqrt(3.0), _EXACT * float(np.ptp(s)))
    return noise


def fitted_block(record: Record, run: Run) -> Fitted[Block]:
    """Return the fit of a run, from the best of several starts, with its own noise."""
    run = run.from_rest()
    block = Block(run, noise_of(record, run))
    some = replace(block, run=run.at(slice(None, None, -(-run.t.size // _SOME))))
    starts = [some.start(motion, at) for motion, at in _starts(run)]
    nearest = sorted(starts, key=lambda n: _square(some, n))[:_BEST]
    found = [fit(some, n).value for n in nearest]
    return weighed(fit(block, min(found, key=lambda n: _square(some, n))))


def _square(block: Block, n: Floats) -> float:
    return sum(float(r @ r) for r in block.columns(n))


def _starts(run: Run) -> Iterator[tuple[Solution, float]]:
    """Yield solutions of about the period of a run, and a first break-away [s]."""
    period, v = run.period, run.speed
    if math.isnan(v):
        v = float(np.polyfit(run.t, run.columns["x"], 1)[0]) if "x" in run.columns else 1.0
    for lam, zeta in product(_RATIOS, _DAMPINGS):
        # The period without damping.
        w = 2.0 * (lam + math.pi - math.atan(lam)) / period
        s = Solution(w, zeta * min(0.2 * lam, 1.0), v, lam * v / w)
        begin = run.highs[0] - math.atan2(s.v, s.w * s.D) / s.w
        if math.isfinite(s.t_slip):
            yield from ((s, begin + shift * period) for shift in _SHIFTS)
