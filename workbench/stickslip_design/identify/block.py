"""The block on its spring over a run of a record, fitted by least squares.

The motion from break-away to break-away is the closed form of docs/theory.md (3) to (6). Of the
position it hangs on w, zeta, the gap of the spring, the feed and the first break-away alone; the
force adds the stiffness and the level at break-away.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Final

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import t as student

from stickslip_score import Solution, half_unit, scatter_of

from ..axis import Axis
from .cycles import Run
from .model import Floats, Record
from .noise import SURE, Estimate
from .noise import least_squares as linear

_STEP: Final = 1e-6
"""Of difference quotients. They change by 0.1 % from 1e-5 to 1e-7: what bends over a wider one
would tell a direction that the record does not."""
_LITTLE: Final = 4.0
"""Of the squares, for each number: what a search may have left."""
_UNKNOWN: Final = 3e6
"""Deviation of a number before the record, over one at which a change is as large as the noise."""
_EXACT: Final = 1e-7
"""Of the range of a column, what is no noise but a solver's tolerance."""
COLUMNS: Final = {"x": "position", "F": "force"}
"""Columns of a run, as a record names them."""
LEVELS, COEFFICIENTS = ("friction.F_s", "friction.F_k"), ("friction.mu_s", "friction.mu_k")
_LEAST_ZETA, _MOST_ZETA, _USUAL_ZETA = -0.3, 0.95, 0.5
_RATIOS, _DAMPINGS = (0.3, 0.6, 1.2, 2.0, 3.0, 4.5, 7.0, 11.0, 18.0, 30.0), (0.02, 0.15)
_SHIFTS: Final = (-0.1, -0.03, 0.0, 0.03, 0.1)
"""Where the search starts: w D/v, damping ratios, and break-aways in periods."""
_BEST, _SOME = 2, 700
"""Starts that are searched from, and samples with which that is done."""
LOAD_UP: Final = (
    "the position tells (F_s - F_k)/k; a load-up from a relaxed spring tells them apart"
)
_BY_SPEED: Final = ("gap", "axis.stiffness", "axis.mass", "axis.c")
_EDGE: Final = 1e-3
"""Of the damping ratio: how near to a slip without an end a fit tells nothing by its slopes."""
DRIFTS, CREEP = ("drift 1", "drift 2", "drift 3"), ("creep",)
"""Numbers that are fitted besides: of a zero of the force that drifts, parts of its range; of a
table that creeps between its slips, part of the gap."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Block:
    """The block on its spring over a run that begins in a rest."""

    run: Run
    noise: dict[str, float]
    """Standard deviations of x [m] and F [N], as far as there are."""
    extras: tuple[str, ...] = ()
    """Names of numbers that are fitted besides."""

    @property
    def names(self) -> list[str]:
        """The numbers but the levels: of w, D, k, v the logarithm; break-away in periods."""
        names = ["w", "zeta", "t_break", "D"]
        names += ["v"] * (math.isnan(self.run.speed) and "x" in self.noise)
        return names + ["k"] * ("F" in self.noise) + [*self.extras]

    @property
    def usual(self) -> tuple[float, ...]:
        """A damping ratio beyond its limits shows nothing: it comes back from there."""
        return tuple(_USUAL_ZETA if name == "zeta" else math.inf for name in self.names)

    def by_name(self, n: Floats) -> dict[str, float]:
        """Return the numbers by name."""
        q = dict(zip(self.names, n.tolist(), strict=False))
        # However far a step of the search goes.
        q |= {name: math.exp(min(max(q[name], -80.0), 80.0)) for name in "wDkv" if name in q}
        return q | {"t_break": float(self.run.t[0]) + q["t_break"] * self.run.period}

    def motion(self, n: Floats) -> Solution:
        """Return the motion of the block."""
        q, v = self.by_name(n), self.run.speed
        v = q.get("v", 1.0 if math.isnan(v) else v)
        return Solution(q["w"], min(max(q["zeta"], _LEAST_ZETA), _MOST_ZETA), v, q["D"])

    def seen(self, n: Floats) -> dict[str, Floats]:
        """Return x [m] and F [N] at the samples, but for their levels."""
        q, motion, t = self.by_name(n), self.motion(n), self.run.t
        after = t - q["t_break"]
        x = motion.position(after)
        if "creep" in q:
            period = motion.figures()["period"]
            saw = np.interp(after % period, [0.0, motion.t_slip, period], [0.5, -0.5, 0.5])
            x += q["creep"] * motion.D * np.nan_to_num(saw) * (after >= 0.0)
        F = q.get("k", 0.0) * (motion.v * after - x)
        if DRIFTS[0] in q:
            by = [0.0, *(q[name] * float(np.ptp(self.run.columns["F"])) for name in DRIFTS)]
            F += np.polynomial.legendre.legval(np.linspace(-1.0, 1.0, t.size), by)
        return {"x": x, "F": F}

    def columns(self, n: Floats) -> list[Floats]:
        """Return the residuals, each in units of its noise."""
        seen, levels = self.seen(n), n[-len(self.noise) :]
        return [
            (self.run.columns[name] - seen[name] - level) / e
            for (name, e), level in zip(self.noise.items(), levels, strict=True)
        ]

    def levelled(self, n: Floats) -> Floats:
        """Return numbers with the levels that leave least of the columns."""
        means = [np.mean(r) * e for r, e in zip(self.columns(n), self.noise.values(), strict=True)]
        return np.append(n[: -len(means)], n[-len(means) :] + means)

    @cached_property
    def known(self) -> Floats:
        """How far the numbers usually are from 0."""
        return np.append(self.usual, np.full(len(self.noise), math.inf))

    def derivatives(self, of: Callable[[Floats], Floats], n: Floats) -> Floats:
        """Return the derivatives of what follows from numbers, shape (values, p)."""
        steps = np.append(np.full(len(self.usual), _STEP), [*self.noise.values()])
        return np.stack([(of(n + by) - of(n - by)) / (2.0 * by.sum()) for by in np.diag(steps)], 1)

    def start(self, motion: Solution, begin: float) -> Floats:
        """Return the numbers of a motion that breaks away at a time, its levels at best."""
        run, F = self.run, self.run.columns.get("F")
        q = {"w": math.log(motion.w), "zeta": motion.zeta, "D": math.log(motion.D)}
        q |= {"v": math.log(motion.v), "t_break": (begin - float(run.t[0])) / run.period}
        if F is not None:
            after = run.t - begin
            k = float(np.polyfit(motion.v * after - motion.position(after), F, 1)[0])
            q["k"] = math.log(max(k, 1e-300))
        return self.levelled(np.array([q[name] for name in self.names] + [0.0] * len(self.noise)))

    def more(self, found: Fitted, extras: tuple[str, ...]) -> Fitted:
        """Return the fit with numbers besides, from one without."""
        size = len(self.names)
        n = np.insert(found.value, size, np.zeros(len(extras)))
        return weighed(fit(replace(self, extras=(*self.extras, *extras)), n))

    def figures(self, n: Floats, axis: Axis | None) -> dict[str, float]:
        """Return what the columns tell of the axis, by name."""
        q, motion = self.by_name(n), self.motion(n)
        w2, gap = motion.w**2, motion.D + 2.0 * motion.zeta * motion.v / motion.w
        g, load, m = (axis.g, axis.load, axis.m) if axis else (9.81, 0.0, 1.0)
        along = self.run.sign * axis.along if axis else 0.0
        F_s = float(n[-1]) + along if "k" in q else None
        figures = figures_of(w2, 2.0 * q["zeta"] * motion.w, gap, q.get("k"), F_s)
        if "k" not in q and self.run.start > -math.inf:
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

    def rhythm(self, n: Floats) -> tuple[float, float, float]:
        """Return the first break-away, the period, and the length of a slip [s].

        The period is NaN where a slip would soon have no end.
        """
        motion = self.motion(n)
        ends = math.isfinite(replace(motion, zeta=motion.zeta + _EDGE).t_slip)
        period = motion.figures()["period"] if ends else math.nan
        return self.by_name(n)["t_break"], period, motion.t_slip


@dataclass(frozen=True)
class Fitted:
    """Least squares at their minimum."""

    motion: Block
    value: Floats

    @cached_property
    def residual(self) -> list[Floats]:
        """Residuals at the minimum."""
        return self.motion.columns(self.value)

    @cached_property
    def estimate(self) -> Estimate:
        """Of a whole step of Gauss and Newton from here: what the search has left to go."""
        J = self.motion.derivatives(lambda n: np.concatenate(self.motion.columns(n)), self.value)
        lengths = np.maximum(np.sqrt(np.sum(J**2, axis=0)), 1e-100)
        known = np.minimum(self.motion.known, _UNKNOWN / lengths)
        names = [str(i) for i in range(self.value.size)]
        return linear(
            dict(zip(names, -J.T, strict=True)),
            np.concatenate(self.residual),
            np.repeat(np.arange(len(self.residual)), [r.size for r in self.residual]),
            known=dict(zip(names, known.tolist(), strict=True)),
        )

    @property
    def covariance(self) -> Floats:
        """Covariance of the numbers, shape (p, p): of noise, and of a search that has not ended."""
        estimate = self.estimate
        return estimate.covariance + np.outer(estimate.value, estimate.value)

    @property
    def ended(self) -> bool:
        """Whether what the search has left to go is within the noise."""
        fitted = self.estimate.fitted
        return float(fitted @ fitted) < _LITTLE * self.value.size

    @property
    def unlikelihood(self) -> float:
        """Minus twice the logarithm of the likelihood, for each sample: runs differ by some."""
        sizes = zip(self.residual, self.motion.noise.values(), strict=True)
        return sum(math.log(float(np.mean(r * r)) * e**2) for r, e in sizes)

    def figures(self, axis: Axis | None) -> dict[str, tuple[float, float]]:
        """Return what the fit tells of the axis, by name: value, and standard deviation."""
        motion, n = self.motion, self.value
        slopes = motion.derivatives(lambda n: np.array([*motion.figures(n, axis).values()]), n)
        spread = np.sqrt(np.einsum("ij,jk,ik->i", slopes, self.covariance, slopes).clip(1e-300))
        pairs = zip(motion.figures(n, axis).items(), spread.tolist(), strict=True)
        return {name: (value, deviation) for (name, value), deviation in pairs}

    def ends(self, value: float, deviation: float) -> tuple[float, float]:
        """Return the interval of 95 % of a value with a standard deviation."""
        half = float(student.ppf(0.5 + 0.5 * SURE, self.estimate.freedom)) * deviation
        if half >= value:
            return value - half, value + half
        # Numbers scale a motion: they are known to a part of them.
        return value * math.exp(-half / value), value * math.exp(half / value)


def noise_of(record: Record, run: Run) -> dict[str, float]:
    """Return about the noise of x and F in a run: their scatter, or their digits."""
    noise = {}
    for name, s in run.columns.items():
        half = record.rounding.get(COLUMNS[name], half_unit(s))
        scatter = float(np.nan_to_num(scatter_of(run.t, s)))
        noise[name] = max(scatter, half / math.sqrt(3.0), _EXACT * float(np.ptp(s)))
    return noise


def fit(motion: Block, start: Floats, most: int = 80, gain: float = 1e-9) -> Fitted:
    """Return the least squares that are reached from a start, shape (p,), in so many trials.

    `gain` is what a step gains at the end, of the squares and the numbers.
    """

    def residual(n: Floats) -> Floats:
        return np.concatenate([*motion.columns(n), n / motion.known])

    best = least_squares(
        residual,
        start,
        lambda n: motion.derivatives(residual, n),
        method="lm",
        x_scale="jac",
        ftol=gain,
        xtol=gain,
        gtol=gain,
        max_nfev=most,
    )
    return Fitted(motion, np.asarray(best.x))


def weighed(found: Fitted, most: int = 80, gain: float = 1e-9) -> Fitted:
    """Return the fit with the noise that a residual shows, from there."""
    pairs = zip(found.motion.noise.items(), found.residual, strict=True)
    noise = {name: e * max(float(np.sqrt(np.mean(r * r))), 1e-3) for (name, e), r in pairs}
    return fit(replace(found.motion, noise=noise), found.value, most, gain)


def figures_of(
    w2: float, c_m: float, gap: float, k: float | None, F_s: float | None
) -> dict[str, float]:
    """Return figures of an axis from k/m, c/m, gap; with k [N/m] masses and forces, too."""
    figures = {"k/m": w2, "c/m": c_m, "gap": gap}
    if k is not None:
        figures |= {"axis.stiffness": k, "axis.mass": k / w2, "axis.c": c_m * k / w2}
        figures["F_s - F_k"] = k * gap
        if F_s is not None:
            figures |= {"friction.F_s": F_s, "friction.F_k": F_s - k * gap}
    return figures


def fitted_block(record: Record, run: Run) -> Fitted:
    """Return the fit of a run, from the best of several starts, with its own noise."""
    if run.start == -math.inf and len(run.lows) > 1 and len(run.highs) > 2:
        # From a rest on: without a load-up the first one between two slips.
        run = run.within(0.5 * (run.lows[0] + run.highs[1]), math.inf)
    block = Block(run=run, noise=noise_of(record, run))
    some = replace(block, run=run.at(slice(None, None, -(-run.t.size // _SOME))))
    starts = [Fitted(some, some.start(motion, at)) for motion, at in _starts(run)]
    nearest = sorted(starts, key=lambda one: one.unlikelihood)[:_BEST]
    found = [fit(some, one.value) for one in nearest]
    return weighed(fit(block, min(found, key=lambda one: one.unlikelihood).value))


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
