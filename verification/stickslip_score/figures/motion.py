"""A curve as a motion: its pull turned forward, its digits and noise, x and F compared."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.ndimage import uniform_filter1d

from stickslip_score.figures.solution import Solution, normal_force
from stickslip_score.read import Curve, CurveError, Floats
from stickslip_verification.truth.parameters import used_mu_k

COARSE = 0.1  # radians of the oscillation between samples from which third differences hold motion
_SOLVER_FLOOR = 1e-9  # of the range of x: no tool that integrates promises more
_ROUNDINGS = 4.0 * 2.0**-53  # of the longest way: two ways, each rounded by the tool and once here
_DEVIATIONS = 4.0  # standard deviations of noise that bound it where samples are taken one by one
_STRIDES = (1, 4, 16, 64)  # samples between those whose scatter is noise: a filter's share theirs
_SHARED = 0.1  # of the noise of a column: that of the difference of x and F where both have it
_DIFFERENCE_OF = 20_000  # samples from which the difference of x and F is described
_MISMATCH = 1e-3  # of a spring's way: F/k off x by another stiffness; ten times what 4 digits show
_DRIFTS = 3  # degree of the polynomial in time that the zero of F may follow
_OPPOSITE = 0.1  # how near to -1 times the spring's way F has the opposite sign
_LINE = 0.1  # of the swing: noise of a smoothed motion below which its turns stand out
_WINDOW, _WINDOWS, _LEAST_WINDOWS = 4, 2000, 3  # third differences in a window; windows in a record
_QUIET, _QUARTILE, _OUTLIER = 0.25, 0.31, 8.0
"""Part of the windows taken for quiet at first; the mean square that this part of independent noise
stays below, of its own; the mean square, of the quiet windows', above which one holds motion."""
_TURNS = (0.35, 0.95)
"""Share of neighbouring third differences of opposite sign in noise. Independent noise has
acos(-3/4)/pi = 0.77, a smooth motion hardly any, one that alternates from sample to sample 1."""
_SPREAD = 0.2
"""Least share of third differences between a quarter and three quarters of the largest twentieth.
Gaussian noise has 0.48; those of a solver that chatters have two sizes."""
_PAIRS = 20  # neighbouring differences below which signs tell nothing
_SIGN = 0.25  # of the way of the pulled end, and of the friction force: a way that has a sign
_NEAR = 4.0  # factor about a power of 1000 within which a unit is the likeliest reason
_UNITS = {
    1e3: ("x in mm or t in ks", "F in mN"),
    1e6: ("x in um", "F in uN"),
    1e9: ("x in nm", "F in nN"),
    1e-3: ("t in ms or x in km", "F in kN"),
    1e-6: ("t in us", "F in MN"),
}
"""Units of x and F whose numbers are this factor too large."""
_ALTERNATING, _LEAST_ALTERNATING = 20_000, 40  # samples searched for alternating friction
_EVEN_STEPS = 1e-6  # of a step: how far steps of a solver may differ
_FULL, _MOST, _BACK, _REVERSALS = 0.15, 0.9, 0.02, 0.1
"""Of the friction force: how far a value may be off static or kinetic friction; the part of the
samples that must be so near; the part that must be driven against the pull; and how often for
each of these the force must turn."""


def si(value: float, unit: str) -> str:
    """Return a value in SI with the prefix that fits."""
    prefixes = ((1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))
    fitting = prefixes if unit == "N" else prefixes[1:]
    size, prefix = next((p for p in fitting if abs(value) >= p[0]), fitting[-1])
    return f"{value / size:.3g} {prefix}{unit}" if value else f"0 {unit}"


@dataclass(frozen=True)
class Motion:
    """Samples of a curve with the pull turned forward, shape (n,)."""

    t: Floats  # [s]
    y: Floats  # position along the pull [m]
    z: Floats  # spring extension [m], up to a constant where F is not in the curve
    source: str  # the column from which y was taken
    digits: float  # how far y may be from the truth for the digits of the file [m]
    noises: Mapping[str, float]  # standard deviation by column x, F [m]; 0 where it was computed
    shared: bool  # whether x and F have the same noise, as where one was made from the other
    z_allowed: float  # how far z may be off for digits, noise and drift of F [m]; 0 without F
    drift: float  # slow part of F - k (v t - x), from its lowest to its highest [N]
    mismatch: str  # why x and F do not belong together with this k; empty where they do
    blur: float = 0.0  # half the time over which y and z are averages [s]
    chatters: bool = False  # whether each sample is a step of a solver that chatters in stick

    @property
    def noise(self) -> float:
        """Standard deviation of the noise of y [m]."""
        return self.noises[self.source]

    @property
    def allowed(self) -> float:
        """How far y may be from the truth for digits and noise [m]."""
        return self.digits + _DEVIATIONS * self.noise

    @property
    def measured(self) -> bool:
        """Whether a column has noise; no solver's has."""
        return any(self.noises.values())

    @property
    def step(self) -> float:
        """Mean time between samples [s]."""
        return float(self.t[-1] - self.t[0]) / (self.t.size - 1)

    @property
    def widest_step(self) -> float:
        """Longest time between samples [s]."""
        return float(np.max(np.diff(self.t)))

    def rests(self) -> bool:
        """Tell whether the mass rests to the digits, as only a computed one does."""
        return _alike(self.y, self.digits, self.noise)

    def with_noise(self, noise: float) -> Motion:
        """Return the motion with another noise of y [m]; without any, no column has one."""
        if noise == 0.0 or self.shared:
            return replace(self, noises=dict.fromkeys(self.noises, noise))
        return replace(self, noises={**self.noises, self.source: noise})

    def smoothed(self, solution: Solution) -> Motion:
        """Return the motion averaged over times short against a slip, as far as its noise asks."""
        swing = math.hypot(max(solution.D, 0.0), solution.v / solution.w)
        enough = (8.0 * _DEVIATIONS * self.noise / (_LINE * swing)) ** 2
        longest = 0.15 * min(solution.t_slip, 2.0 * math.pi / solution.w) / self.step
        count = max(1, math.ceil(min(enough, longest, self.t.size / 4.0)))
        if count == 1:
            return self
        some, blur = slice(None, None, count // 2), 0.5 * count * self.step
        y, z = (uniform_filter1d(s, count, mode="nearest")[some] for s in (self.y, self.z))
        noises = {**self.noises, self.source: self.noise / math.sqrt(count)}
        return replace(self, t=self.t[some], y=y, z=z, noises=noises, blur=blur)


def motion_of(curve: Curve, p: Mapping[str, float], solution: Solution) -> Motion:
    """Turn a curve into a motion; what is missing of x and F follows from F = k (v t - x) + const.

    Where both are there, the one with less noise tells the motion, and x where F drifts. `p` are
    all parameters, SI, v with the sign of the motion; `solution` has the speeds and times due.
    """
    sign, k, v = math.copysign(1.0, p["v"]), p["k"], solution.v
    since = curve.t - curve.t[0]
    jitter = curve.t_rounding * (v * (1.0 + math.hypot(1.0, solution.w * solution.D / v)))
    longest = v * float(np.max(np.abs(curve.t)))
    positions: dict[str, Floats] = {}
    digits: dict[str, float] = {}
    if curve.x is not None:
        positions["x"] = sign * (curve.x - curve.x[0])
        digits["x"] = curve.x_rounding + jitter
        longest = max(longest, float(np.max(np.abs(curve.x))))
    if curve.F is not None:
        extension = sign * curve.F / k
        positions["F"] = v * since - (extension - extension[0])
        digits["F"] = curve.F_rounding / k + v * curve.t_rounding + jitter
        longest = max(longest, float(np.max(np.abs(extension))))
    for name, y in positions.items():
        digits[name] += _SOLVER_FLOOR * float(np.ptp(y)) + _ROUNDINGS * longest
    noises, shared = _noises(curve.t, positions, digits, solution)
    drift, mismatch, source = 0.0, "", min(positions, key=lambda name: noises[name])
    if len(positions) == 2:
        z = v * since - positions["x"]
        drift, mismatch = _compared(since, extension, z, sum(digits.values()), noises)
        source = "x" if drift > 0.0 or mismatch else source
    z, z_allowed = v * since - positions[source], 0.0
    if curve.F is not None:
        z += float(np.median(extension - z))
        scatter = _DEVIATIONS * math.hypot(*noises.values()) / math.sqrt(since.size)
        z_allowed = curve.F_rounding / k + drift + scatter
    motion = Motion(
        t=curve.t,
        y=positions[source],
        z=z,
        source=source,
        digits=max(digits[source], 1e-300),
        noises=noises,
        shared=shared,
        z_allowed=z_allowed,
        drift=k * drift,
        mismatch=mismatch,
    )
    by_sign = _chatters(motion, solution, p)
    return replace(motion.with_noise(0.0), chatters=True) if by_sign else motion


def is_turned(curve: Curve, p: Mapping[str, float], exact: Mapping[str, float] | None) -> bool:
    """Tell whether the pull goes against v; refuse x or F that are a power of 1000 off."""
    duration, v = float(curve.t[-1] - curve.t[0]), p["v"]
    if curve.x is not None:
        # From the first tenth of the samples to the last, over nine tenths of them.
        tenth = max(curve.x.size // 10, 1)
        way = float(np.mean(curve.x[-tenth:]) - np.mean(curve.x[:tenth]))
        way, due = way / (1.0 - tenth / curve.x.size), v * duration
        ratio, column, example = abs(way / due), 0, "x [mm]"
        seen = f"x advances at {si(abs(way) / duration, 'm/s')} on average"
    else:
        assert curve.F is not None
        span, static = float(np.ptp(curve.F)), p["mu_s"] * normal_force(p)
        way, due = float(np.mean(curve.F)) + p["F_ext"], math.copysign(static, v)
        jump = exact["delta_x"] if exact else math.inf
        ratio, column, example = span / (p["k"] * jump), 1, "F [kN]"
        seen = f"F varies by {si(span, 'N')}"
    power = next((power for power in _UNITS if power / _NEAR < ratio < power * _NEAR), 0.0)
    if exact is not None and duration >= 1.5 * exact["period"] and power:
        raise CurveError(
            f"{seen}, {power:g} times as much as it should: {_UNITS[power][column]}? State the "
            f"unit in the header or with the column's name, '{example}'"
        )
    return way * due < 0.0 and abs(way) > _SIGN * abs(due)


def _chatters(motion: Motion, solution: Solution, p: Mapping[str, float]) -> bool:
    """Tell whether each sample is a step of a solver with friction by the sign of the velocity.

    In stick full friction drives it now one way, now the other, so that the friction force that its
    samples imply has two values and none between; noise has all of them.
    """
    t, y, z = (column[:_ALTERNATING] for column in (motion.t, motion.y, motion.z))
    steps = np.diff(t)
    step = float(np.mean(steps))
    uneven = float(np.ptp(steps)) > _EVEN_STEPS * step + 2.0 * np.spacing(t[-1])
    if t.size < _LEAST_ALTERNATING or uneven:
        return False
    friction = z[1:-1] - np.diff(y, 2) / (solution.w * step) ** 2
    per_force = normal_force(p) / p["k"]
    full, kinetic = p["mu_s"] * per_force, used_mu_k(p["mu_s"], p["mu_k"]) * per_force
    low, high = np.quantile(friction, [0.01, 0.99])
    back = friction < 0.5 * (low + high)
    reversals = np.count_nonzero(np.diff(back))
    if not _BACK <= np.mean(back) < 1.0 or reversals < _REVERSALS * np.count_nonzero(back):
        return False
    # The spring is known up to a constant; either pair of values may be the two of one size.
    pairs = np.array([low + high, np.median(friction[back]) + np.median(friction[~back])])
    size = np.abs(friction - 0.5 * pairs[:, None])
    off = np.minimum(np.abs(size - full), np.abs(size - kinetic))
    return bool(np.any(np.mean(off < _FULL * full, axis=1) > _MOST))


def _noises(
    t: Floats, positions: Mapping[str, Floats], digits: Mapping[str, float], solution: Solution
) -> tuple[dict[str, float], bool]:
    """Return the noise of the positions [m] by column, and whether the columns share it.

    Coarse samples scatter for the motion as well, but not the difference of two positions.
    """
    stick = 1.0 / solution.w if math.isinf(solution.t_slip) else solution.relief / solution.v
    step = float(t[-1] - t[0]) / (t.size - 1)
    strides = [n for n in _STRIDES if n == 1 or 14.0 * n * step < stick]

    def noise_of(y: Floats, digits: float) -> float:
        return max(_noise(t[::stride], y[::stride], digits) for stride in strides)

    noises = {name: noise_of(y, digits[name]) for name, y in positions.items()}
    if len(noises) == 1:
        return noises, False
    of_both = noise_of(positions["x"] - positions["F"], sum(digits.values()))
    coarse = step * solution.w >= COARSE
    shared = of_both <= (0.0 if coarse else _SHARED * min(noises.values()))
    if coarse and not shared:
        noises = {name: min(noise, of_both) for name, noise in noises.items()}
        if not any(noises.values()):
            # What rests to its digits has none.
            noises = {
                name: 0.0 if _alike(y, digits[name], of_both) else of_both
                for name, y in positions.items()
            }
    return noises, shared


def _alike(y: Floats, digits: float, noise: float) -> bool:
    """Tell whether neighbouring samples are alike more often than noise lets them be."""
    alike = float(np.mean(np.abs(np.diff(y[:_DIFFERENCE_OF])) <= 2.0 * digits))
    by_chance = math.erf(digits / noise) if noise else 0.0
    return alike > 3.0 * by_chance + 0.02


def _compared(
    since: Floats, extension: Floats, z: Floats, digits: float, noises: Mapping[str, float]
) -> tuple[float, str]:
    """Return how far F/k drifts off v t - x [m], and why they contradict each other if so.

    A zero that drifts follows time; another stiffness follows the spring, a delay its rate.
    """
    stride = -(-since.size // _DIFFERENCE_OF)
    t, extension, z = since[::stride], extension[::stride], z[::stride]
    # The spring's way as the column tells that has less noise: noise follows itself.
    way = extension if noises["F"] < noises["x"] else z
    size, span = float(np.ptp(way)) or 1.0, float(np.ptp(extension))
    apart, of_spring, of_rate = (
        without_drift(t, s, _DRIFTS) for s in (extension - z, way, np.gradient(way, t))
    )
    early, sure_of_early, rest = _part_of(apart, of_rate, 1e-6 * size / t[-1])
    share, sure, rms = _part_of(apart, of_spring, 1e-6 * size)
    moved = abs(early) * math.sqrt(float(np.mean(of_rate**2)))
    if abs(early) > 2.0 * sure_of_early and moved > 4.0 * digits and rest < rms:
        return 0.0, (
            f"F is {'early' if early > 0.0 else 'late'} by about {si(abs(early), 's')} against "
            "k (v t - x): a delay of one of them, or a filter"
        )
    if share:
        sure += min(noises.values()) ** 2 * t.size / float(of_spring @ of_spring)
    if abs(share) > _MISMATCH * span / size + 16.0 * digits / size + 4.0 * sure:
        if abs(abs(share) - 2.0) < _OPPOSITE:
            return 0.0, "F is -k (v t - x) + const: it has the opposite sign"
        return 0.0, (
            "F is not k (v t - x) + const with these k and v: "
            f"it is off by up to {0.5 * abs(share) * size / span:.2g} of its range"
        )
    surely = 5.0 * rms * math.sqrt((_DRIFTS + 1) / t.size) + 4.0 * digits
    wander = float(np.ptp(extension - z - apart))
    return (wander if wander > 2.0 * surely + 1e-6 * size else 0.0), ""


def without_drift(t: Floats, s: Floats, degree: int) -> Floats:
    """Return signals, shape (n,) or (n, m), without the polynomial in time that is nearest."""
    if not degree:
        return np.asarray(s - np.mean(s, axis=0))
    at = 2.0 * (t - t[0]) / (t[-1] - t[0]) - 1.0
    basis, _ = np.linalg.qr(np.polynomial.legendre.legvander(at, degree))
    return np.asarray(s - basis @ (basis.T @ s))


def _part_of(apart: Floats, signal: Floats, least: float) -> tuple[float, float, float]:
    """Part of a signal, of rms `least` or more, in a difference; 5 deviations of it; rest's rms."""
    power = float(signal @ signal)
    share = float(signal @ apart) / power if power > least**2 * apart.size else 0.0
    rms = math.sqrt(float(np.mean((apart - share * signal) ** 2)))
    return share, 5.0 * rms / math.sqrt(power) if share else 0.0, rms


def _noise(t: Floats, s: Floats, digits: float) -> float:
    """Return the standard deviation of the noise of a signal; 0 where none is seen.

    Only what has the signs and sizes of noise is noise; scatter of the size of the digits is none.
    """
    quiet = _quiet_differences(t, s)
    sigma = _rms(quiet)
    # Rounding alone scatters by 1/sqrt(3) of half a unit.
    if not sigma > 0.7 * digits:
        return 0.0
    pairs = quiet[:, 1:] * quiet[:, :-1]
    if np.count_nonzero(pairs) < _PAIRS:
        return 0.0
    turns = np.mean(pairs[pairs != 0.0] < 0.0)
    size = np.abs(quiet)
    large = np.quantile(size, 0.95)
    spread = np.mean((size > 0.25 * large) & (size < 0.75 * large))
    return sigma if _TURNS[0] < turns < _TURNS[1] and spread > _SPREAD else 0.0


def scatter_of(t: Floats, s: Floats) -> float:
    """Return the standard deviation of any scatter from sample to sample; NaN for few samples."""
    return _rms(_quiet_differences(t, s))


def _rms(s: Floats) -> float:
    return float(np.sqrt(np.mean(s**2))) if s.size else math.nan


def _quiet_differences(t: Floats, s: Floats) -> Floats:
    """Return third divided differences in windows without motion, each of the noise's variance.

    Shape (windows, `_WINDOW`). A motion that the samples resolve leaves little in them.
    """
    last = t.size - _WINDOW - 3
    count = min(_WINDOWS, 1 + last // 2)
    if count < _LEAST_WINDOWS:
        return np.empty((0, _WINDOW))
    index = np.linspace(0, last, count).astype(np.int64)[:, None] + np.arange(_WINDOW + 3)
    at, value = t[index], s[index] - s[index[:, :1]]
    nodes, values = sliding_window_view(at, 4, axis=1), sliding_window_view(value, 4, axis=1)
    apart = nodes[..., :, None] - nodes[..., None, :] + np.eye(4)
    weights = 1.0 / np.prod(apart, axis=-1)
    weights /= np.sqrt(np.sum(weights**2, axis=-1, keepdims=True))
    d = np.sum(weights * values, axis=-1)
    power = np.mean(d**2, axis=1)
    quiet = power <= _OUTLIER * (float(np.quantile(power, _QUIET)) / _QUARTILE)
    for _ in range(3):
        quiet = power <= _OUTLIER * float(np.mean(power[quiet]))
    return np.asarray(d[quiet])
