"""The figures of a cycle: as the exact solution has them, and as the samples of a motion show them.

Between two break-aways the exact motion is a closed form of five numbers. A curve that lies on it
has its figures, to the digits of the samples, however far apart they are. Else the spring tells
the cycles apart: its extension rises in stick, falls in slip, and turns once in each direction
however the friction is modelled. Between a lowest and the next highest extension the mass is
slowest; there it either rests, to the digits of the samples, or creeps. docs/theory.md (3) to (8),
(13).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby, pairwise

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.ndimage import uniform_filter1d
from scipy.optimize import brentq

from stickslip_verification.truth.parameters import used_mu_k

from .read import Curve, CurveError, Floats

EPSILON = float(np.finfo(np.float64).eps)
QUANTITIES = ("period", "t_stick", "t_slip", "delta_x")

_SCAN = 400  # points of a half turn on which a damped velocity is searched for its first zero
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
    1e-3: ("t in ms, x in km or v in mm/s", "F in kN"),
    1e-6: ("t in us", "F in MN"),
}
"""Units of x and F whose numbers are this factor too large."""
_ALTERNATING, _LEAST_ALTERNATING = 20_000, 40  # samples searched for alternating friction
_EVEN_STEPS = 1e-6  # of a step: how far steps of a solver may differ
_FULL, _MOST, _BACK, _REVERSALS = 0.15, 0.9, 0.02, 0.1
"""Of the friction force: how far a value may be off static or kinetic friction; the part of the
samples that must be so near; the part that must be driven against the pull; and how often for
each of these the force must turn."""
VISIBLE = 2.0  # half units of the last digit by which two positions of a resting mass may differ
LOST = 0.2  # of the slow time: what may lack of the rest after run-out and start; creep lacks most
_DEEP = 0.4  # of the deepest fall of the spring: a turn of the cycle, and no ripple of a solver
_FEW = 5  # samples below v/2 under which a creep and the run-out of a slip look alike


def root(rest: Callable[[float], float], low: float, high: float) -> float:
    """Return where a function that changes its sign between two places is 0, to the last digit."""
    if rest(low) * rest(high) >= 0.0:
        return low if abs(rest(low)) < abs(rest(high)) else high
    tiny = EPSILON * max(abs(low), abs(high))
    return float(brentq(rest, low, high, xtol=tiny, rtol=4.0 * EPSILON))


def normal_force(p: Mapping[str, float]) -> float:
    """Return the normal force [N] of parameters [SI]; 0 where they lift the mass by rounding."""
    return max(p["m"] * p["g"] + p["load"], 0.0)


@dataclass(frozen=True)
class Solution:
    """Stick-slip of a mass that is pulled forward, with Coulomb friction, between break-aways."""

    w: float  # natural frequency [rad/s], > 0
    zeta: float  # damping ratio [-]
    v: float  # speed of the pulled end [m/s], > 0
    D: float  # spring extension at break-away beyond that of steady sliding [m]: Delta - c v/k
    continued: bool = False  # whether other cycles went before time 0; else rest did

    @cached_property
    def t_slip(self) -> float:
        """Length of a slip [s]; infinity where it ends in steady sliding."""
        if self.zeta == 0.0:
            return 2.0 / self.w * (math.pi - math.atan2(self.w * max(self.D, 0.0), self.v))
        if self.zeta >= 1.0 or self.D <= 0.0:
            return math.inf
        # A damped slip that does not stop in its first turn never does; it starts with speed 0.
        tau = np.linspace(0.0, 2.0 * math.pi / self._turn, 2 * _SCAN + 1)
        stopped = np.flatnonzero(self._speed(tau[1:]) <= 0.0)
        if not stopped.size:
            return math.inf
        low, high = tau[stopped[0] : stopped[0] + 2].tolist()
        return root(lambda at: float(self._speed(np.asarray(at))), low or 0.5 * high, high)

    @cached_property
    def relief(self) -> float:
        """Fall of the spring over a slip [m]; NaN where a slip has no end."""
        if self.zeta == 0.0:
            return 2.0 * max(self.D, 0.0)
        t_slip = self.t_slip
        return math.nan if math.isinf(t_slip) else self._way(t_slip) - self.v * t_slip

    def figures(self) -> dict[str, float]:
        """Return period, t_stick, t_slip [s] and delta_x [m] of the cycle; NaN where none is."""
        t_slip = self.t_slip
        if math.isinf(t_slip):
            return dict.fromkeys(QUANTITIES, math.nan)
        t_stick = self.relief / self.v
        period = t_stick + t_slip
        return {"period": period, "t_stick": t_stick, "t_slip": t_slip, "delta_x": self.v * period}

    def position(self, after: Floats) -> Floats:
        """Return the position [m] at times after a break-away at 0, from where it was then."""
        t_slip = self.t_slip
        if math.isinf(t_slip):
            return self._slip(np.maximum(after, 0.0))
        late = after if self.continued else np.maximum(after, 0.0)
        period = self.relief / self.v + t_slip
        count = np.floor(late / period)
        within = late - count * period
        jump = self.v * t_slip + self.relief
        way = count * (self.v * period) + jump
        slips = within < t_slip
        way[slips] += self._slip(within[slips]) - jump
        return np.asarray(way)

    def without_gap(self) -> Solution:
        """Return the solution for one friction coefficient: D is minus the drag of the damping."""
        return replace(self, D=-2.0 * self.zeta * self.v / self.w)

    def swing(self) -> float:
        """Return half the swing of the spring about its rest in sliding [m]."""
        return math.hypot(self.D, self.v / self.w)

    def seen_gap(self, swing: float) -> float:
        """Return the gap [m] that a swing of the spring from turn to turn shows."""
        return math.sqrt(max((0.5 * swing) ** 2 - (self.v / self.w) ** 2, 0.0))

    def time_to_move(self, way: float) -> float:
        """Return how long a slip from rest takes to move so far [s]; `way` [m] is positive."""
        high = 1.0 / self.w
        while self._way(high) < way:
            high *= 2.0
        return root(lambda tau: self._way(tau) - way, 0.0, high)

    def response(self, tau: Floats) -> tuple[Floats, Floats]:
        """Return the free oscillation from extension 1 at rate 0, and from 0 at rate 1 [-, s]."""
        unit = replace(self, D=1.0, v=0.0)._extension(tau)
        return unit, replace(self, D=0.0, v=1.0)._extension(tau)

    @property
    def _turn(self) -> float:
        """Frequency of the free oscillation [rad/s]; zeta is below 1."""
        return self.w * math.sqrt((1.0 - self.zeta) * (1.0 + self.zeta))

    def _way(self, tau: float) -> float:
        return float(self._slip(np.asarray(tau)))

    def _slip(self, tau: Floats) -> Floats:
        """Return the way of the mass [m] at times tau of one slip."""
        return self.v * tau + self.D - self._extension(tau)

    def _speed(self, tau: Floats) -> Floats:
        """Return the velocity of the mass [m/s] at times tau of one slip."""
        of_extension, of_rate = self.response(tau)
        pull = self.w * self.D + 2.0 * self.zeta * self.v
        return self.v * (1.0 - of_extension) + self.w * pull * of_rate

    def _extension(self, tau: Floats) -> Floats:
        """Return the extension beyond steady sliding [m], docs/theory.md (3)."""
        if self.zeta >= 1.0:
            # So written that close or distant rates cancel nowhere.
            wide = self.zeta + math.sqrt((self.zeta - 1.0) * (self.zeta + 1.0))
            decay, apart = self.w / wide, self.w * (wide - 1.0 / wide)
            even, rate = np.ones_like(tau), apart or 1.0
            wave = -np.expm1(-apart * tau) if apart else tau
        else:
            decay, rate = self.zeta * self.w, self._turn
            even, wave = np.cos(rate * tau), np.sin(rate * tau)
        z = self.D * even + (self.v + decay * self.D) / rate * wave
        return np.asarray(np.exp(-decay * tau) * z)


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
            f"unit: of a column in the header or with its name, '{example}'"
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


@dataclass(frozen=True)
class Event:
    """A transition between two bounds [s]."""

    low: float
    high: float


@dataclass(frozen=True)
class Stick:
    """The slow phase between two slips, or before the first."""

    begin: Event | None  # re-stick; None where the curve starts in this phase
    end: Event | None  # break-away; None where the curve ends in this phase
    level: float  # position [m]
    samples: int  # how many there are in the phase
    rests: bool = True  # whether the mass rests, to the digits of the samples
    creep: float | None = 0.0  # speed over its middle half [m/s]; None where samples are too few
    late_over_early: float = math.nan  # creep in the third quarter over that in the second [-]
    z_high: float = math.nan  # spring extension at the turn after it [m]


@dataclass(frozen=True)
class Phases:
    """Sticks of a motion and turns of its spring, in order of time."""

    sticks: tuple[Stick, ...]
    highs: Floats  # spring extension where it turns from rising to falling [m]
    high_times: Floats  # [s]
    lows: Floats  # spring extension where it turns from falling to rising [m]
    fall: float  # deepest fall of the spring [m]
    only_rests: bool  # whether the mass is not seen to move at all


def find_phases(motion: Motion, solution: Solution) -> Phases:
    """Find the sticks of a motion; `solution` tells how long run-out and start of a rest take."""
    z = motion.z
    fall = float(np.max(np.maximum.accumulate(z) - z))
    turns = _turns(z, _DEEP * fall) if fall > 8.0 * motion.allowed else []
    highs, lows = turns[::2], turns[1::2]
    sticks = [
        _stick(motion, solution, begin, end, fall)
        for begin, end in zip([None, *lows], [*highs, None][: len(lows) + 1], strict=True)
    ]
    return Phases(
        sticks=tuple(stick for stick in sticks if stick),
        highs=z[highs],
        high_times=motion.t[highs],
        lows=z[lows],
        fall=fall,
        only_rests=float(np.ptp(motion.y)) <= 2.0 * VISIBLE * motion.allowed,
    )


def _turns(z: Floats, deep: float) -> list[int]:
    """Return the turns of z, a highest first, then alternating."""
    first_of_equals = np.flatnonzero(np.diff(z, prepend=np.nan) != 0.0)
    way = np.sign(np.diff(z[first_of_equals]))
    extremes = first_of_equals[np.flatnonzero(np.diff(way, prepend=0.0, append=0.0))]
    turns: list[int] = []
    direction, best, at = 1.0, float(z[0]), 0
    for index, value in zip(extremes.tolist(), z[extremes].tolist(), strict=True):
        if direction * value > direction * best:
            best, at = value, index
        elif direction * value < direction * best - deep:
            turns.append(at)
            direction, best, at = -direction, value, index
    return turns


def _stick(
    motion: Motion, solution: Solution, low: int | None, high: int | None, fall: float
) -> Stick | None:
    """Look at the samples between a lowest and a highest extension; None where none is slow."""
    first, last = low or 0, motion.t.size - 1 if high is None else high
    t, y, v = motion.t[first : last + 1], motion.y[first : last + 1], solution.v
    if t.size < 2:
        return None
    i, j, level = _plateau(t, y, VISIBLE * motion.allowed)
    slow = np.flatnonzero(_speed(t, y, motion.allowed, v) < 0.5 * v)
    if not slow.size:
        return None
    from_, to = int(min(slow[0], i)), int(max(slow[-1], j))
    begins, ends = low is not None, high is not None
    swing = float(motion.z[high] - motion.z[low]) if low is not None and high is not None else fall
    run_out, hidden = _invisible(solution, solution.seen_gap(swing), motion.allowed)
    tail = run_out * (begins + ends) + 2.0 * hidden
    window = max(8.0 * motion.allowed / v, float(np.max(np.diff(t))))
    slow_time, rest = float(t[to] - t[from_]), float(t[j] - t[i])
    creeps = to - from_ >= _FEW and slow_time - rest > tail + LOST * slow_time + 2.0 * window
    creep, late_over_early = (0.0 if j > i else None), math.nan
    if creeps:
        quarter = (to - from_) // 4
        a, b = from_ + quarter, to - quarter
        middle = (a + b) // 2
        creep = _slope(t, y, a, b)
        late_over_early = _slope(t, y, middle, b) / (_slope(t, y, a, middle) or math.nan)
        i, j, hidden = from_, to, 0.0
    before = float(motion.t[max(first + i - 1, 0)]) - motion.blur
    after = float(motion.t[min(first + j + 1, motion.t.size - 1)]) + motion.blur
    hidden += motion.blur
    return Stick(
        begin=Event(before, float(t[i]) + hidden) if begins else None,
        end=Event(float(t[j]) - hidden, after) if ends else None,
        level=level,
        samples=to - from_ + 1,
        rests=j > i and not creeps,
        creep=creep,
        late_over_early=late_over_early,
        z_high=math.nan if high is None else float(motion.z[high]),
    )


def _slope(t: Floats, y: Floats, a: int, b: int) -> float:
    return float((y[b] - y[a]) / (t[b] - t[a]))


def _plateau(t: Floats, y: Floats, band: float) -> tuple[int, int, float]:
    """Return first and last sample and the level of the longest time within a band of y.

    A solver may step back a little where it stops, so that y only nearly rises; a mass that
    creeps back falls.
    """
    runs = []
    for rising in (y, -y):
        highest = np.maximum.accumulate(rising)
        ends = np.searchsorted(highest, rising + band, side="right") - 1
        ends = np.maximum(ends, np.arange(t.size))
        i = int(np.argmax(t[ends] - t))
        level = float(np.median(y[i : int(ends[i]) + 1]))
        edges = np.flatnonzero(np.diff(np.abs(y - level) <= band, prepend=False, append=False))
        first, last = edges[::2], edges[1::2] - 1
        if first.size:
            best = int(np.argmax(t[last] - t[first]))
            runs.append((int(first[best]), int(last[best]), level))
    return max(runs, key=lambda run: float(t[run[1]] - t[run[0]]), default=(0, 0, float(y[0])))


def _speed(t: Floats, y: Floats, allowed: float, v: float) -> Floats:
    """Return the velocity at each sample [m/s], over times in which v outweighs the digits."""
    half = 4.0 * allowed / v
    mean_step = (t[-1] - t[0]) / (t.size - 1)
    reach = max(1, math.ceil(min(half / mean_step, float(t.size))))
    low = np.maximum(np.arange(t.size) - reach, 0)
    high = np.minimum(np.arange(t.size) + reach, t.size - 1)
    return np.asarray((y[high] - y[low]) / (t[high] - t[low]))


def _invisible(solution: Solution, gap: float, allowed: float) -> tuple[float, float]:
    """Return how long a slip from rest needs to reach v/2, and stays within the digits [s]."""
    w, v = solution.w, solution.v
    turn = math.acos(0.5 * v / (w * math.hypot(gap, v / w)))
    way = 4.0 * allowed
    by_jerk = (6.0 * way / (v * w**2)) ** (1.0 / 3.0)
    by_acceleration = math.sqrt(2.0 * way / (gap * w**2)) if gap > 0.0 else math.inf
    return (turn - math.atan2(w * gap, v)) / w, float(min(by_jerk, by_acceleration))


def first_rest(motion: Motion) -> int:
    """Return the last sample of those at the begin in which the mass is not seen to move."""
    out = np.flatnonzero(np.abs(motion.y - motion.y[0]) > VISIBLE * motion.allowed)
    return int(out[0]) - 1 if out.size else motion.t.size - 1


def rests_of(motion: Motion) -> list[tuple[int, int]]:
    """Return first and last sample of the rest at the begin, and of the longest if it is later."""
    begin, longest = first_rest(motion), _plateau(motion.t, motion.y, VISIBLE * motion.allowed)[:2]
    return [(0, begin), longest] if longest[0] > begin else [(0, begin)]


def break_away(motion: Motion, solution: Solution, last: int) -> tuple[float, float] | None:
    """Return the times [s] between which a mass breaks away that rests till sample `last`.

    None where it rests to the end.
    """
    if last + 1 >= motion.t.size:
        return None
    # The band of a rest is `VISIBLE` wide, and so may its level be off.
    hidden = solution.time_to_move(2.0 * VISIBLE * motion.allowed)
    return float(motion.t[last]) - hidden, float(motion.t[last + 1])


@dataclass(frozen=True)
class Figures:
    """What the cycles of a curve come to; what it does not show is missing."""

    values: dict[str, tuple[float, float]]  # of `QUANTITIES`: value > 0 and resolution [s, m]
    cycles: int  # complete ones, from break-away to break-away
    jumps: tuple[float, ...] = ()  # of the mass between two rests [m], where sticks were seen


def figures_of(sticks: Sequence[Stick], allowed: float) -> Figures:
    """Take means over the cycles between sticks that are resolved, from the bounds of their events.

    `sticks` are in order of time; `allowed` is how far a position may be off for its digits [m].
    """
    resolved = [stick if stick.rests or stick.creep is not None else None for stick in sticks]
    slips = [(a, b, a.end, b.begin) for a, b in pairwise(resolved) if a and b and a.end and b.begin]
    rests = [(begin, b.end) for _, b, _, begin in slips if b.end]
    jumps = tuple(b.level - a.level for a, b, *_ in slips)
    values: dict[str, tuple[float, float]] = {}
    if rests:
        # The events inside an unbroken chain of cycles cancel.
        ends = (stick.end if stick else None for stick in resolved)
        chains = [[end for end in chain if end] for _, chain in groupby(ends, bool)]
        spans = [_between(chain[0], chain[-1]) for chain in chains if len(chain) > 1]
        values["period"] = _mean(spans, len(rests))
        values["t_stick"] = _mean([_between(*events) for events in rests], len(rests))
    if slips:
        values["t_slip"] = _mean([_between(end, begin) for *_, end, begin in slips], len(slips))
        # The level of a stick that creeps may be off by half the creep.
        levels = [
            0.25 * abs(stick.creep) * (stick.end.low - stick.begin.high)
            for a, b, *_ in slips
            for stick in (a, b)
            if not stick.rests and stick.begin and stick.end and stick.creep
        ]
        resolution = 2.0 * allowed * len(slips) + sum(levels)
        values["delta_x"] = (sum(jumps) / len(jumps), resolution / len(slips))
    return Figures(values, len(rests), jumps)


def _between(begin: Event, end: Event) -> tuple[float, float]:
    """Middle and half the width of the time between two events, never below 0."""
    least, most = max(end.low - begin.high, 0.0), max(end.high - begin.low, 0.0)
    return 0.5 * (least + most), 0.5 * (most - least)


def _mean(spans: Sequence[tuple[float, float]], count: int) -> tuple[float, float]:
    """Return middle and half the width of the mean of `count` times that make up some spans."""
    return sum(middle for middle, _ in spans) / count, sum(half for _, half in spans) / count
