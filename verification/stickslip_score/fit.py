"""Whether a curve lies on the exact solution or on that of another block, and how surely."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import correlate

from .figures import (
    EPSILON,
    QUANTITIES,
    Figures,
    Motion,
    Phases,
    Solution,
    break_away,
    rests_of,
    root,
    scatter_of,
    without_drift,
)
from .read import LEAST_SAMPLES, Floats

_EXCESS = 1.25  # on a solution: the digits once, and what the least squares share out of them
_ROUNDED, _FLIPS = 1.0, 4.0
"""Of what the digits allow: the rms distance of samples that are rounded to counts, 1/sqrt(3) and
a little noise, and the largest one that this noise makes where it turns a count over."""
_WHITE, _WHITE_OF_FEW = 1.1, 3.0
"""A residual is noise where its rms is at most 1.1 times its scatter from sample to sample, and
3/sqrt(n) more for n samples, of which the scatter is known to 1/sqrt(n) about."""
_ENOUGH_TO_START, _ENOUGH, _MOST = 1000, 3000, 10_000  # samples of start, search and result
_CORRELATED = 8192  # neighbouring samples of a residual that show its correlation
_FEW, _FROM_EACH = 150, 16  # samples up to which the search starts anew from so many places
_SEEDS, _MOST_SEEDS = 41, 4000
_WIDE, _FINE = 0.6, 0.02
"""Radians of the oscillation between two places to search from: within it the search finds its way
by itself; and where a single sample at the edge of a slip may be all there is."""
_PARTS, _LEAST_CYCLES, _SHAPE = 8, 3, 4.0
"""Parts of a cycle in which distances are averaged, cycles that tell whether they repeat, and how
much larger than by chance the variance of their mean over the cycles is where they do. By chance
it is 4 times as large in one of 10,000 records."""
_WANDERS = 5.0  # deviations of their power that means over parts of cycles may exceed noise's by
_LEAST_ZETA, _MOST_ZETA = -0.5, 0.9  # damping ratios that are tried; solvers may put energy in
_NOTHING = 1e-100  # length of a derivative that is none
_COARSE = 0.2  # of a period between samples: a break-away may precede the first turn they show
_DRIFTS, _DRIFTS_IN_A_CYCLE = 8, 1.5
"""Degree of the polynomial that a sensor's zero may follow over a record, as it warms up, and the
most that a cycle may have of it, so that it is no motion."""
_DEVIATIONS = 3.0  # standard deviations to which a number that noise hides is known
_LITTLE = 0.1  # of the distance from a solution: what another explanation may leave of it
_FLOOR = 1e-12  # of a figure: digits of the double-precision arithmetic of the fit itself


@dataclass(frozen=True)
class Fit:
    """The solution that comes nearest to a curve, with the free numbers at their best."""

    part: Part  # the samples
    solution: Solution
    t_break: float  # first break-away [s]
    offset: float  # position of the mass before it [m]
    worst: float  # largest distance of a sample from the solution [m]
    rms: float  # root mean square of the distances [m]
    white: bool  # whether the distances are noise, each sample's independent of the next one's
    repeats: bool  # whether the distances have a shape that comes again in each cycle
    spread: dict[str, float]  # how far t_break and each free number may be off for the digits
    covariance: Floats  # of the free numbers, in this order, from the distances of the samples

    @property
    def by_digits(self) -> bool:
        """Whether all samples lie on the solution, to their digits."""
        is_rounded = self.rms <= _ROUNDED * self.part.digits
        return self.worst <= (_FLIPS if is_rounded else _EXCESS) * self.part.digits

    @property
    def lies(self) -> bool:
        """Whether all samples lie on the solution, to their digits or their noise."""
        return self.by_digits or (self.part.noisy and self.white)

    @property
    def criterion(self) -> float:
        """Schwarz's information criterion, with the digits of the samples as noise."""
        power, count = math.log(self.rms**2 + self.part.digits**2), self.part.t.size
        return count * power + len(self.spread) * math.log(count)

    def deviation(self, name: str) -> float:
        """Return the standard deviation of a free number, in its unit."""
        at = list(self.spread).index(name)
        return math.sqrt(max(float(self.covariance[at, at]), 0.0))

    def figures(self, end: float) -> Figures:
        """Return the figures of the solution, of cycles and slips that are over at `end` [s].

        The resolution carries twice the digits of the samples, which the fit may share out, and
        `_DEVIATIONS` standard deviations of the free numbers.
        """
        values = self.solution.figures()
        if math.isnan(values["period"]):
            return Figures({}, 0)
        since = end - self.t_break
        cycles = max(0, math.floor(since / values["period"] * (1.0 + 1e-12)))
        shown = ["period", "t_stick"] if cycles else []
        shown += ["t_slip", "delta_x"] if since >= values["t_slip"] else []
        _, *free = self.spread
        by_digits = [self._reach({name: 2.0 * self.spread[name]}) for name in free]
        by_noise = []
        if self.part.noisy:
            # Moves of D, w, zeta that noise makes independently of each other.
            sizes, axes = np.linalg.eigh(self.covariance[1:, 1:])
            moves = (axes * (_DEVIATIONS * np.sqrt(np.maximum(sizes, 0.0)))).T.tolist()
            by_noise = [self._reach(dict(zip(free, move, strict=True))) for move in moves]
        resolved = {}
        for name in shown:
            resolution = sum(reach[name] for reach in by_digits)
            resolution += math.hypot(*(reach[name] for reach in by_noise))
            resolution += _FLOOR * values["period" if name != "delta_x" else "delta_x"]
            resolved[name] = values[name], resolution
        return Figures(resolved, cycles)

    def _reach(self, move: Mapping[str, float]) -> dict[str, float]:
        """Return how far a move either way shifts the figures; NaN where no cycle is left."""
        middle, reach = self.solution.figures(), dict.fromkeys(QUANTITIES, math.nan)
        for sign in (-1.0, 1.0):
            numbers = {name: getattr(self.solution, name) + sign * by for name, by in move.items()}
            numbers["D"] = max(numbers.get("D", self.solution.D), 0.0)
            moved = replace(self.solution, **numbers)
            shown = moved.figures() if moved.w > 0.0 else {}
            reach |= {n: float(np.fmax(reach[n], abs(shown[n] - middle[n]))) for n in shown}
        return reach


@dataclass(frozen=True)
class Part:
    """Samples from about a first break-away on, or of a motion that goes on for ever."""

    t: Floats  # [s]
    y: Floats  # position [m]
    digits: float  # how far a position may be off for its digits [m]
    noisy: bool  # whether they have noise besides
    solution: Solution  # where the search starts
    window: tuple[float, float]  # times between which the first break-away is [s]
    coarse: bool = False  # whether a mass and a gap together would explain anything
    drifts: int = 0  # degree of a polynomial in time that counts as no motion, 0 for a constant

    def nearest(self, solutions: Iterable[Solution], *free: str) -> Fit:
        """Return the nearest of fits that start from several solutions."""
        fits = [replace(self, solution=solution).fit(*free) for solution in solutions]
        return min(fits, key=lambda fit: fit.rms)

    def fit(self, *free: str, starts: Iterable[float] = ()) -> Fit:
        """Fit break-away, offset and the numbers in `free` of D, w, zeta by least squares.

        The search starts from the break-aways `starts` [s], by default promising ones.
        """
        some, more = self._thinned(_ENOUGH), self._thinned(_MOST)
        least = math.inf
        for begin in starts or self._starts():
            free_numbers = {name: float(getattr(self.solution, name)) for name in free}
            numbers = some._least_squares({"t_break": begin, **free_numbers})
            r = some._residual(numbers)
            if (cost := float(r @ r)) < least:
                least, best = cost, numbers
            if _half_range(r) <= _EXCESS * self.digits:
                break
        if more.t.size > some.t.size:
            best = more._least_squares(best)
        fit = more._account(best)
        if more.t.size == self.t.size or not fit.by_digits:
            return fit
        # So many samples tell noise; that all lie on the solution, only all of them do.
        return replace(fit, part=self, worst=_half_range(self._residual(best)))

    def _thinned(self, most: int) -> Part:
        stride = -(-self.t.size // most)
        return replace(self, t=self.t[::stride], y=self.y[::stride])

    def _starts(self) -> list[float]:
        """Return the break-aways from which to search, the most promising first.

        With few samples the search does not find its way from one in a slip to another.
        """
        some = self._thinned(_ENOUGH_TO_START)
        few = some.t.size <= _FEW
        radians = (self.window[1] - self.window[0]) * self.solution.w
        places = max(_SEEDS, math.ceil(radians / (_FINE if few else _WIDE)))
        candidates = np.linspace(*self.window, min(places, _MOST_SEEDS))
        cost = np.array([np.sum(some._residual({"t_break": at}) ** 2) for at in candidates])
        walled = np.concatenate([[np.inf], cost, [np.inf]])
        valleys = np.flatnonzero((cost < walled[:-2]) & (cost <= walled[2:]))
        best = valleys[np.argsort(cost[valleys], kind="stable")]
        return [float(at) for at in candidates[best[: _FROM_EACH if few else 1]]]

    def _residual(self, numbers: Mapping[str, float]) -> Floats:
        solution = _with(self.solution, numbers)
        r = self.y - solution.position(self.t - numbers["t_break"])
        return without_drift(self.t, r, self.drifts)

    def _steps(self, numbers: Iterable[str]) -> Floats:
        """Return steps of free numbers: a millionth of what changes the motion."""
        w, D = self.solution.w, abs(self.solution.D) + self.solution.v / self.solution.w
        sizes = {"t_break": 1.0 / w, "D": D, "w": 0.1 * w, "zeta": 0.1}
        return np.array([1e-6 * sizes[name] for name in numbers])

    def _jacobian(self, numbers: Mapping[str, float]) -> Floats:
        """Return the residual's derivatives, shape (n, number of free numbers)."""
        columns = []
        after = self.t - numbers["t_break"]
        for name, step in zip(numbers, self._steps(numbers), strict=True):
            low = _with(self.solution, {**numbers, name: numbers[name] - step})
            high = _with(self.solution, {**numbers, name: numbers[name] + step})
            late = step if name == "t_break" else 0.0
            # A step beyond what is allowed stops there.
            moved = 2.0 * late or getattr(high, name) - getattr(low, name)
            change = low.position(after + late) - high.position(after - late)
            columns.append(change / (moved or math.inf))
        return without_drift(self.t, np.stack(columns, axis=1), self.drifts)

    def _least_squares(self, numbers: dict[str, float]) -> dict[str, float]:
        scales, origin = 1e6 * self._steps(numbers), np.array(list(numbers.values()))

        def moved(moves: Floats) -> dict[str, float]:
            return dict(zip(numbers, (origin + scales * moves).tolist(), strict=True))

        size = float(np.ptp(self.y)) or 1.0
        result = least_squares(
            lambda moves: self._residual(moved(moves)) / size,
            np.zeros(len(numbers)),
            lambda moves: self._jacobian(moved(moves)) * scales / size,
            method="lm",
            x_scale=1.0,
            ftol=1e-10,
            xtol=1e-14,
            gtol=4.0 * EPSILON,
            max_nfev=60,
        )
        best = moved(result.x)
        allowed = _with(self.solution, best)
        return {n: best[n] if n == "t_break" else getattr(allowed, n) for n in best}

    def _account(self, numbers: dict[str, float]) -> Fit:
        r, J = self._residual(numbers), self._jacobian(numbers)
        best, after = _with(self.solution, numbers), self.t - numbers["t_break"]
        # Least squares is linear in the samples: each moves the result by its row of the inverse.
        scale = np.maximum(np.sqrt(np.sum(J * J, axis=0)), _NOTHING)
        normal = np.linalg.pinv((J / scale).T @ (J / scale), hermitian=True)
        reach = np.sum(np.abs((J / scale) @ normal), axis=0) * self.digits / scale
        # Samples that all rest say of a break-away only between which two it is.
        step = float(np.max(np.diff(self.t)))
        if float(np.max(np.abs(J[:, 0]))) * step < self.digits:
            reach[0] = step
        rms = math.sqrt(float(r @ r) / max(r.size - len(numbers) - 1 - self.drifts, 1))
        repeats, wanders = by_cycle(self.t, r, after, best.figures()["period"])
        return Fit(
            part=self,
            solution=best,
            t_break=numbers["t_break"],
            offset=float(np.mean(self.y - best.position(after))),
            worst=_half_range(r),
            rms=rms,
            white=_is_white(self.t, r) and not wanders,
            repeats=repeats,
            spread=dict(zip(numbers, reach.tolist(), strict=True)),
            covariance=rms**2 * _correlation(r) * normal / np.outer(scale, scale),
        )


def _with(solution: Solution, numbers: Mapping[str, float]) -> Solution:
    """Return the solution with other numbers: D, w, zeta, as far as they are allowed."""
    w = min(max(numbers.get("w", solution.w), 0.2 * solution.w), 5.0 * solution.w)
    zeta = numbers.get("zeta", solution.zeta)
    zeta = min(max(zeta, _LEAST_ZETA), max(solution.zeta, _MOST_ZETA))
    D = solution.D + 2.0 * (solution.zeta - zeta) * solution.v / solution.w
    # Static friction is not the smaller one; a slip from mu_s = mu_k begins at minus the drag.
    least = -2.0 * zeta * solution.v / solution.w * (1.0 + 1e-12)
    return replace(solution, D=max(numbers.get("D", D), least), w=w, zeta=zeta)


def _half_range(r: Floats) -> float:
    return 0.5 * float(np.ptp(r))


def _is_white(t: Floats, r: Floats) -> bool:
    """Tell whether distances are noise, each sample's independent of the next one's."""
    rms = math.sqrt(float(np.mean(r * r)))
    return rms <= _WHITE * (1.0 + _WHITE_OF_FEW / math.sqrt(r.size)) * scatter_of(t, r)


def by_cycle(t: Floats, r: Floats, after: Floats, period: float) -> tuple[bool, bool]:
    """Tell whether distances repeat from cycle to cycle, and wander by more than their scatter.

    `after` are times since the first break-away [s]. Means over parts of each cycle scatter about
    their mean over all cycles, and that one by less, unless it is a shape.
    """
    number = np.floor(after / period)
    seen = number >= 0.0
    if not number[-1] >= _LEAST_CYCLES:
        return True, False
    part = np.floor((after - number * period)[seen] / period * _PARTS).astype(np.int64) % _PARTS
    index = number[seen].astype(np.int64) * _PARTS + part
    shape = (int(number[-1]) + 1) * _PARTS
    counts = np.bincount(index, minlength=shape).reshape(-1, _PARTS)
    means = np.bincount(index, r[seen], shape).reshape(-1, _PARTS) / np.maximum(counts, 1)
    filled, times = np.count_nonzero(counts), np.maximum(np.count_nonzero(counts, axis=0), 1)
    common = np.sum(means, axis=0) / times
    scatter = np.sum((means - common)[counts > 0] ** 2) / max(filled - _PARTS, 1)
    power, most = np.sum(counts * means**2), filled + _WANDERS * math.sqrt(2.0 * filled)
    repeats = np.mean(times * common**2) > _SHAPE * scatter
    return bool(repeats), bool(power > most * scatter_of(t, r) ** 2)


def _correlation(r: Floats) -> float:
    """Return by how much the variance of a mean exceeds that of independent samples, >= 1."""
    some = r[:_CORRELATED]
    power = float(some @ some)
    if power == 0.0:
        return 1.0
    lags = correlate(some, some, method="fft")[some.size :] / power
    # Beyond two deviations of the correlation of independent samples it is no more than chance.
    small = lags < 2.0 / math.sqrt(some.size)
    return 1.0 + 2.0 * float(np.sum(lags[: int(np.argmax(small)) if small.any() else None]))


@dataclass(frozen=True)
class Slide:
    """The arc of sliding without end that comes nearest to a curve."""

    z_steady: float  # spring extension to which it tends [m], up to a constant as the motion's
    spread: float  # how far that may be off for digits and noise [m]
    lies: bool  # whether all samples lie on the arc, to their digits or their noise
    worst: float  # largest distance of a sample from it [m]


def fit_slide(motion: Motion, solution: Solution) -> Slide | None:
    """Fit an arc of sliding to all samples; None where that arc is none of the block's.

    The arc is linear in its steady extension and in the extension and its rate at the first sample,
    docs/theory.md (3). It goes forward, and from rest begins at break-away or farther.
    """
    after = motion.t - motion.t[0]
    by_extension, by_rate = solution.response(after)
    z = motion.z - motion.z[0]
    basis = np.stack([np.ones_like(after), by_extension - 1.0, by_rate], axis=1)
    scale = np.max(np.abs(basis), axis=0)
    inverse = np.linalg.pinv(basis / scale) / scale[:, None]
    level, extension, rate = (float(number) for number in inverse @ z)
    noise = _DEVIATIONS * motion.noise * np.sqrt(np.sum(inverse**2, axis=1))
    reach = np.sum(np.abs(inverse), axis=1) * motion.digits + noise
    backward = rate > solution.v + float(reach[2])
    from_rest = abs(rate - solution.v) <= float(reach[2])
    if backward or (from_rest and extension < solution.D - float(reach[1])):
        return None
    r = z - basis @ np.array([level, extension, rate])
    worst = _half_range(r)
    return Slide(
        z_steady=float(motion.z[0]) + level - extension,
        spread=float(reach[0]) + float(reach[1]),
        lies=worst <= _EXCESS * motion.digits or (motion.noise > 0.0 and _is_white(motion.t, r)),
        worst=worst,
    )


Fits = Mapping[str, Fit]  # by what is free: gap, gap and mass, damping, ... or exact


def explained_by_drift(fits: Fits) -> bool:
    """Tell whether a slow drift takes away nearly all distance from the exact solution."""
    return "drift" in fits and fits["drift"].rms < _LITTLE * fits["exact"].rms


def fits_of(motion: Motion, phases: Phases, solution: Solution) -> dict[str, Fit]:
    """Fit the exact solution, one coefficient, a free gap, gap and mass, damping.

    A curve on the exact solution is fitted by the free gap besides; one that lies on a solution
    with another gap by no other mass. Where no cycle exists, the rests of the mass tell the
    break-away.
    """
    if math.isinf(solution.t_slip):
        return _fits_without_cycle(motion, solution)
    if phases.only_rests:
        return {}
    tried = []
    for parts in _alternatives(motion, phases, solution):
        pairs = [(part.fit(), part) for part in parts]
        tried += pairs
        # Noise hides a slip too many at either end, so that the nearer one is right.
        exact, part = min(pairs, key=lambda pair: pair[0].rms)
        if exact.lies:
            fits = {"exact": exact, "gap": (gap := part.fit("D", starts=[exact.t_break]))}
            if motion.noise and abs(gap.solution.D - solution.D) > _DEVIATIONS * gap.deviation("D"):
                fits["damping"] = part.fit("zeta", starts=[exact.t_break])
            return fits
    if motion.noise:
        exact, part = min(tried, key=lambda pair: pair[0].rms)
        solution = part.solution
    else:
        cut = _parts(motion, phases, solution)
        if not cut:
            return {}
        starts_at_rest = bool(phases.sticks) and phases.sticks[0].begin is None
        part = cut[0 if starts_at_rest else -1]
        exact = part.fit()
    fits = {"exact": exact, "one coefficient": part.nearest([solution.without_gap()])}
    times, v, w = phases.high_times, solution.v, solution.w
    period = float(times[-1] - times[0]) / (times.size - 1) if times.size > 1 else 0.0

    def seeds(**ranges: tuple[float, float]) -> list[Solution]:
        names = ranges if period else []
        others = [solved(solution, "period", period, name, *ranges[name]) for name in names]
        return [solution, *others]

    gaps = 1e-3 * v / w, 0.5 * v * period
    fits["gap"] = part.nearest(seeds(D=gaps), "D")
    other = not (fits["gap"].lies or part.coarse)
    if motion.noise or other:
        fits["damping"] = part.nearest(seeds(zeta=(-0.3, 0.9)), "zeta")
    if other:
        fits["gap and mass"] = part.nearest(seeds(D=gaps, w=(0.5 * w, 2.0 * w)), "D", "w")
    if motion.noises.keys() == {"F"} and not any(fit.lies for fit in fits.values()):
        # The zero of the sensor may drift.
        cycles = float(part.t[-1] - part.t[0]) / solution.figures()["period"]
        drifts = max(1, min(_DRIFTS, math.floor(_DRIFTS_IN_A_CYCLE * cycles)))
        part = replace(part, drifts=drifts)
        drift = part.nearest([replace(solution, continued=way) for way in (False, True)])
        part = replace(part, solution=drift.solution)
        fits |= {"drift": drift, "gap and drift": part.fit("D", starts=[drift.t_break])}
    return fits


def _alternatives(motion: Motion, phases: Phases, solution: Solution) -> Iterator[list[Part]]:
    """Yield parts of the curve and the solution that may begin there, the likeliest first."""
    before = replace(solution, continued=True)
    period = solution.figures()["period"]
    begin, end = float(motion.t[0]), float(motion.t[-1])
    first_turn = float(phases.high_times[0]) if phases.high_times.size else end
    whole = [
        _part(motion, before, 0, (begin - period, begin)),
        _part(motion, solution, 0, (begin, min(first_turn + period, end))),
    ]
    cut = [[part] for way in (solution, before) for part in _parts(motion, phases, way)]
    # Noise may show turns where the spring has none.
    yield from [whole, *cut] if motion.noise else [*cut, whole]


def _part(motion: Motion, solution: Solution, first: int, window: tuple[float, float]) -> Part:
    t, y, noisy = motion.t[first:], motion.y[first:], motion.noise > 0.0
    return Part(t, y, motion.digits, noisy, solution, window)


def _fits_without_cycle(motion: Motion, solution: Solution) -> dict[str, Fit]:
    fits: dict[str, Fit] = {}
    for first, last in rests_of(motion):
        parts = [
            _part(motion, way, first, window)
            for way in (solution, solution.without_gap())
            if (window := break_away(motion, way, last))
        ]
        if not parts or motion.t.size - first < LEAST_SAMPLES:
            continue
        exact = parts[0].fit()
        if exact.lies:
            # Noise may hide another gap.
            gaps = {"gap": parts[0].fit("D", starts=[exact.t_break])} if motion.noise else {}
            return {"exact": exact, **gaps}
        gap = min((part.fit("D") for part in parts), key=lambda fit: fit.rms)
        new = {"exact": exact, "one coefficient": parts[1].fit(), "gap": gap}
        fits |= {n: fit for n, fit in new.items() if n not in fits or fit.rms < fits[n].rms}
    return fits


def _parts(motion: Motion, phases: Phases, solution: Solution) -> list[Part]:
    """Return the samples from the break-away before each of the first two turns on."""
    parts = []
    period = solution.figures()["period"]
    coarse = float(np.median(np.diff(motion.t))) > _COARSE * period
    for index in range(min(phases.highs.size, 2)):
        high = int(np.searchsorted(motion.t, phases.high_times[index]))
        if high == 0:
            continue
        arc = 1.5 * math.atan2(solution.v, solution.w * solution.D) / solution.w
        begin = float(motion.t[high - 1]) - arc - 2.0 * motion.blur - period * coarse
        before = (stick for stick in phases.sticks if stick.z_high == phases.highs[index])
        rested = [stick.begin.high for stick in before if stick.rests and stick.begin]
        first = int(np.searchsorted(motion.t, max([begin, *rested[:1]])))
        if motion.t.size - first < LEAST_SAMPLES:
            continue
        window = (begin, float(motion.t[min(high + 1, motion.t.size - 1)]) + motion.blur)
        parts.append(replace(_part(motion, solution, first, window), coarse=coarse))
    return parts


def solved(
    solution: Solution, quantity: str, value: float, name: str, low: float, high: float
) -> Solution:
    """Return the solution whose number `name`, between two, gives a quantity of the cycle."""

    def larger(number: float) -> float:
        shown = _with(solution, {name: number}).figures()[quantity]
        return -value if math.isnan(shown) else shown - value

    return _with(solution, {name: root(larger, low, high)})
