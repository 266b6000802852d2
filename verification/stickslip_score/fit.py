"""Whether a curve lies on the law of the block, with which gap, and how surely."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import correlate

from stickslip_score.law import EPSILON, Law
from stickslip_score.noise import scatter_of
from stickslip_score.read import Floats

ON_THE_LAW = 1.25
"""Excess up to which a curve lies on the law: its digits once, and once more because the least
squares share them out."""

_ROUNDED, _FLIPS = 1.0, 4.0
"""Of what the digits allow: the rms distance of samples that are rounded to counts, 1/sqrt(3) and
a little noise, and the largest one that this noise makes where it turns a count over."""

_WHITE, _WHITE_OF_FEW = 1.1, 3.0
"""A residual is noise where its rms is at most 1.1 times its scatter from sample to sample, and
3/sqrt(n) more for n samples, of which the scatter is known to 1/sqrt(n) about."""

_ENOUGH_TO_START, _ENOUGH, _MOST = 1000, 3000, 10_000
"""Samples that the search for a start looks at, that the search looks at, and from which the result
is computed; it is checked on all of them."""

_CORRELATED = 8192
"""Neighbouring samples of a residual whose correlation is looked at."""

_FEW = 150
_FROM_EACH = 16
"""Samples up to which the search starts anew from so many places."""

_SEEDS = 41
_MOST_SEEDS = 4000
_WIDE = 0.6
"""Radians of the oscillation between two places to search from: within it the search finds its way
by itself, as long as some samples are in slips."""
_FINE = 0.02
"""The same where a single sample at the very beginning or end of a slip may be all there is."""


_PARTS, _LEAST_CYCLES, _SHAPE = 8, 3, 4.0
"""Parts of a cycle in which distances are averaged, cycles that tell whether they repeat, and how
much larger than by chance the variance of their mean over the cycles is where they do. By chance
it is 4 times as large in one of 10,000 records."""

_WANDERS = 5.0
"""Standard deviations of their power that means over parts of cycles may exceed that of noise."""

_LEAST_ZETA, _MOST_ZETA = -0.5, 0.9
"""Damping ratios that are tried; solvers may put energy in."""

_NOTHING = 1e-100
"""Length of a derivative that is none."""


@dataclass(frozen=True)
class Fit:
    """The law that comes nearest to a curve.

    Attributes
    ----------
    law
        With the free numbers as found.
    t_break
        First break-away [s].
    offset
        Position of the mass before it [m].
    excess
        Largest distance of a sample from the law, in units of what its digits allow: up to 1 the
        curve lies on the law.
    worst, rms
        Largest and root mean square distance of a sample from the law [m].
    white
        Whether the distances are noise, each sample's independent of the next one's.
    repeats
        Whether the distances have a shape that comes again in each cycle.
    samples
        How many there are.
    spread
        How far each free number may be off for the digits of the samples, by name: t_break [s],
        D [m], w [rad/s], zeta [-].
    covariance
        Of the free numbers, in the order of `spread`, from the distances of the samples.
    """

    law: Law
    t_break: float
    offset: float
    excess: float
    worst: float
    rms: float
    white: bool
    repeats: bool
    samples: int
    spread: dict[str, float]
    covariance: Floats

    @property
    def by_digits(self) -> bool:
        """Whether all samples lie on the law, to their digits."""
        rounded = self.rms / _ROUNDED <= self.worst / self.excess if self.excess else True
        return self.excess <= ON_THE_LAW or (rounded and self.excess <= _FLIPS)

    def criterion(self, digits: float) -> float:
        """Return Schwarz's information criterion, with the digits of the samples [m] as noise."""
        power = math.log(self.rms**2 + digits**2)
        return self.samples * power + len(self.spread) * math.log(self.samples)

    def deviation(self, name: str) -> float:
        """Return the standard deviation of a free number, in its unit."""
        at = list(self.spread).index(name)
        return math.sqrt(max(float(self.covariance[at, at]), 0.0))


@dataclass(frozen=True)
class Samples:
    """What a law is fitted to: times [s], positions [m], how far one may be off for its digits [m].

    `drifts` is the degree of a polynomial in time that counts as no motion, 0 for a constant.
    """

    t: Floats
    y: Floats
    allowed: float
    drifts: int = 0

    def thinned(self, most: int) -> "Samples":
        """Return at most so many of the samples, evenly."""
        stride = -(-self.t.size // most)
        return replace(self, t=self.t[::stride], y=self.y[::stride])

    def centred(self, r: Floats) -> Floats:
        """Return distances, shape (n,) or (n, m), without what is a constant or drift in them."""
        if not self.drifts:
            return np.asarray(r - np.mean(r, axis=0))
        at = 2.0 * (self.t - self.t[0]) / (self.t[-1] - self.t[0]) - 1.0
        basis, _ = np.linalg.qr(np.polynomial.legendre.legvander(at, self.drifts))
        return np.asarray(r - basis @ (basis.T @ r))


def fit(
    samples: Samples,
    law: Law,
    starts: Iterable[float],
    free: Sequence[str] = (),
) -> Fit:
    """Fit break-away, offset and the numbers of `law` named in `free` by least squares.

    Parameters
    ----------
    samples
        From about the first break-away on, or of a motion that goes on for ever.
    law
        Where the search starts.
    starts
        First break-aways from which to search [s], at least one.
    free
        Of D, w, zeta. Where D is not free, zeta moves it: the drag of the way is part of it.
    """
    some = samples.thinned(_ENOUGH)
    least = math.inf
    for begin in starts:
        numbers = {"t_break": begin, **{name: float(getattr(law, name)) for name in free}}
        numbers = _least_squares(some, law, numbers)
        r = _residual(some, law, numbers)
        if (cost := float(r @ r)) < least:
            least, best = cost, numbers
        if _half_range(r) <= ON_THE_LAW * samples.allowed:
            break
    more = samples.thinned(_MOST)
    if more.t.size > some.t.size:
        best = _least_squares(more, law, best)
    found = _account(more, law, best)
    # So many samples tell noise; that all lie on the law, only all of them do.
    some_only = more.t.size < samples.t.size
    return _checked(samples, law, best, found) if some_only and found.by_digits else found


def starts_in(
    samples: Samples, law: Law, window: tuple[float, float], most: int | None = None
) -> list[float]:
    """Return the break-aways within a window [s] from which to search, the most promising first.

    Few samples that mostly rest tell a break-away by those in a slip alone, and the search does
    not find its way from one of them to another.
    """
    some = samples.thinned(_ENOUGH_TO_START)
    fine = most is None and some.t.size <= _FEW
    count = max(_SEEDS, math.ceil((window[1] - window[0]) * law.w / (_FINE if fine else _WIDE)))
    candidates = np.linspace(*window, min(count, _MOST_SEEDS))
    cost = np.array(
        [np.sum(_residual(some, law, {"t_break": float(begin)}) ** 2) for begin in candidates]
    )
    beside = np.concatenate([[np.inf], cost, [np.inf]])
    valleys = np.flatnonzero((cost < beside[:-2]) & (cost <= beside[2:]))
    best = valleys[np.argsort(cost[valleys], kind="stable")]
    kept = most or (_FROM_EACH if some.t.size <= _FEW else 1)
    return [float(begin) for begin in candidates[best[:kept]]]


def applied(law: Law, numbers: Mapping[str, float]) -> Law:
    """Return the law with other numbers: D, w, zeta, as far as they are given and allowed."""
    w = min(max(numbers.get("w", law.w), 0.2 * law.w), 5.0 * law.w)
    zeta = min(max(numbers.get("zeta", law.zeta), _LEAST_ZETA), max(law.zeta, _MOST_ZETA))
    D = numbers.get("D", law.D + 2.0 * (law.zeta - zeta) * law.v / law.w)
    # Static friction is not the smaller one; a slip from mu_s = mu_k begins at minus the drag.
    least = -2.0 * zeta * law.v / law.w * (1.0 + 1e-12)
    return replace(law, D=max(D, least), w=w, zeta=zeta)


def _residual(samples: Samples, law: Law, numbers: Mapping[str, float]) -> Floats:
    after = samples.t - numbers["t_break"]
    return samples.centred(samples.y - applied(law, numbers).position(after))


def _jacobian(samples: Samples, law: Law, numbers: Mapping[str, float]) -> Floats:
    """Return the residual's derivatives, shape (n, number of free numbers)."""
    columns = []
    for name, step in _steps(numbers, law).items():
        laws = [applied(law, {**numbers, name: numbers[name] + d}) for d in (-step, step)]
        late = step if name == "t_break" else 0.0
        down, up = (
            each.position(samples.t - numbers["t_break"] - d)
            for each, d in zip(laws, (-late, late), strict=True)
        )
        # A step beyond what the law allows stops there.
        moved = 2.0 * late or getattr(laws[1], name) - getattr(laws[0], name)
        columns.append((down - up) / (moved or math.inf))
    return samples.centred(np.stack(columns, axis=1))


def _steps(numbers: Mapping[str, float], law: Law) -> dict[str, float]:
    """Return steps for derivatives: small against the numbers, large against rounding."""
    sizes = {"t_break": 1.0 / law.w, "D": abs(law.D) + law.v / law.w, "w": 0.1 * law.w, "zeta": 0.1}
    return {name: 1e-6 * sizes[name] for name in numbers}


def _least_squares(samples: Samples, law: Law, numbers: dict[str, float]) -> dict[str, float]:
    """Return the numbers, moved to the least squares next to them."""
    if samples.t.size <= len(numbers):
        return numbers
    scales = np.array(list(_steps(numbers, law).values())) * 1e6
    origin = np.array(list(numbers.values()))

    def named(moves: Floats) -> dict[str, float]:
        return dict(zip(numbers, (origin + scales * moves).tolist(), strict=True))

    size = float(np.ptp(samples.y)) or 1.0
    done = least_squares(
        lambda moves: _residual(samples, law, named(moves)) / size,
        np.zeros(len(numbers)),
        lambda moves: _jacobian(samples, law, named(moves)) * scales / size,
        method="lm",
        x_scale=1.0,
        ftol=1e-10,
        xtol=1e-14,
        gtol=4.0 * EPSILON,
        max_nfev=60,
    )
    found = named(done.x)
    kept = applied(law, found)
    return {
        name: value if name == "t_break" else getattr(kept, name) for name, value in found.items()
    }


def _account(samples: Samples, law: Law, numbers: dict[str, float]) -> Fit:
    r, J = _residual(samples, law, numbers), _jacobian(samples, law, numbers)
    found = applied(law, numbers)
    position = found.position(samples.t - numbers["t_break"])
    # Least squares is linear in the samples: each moves the result by its row of the inverse.
    scale = np.maximum(np.sqrt(np.sum(J * J, axis=0)), _NOTHING)
    normal = np.linalg.pinv((J / scale).T @ (J / scale), hermitian=True)
    reach = np.sum(np.abs((J / scale) @ normal), axis=0) * samples.allowed / scale
    # Samples that all rest say of a break-away only between which two it is.
    step = float(np.max(np.diff(samples.t)))
    if float(np.max(np.abs(J[:, 0]))) * step < samples.allowed:
        reach[0] = step
    rms = math.sqrt(float(r @ r) / max(r.size - len(numbers) - 1 - samples.drifts, 1))
    variance = rms**2 * _correlation(r)
    in_cycles = _by_cycle(samples.t - numbers["t_break"], r, found.quantities()["period"])
    wanders = _wanders(*in_cycles, scatter_of(samples.t, r))
    return Fit(
        law=found,
        t_break=numbers["t_break"],
        offset=float(np.mean(samples.y - position)),
        excess=_half_range(r) / samples.allowed,
        worst=_half_range(r),
        rms=rms,
        white=is_white(samples.t, r) and not wanders,
        repeats=_repeats(*in_cycles),
        samples=samples.t.size,
        spread={name: float(d) for name, d in zip(numbers, reach, strict=True)},
        covariance=variance * normal / np.outer(scale, scale),
    )


def _checked(samples: Samples, law: Law, numbers: dict[str, float], by_some: Fit) -> Fit:
    """Return a fit to some of the samples with its largest distance from all of them."""
    worst = _half_range(_residual(samples, law, numbers))
    return replace(by_some, excess=worst / samples.allowed, worst=worst, samples=samples.t.size)


def _half_range(r: Floats) -> float:
    """Return the largest distance from the middle of the distances."""
    return 0.5 * float(np.ptp(r))


def is_white(t: Floats, r: Floats) -> bool:
    """Tell whether distances from a law are noise, each sample's independent of the next one's."""
    rms = math.sqrt(float(np.mean(r * r)))
    return rms <= _WHITE * (1.0 + _WHITE_OF_FEW / math.sqrt(r.size)) * scatter_of(t, r)


def _by_cycle(after: Floats, r: Floats, period: float) -> tuple[Floats, Floats]:
    """Return means and counts of distances in parts of each cycle, shape (cycles, `_PARTS`).

    Empty where there are too few cycles.
    """
    cycle = np.floor(after / period)
    kept = cycle >= 0.0
    if not kept.any() or not cycle[-1] >= _LEAST_CYCLES:
        return np.empty((0, _PARTS)), np.empty((0, _PARTS))
    part = np.floor((after - cycle * period)[kept] / period * _PARTS).astype(np.int64) % _PARTS
    index = cycle[kept].astype(np.int64) * _PARTS + part
    shape = (int(cycle[-1]) + 1) * _PARTS
    counts = np.bincount(index, minlength=shape).reshape(-1, _PARTS).astype(np.float64)
    sums = np.bincount(index, r[kept], minlength=shape).reshape(-1, _PARTS)
    return sums / np.maximum(counts, 1), counts


def _repeats(means: Floats, counts: Floats) -> bool:
    """Tell whether distances vary with the time since the last break-away, over cycles alike.

    Means over parts of each cycle scatter about their mean over all cycles; that mean scatters
    less by the number of cycles, unless it is a shape.
    """
    seen = np.maximum(np.sum(counts > 0, axis=0), 1)
    common = np.sum(means, axis=0) / seen
    scatter = np.sum(np.where(counts > 0, means - common, 0.0) ** 2)
    freedom = max(float(np.sum(counts > 0)) - _PARTS, 1.0)
    return not means.size or bool(np.mean(seen * common**2) > _SHAPE * scatter / freedom)


def _wanders(means: Floats, counts: Floats, scatter: float) -> bool:
    """Tell whether means over parts of cycles vary by more than the scatter of samples makes."""
    freedom = max(float(np.sum(counts > 0)), 1.0)
    power = float(np.sum(counts * means**2))
    return power > (freedom + _WANDERS * math.sqrt(2.0 * freedom)) * scatter**2


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
