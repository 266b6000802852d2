"""A curve as the motion of a mass that is pulled forward: position, spring, digits and noise."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import uniform_filter1d

from stickslip_score.law import Law
from stickslip_score.noise import noise_of
from stickslip_score.read import Curve, Floats
from stickslip_score.words import time

_SOLVER_FLOOR = 1e-9
"""Of the range of x: no tool that integrates promises more, so less is held against none."""

_ROUNDINGS = 4.0 * 2.0**-53
"""Of the longest way: a position is the difference of two ways in double precision, and either is
a product or a sum that has been rounded before, once by the tool and once here."""

_DRIFT = 1e-3
"""Of a spring's way: how far F/k may be off x for another stiffness before they contradict each
other. Ten times what a curve printed to four digits shows."""

_DRIFTS, _OPPOSITE = 3, 0.1
"""Degree of the polynomial in time that a zero may follow, and how near to -1 times the spring's
way F is where its sign is the opposite one."""

_DEVIATIONS = 4.0
"""Standard deviations of noise that count as its bound where samples are looked at one by one."""

_STRIDES = (1, 4, 16, 64)
"""Samples between those whose scatter is noise; neighbours share what a filter has passed."""

COARSE = 0.1
"""Radians of the oscillation between samples from which on their third differences hold motion."""

_SHARED = 0.1
"""Of the noise of a column: that of the difference of x and F below which both have the same."""

_LOOKED_AT = 20_000
"""Samples from which the difference of x and F is described."""

_LINE_OF_MOTION = 0.1
"""Of the swing: noise of a smoothed motion below which its turns stand out."""


@dataclass(frozen=True)
class Motion:
    """Samples with the pull turned forward, shape (n,).

    Attributes
    ----------
    t, y
        Time [s] and position along the pull [m].
    z
        Spring extension [m]; up to a constant where `absolute` is false.
    x_dot
        Velocity along the pull [m/s], None where not given.
    absolute
        Whether the spring force was given, so that z is known in full.
    digits
        How far y may be from the truth for the digits of the file [m].
    noise
        Standard deviation of the noise of y [m]; 0 for a motion that was computed.
    noises
        The same by the column, x or F, from which y follows [m].
    shared
        Whether x and F have the same noise, as where one was made from the other.
    source
        The column from which y was taken, x or F.
    x_dot_allowed
        How far x_dot may be off for its digits [m/s].
    z_allowed
        How far a spring extension may be off for digits, noise and drift of F [m]; 0 where F is
        not given.
    drift
        Slow part of F - k (v t - x), from its lowest to its highest [N]; 0 where none is seen.
    mismatch
        Why x and F do not belong together with this k; empty where they do.
    from_force
        Whether y can be taken from F alone, by k and v.
    v
        Speed of the pulled end [m/s], > 0.
    blur
        Half the time over which y and z are averages [s]; 0 for samples as they are.
    """

    t: Floats
    y: Floats
    z: Floats
    x_dot: Floats | None
    absolute: bool
    digits: float
    noise: float
    noises: Mapping[str, float]
    shared: bool
    source: str
    x_dot_allowed: float
    z_allowed: float
    drift: float
    mismatch: str
    from_force: bool
    v: float
    blur: float = 0.0

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

    def rests(self) -> bool:
        """Tell whether the mass rests to the digits, as only a computed one does."""
        return _alike(self.y, self.digits, self.noise)

    def with_noise(self, noise: float) -> "Motion":
        """Return the motion with another noise of y [m]; without any, no column has one."""
        if noise == 0.0 or self.shared:
            return replace(self, noise=noise, noises=dict.fromkeys(self.noises, noise))
        return replace(self, noise=noise, noises={**self.noises, self.source: noise})

    def extension(self, time: float, y: float) -> float:
        """Return the spring extension [m] at a time [s] at which the mass is at y [m]."""
        shift = float(np.median(self.z - (self.v * (self.t - self.t[0]) - self.y)))
        return self.v * (time - float(self.t[0])) - y + shift

    def smoothed(self, law: Law) -> "Motion":
        """Return the motion averaged over times short against a slip, as far as its noise asks."""
        swing = math.hypot(max(law.D, 0.0), law.v / law.w)
        wanted = (8.0 * _DEVIATIONS * self.noise / (_LINE_OF_MOTION * swing)) ** 2
        step = float(self.t[-1] - self.t[0]) / (self.t.size - 1)
        longest = 0.15 * min(law.t_slip, 2.0 * math.pi / law.w) / step
        count = max(1, math.ceil(min(wanted, longest, self.t.size / 4.0)))
        if count == 1:
            return self
        kept = slice(None, None, max(1, count // 2))
        return replace(
            self,
            t=self.t[kept],
            y=uniform_filter1d(self.y, count, mode="nearest")[kept],
            z=uniform_filter1d(self.z, count, mode="nearest")[kept],
            x_dot=None if self.x_dot is None else self.x_dot[kept],
            noise=self.noise / math.sqrt(count),
            blur=0.5 * count * step,
        )


def motion_of(curve: Curve, p: Mapping[str, float], law: Law) -> Motion:
    """Turn a curve into a motion; what is missing of x and F follows from F = k (v t - x) + const.

    Where both are given, the one with less noise tells the motion, and x where F drifts.

    Parameters
    ----------
    curve
        The samples.
    p
        All parameters of the block, SI; v is not 0 and has the sign of the motion.
    law
        The exact law: speeds and times that are to be expected.
    """
    sign, k = math.copysign(1.0, p["v"]), p["k"]
    since = curve.t - curve.t[0]
    top_speed = law.v * (1.0 + math.hypot(1.0, law.w * law.D / law.v))
    jitter = curve.t_rounding * top_speed
    longest = law.v * float(np.max(np.abs(curve.t)))
    positions: dict[str, Floats] = {}
    digits: dict[str, float] = {}
    if curve.x is not None:
        positions["x"] = sign * (curve.x - curve.x[0])
        digits["x"] = curve.x_rounding + jitter
        longest = max(longest, float(np.max(np.abs(curve.x))))
    if curve.F is not None:
        given = sign * curve.F / k
        positions["F"] = law.v * since - (given - given[0])
        digits["F"] = curve.F_rounding / k + law.v * curve.t_rounding + jitter
        longest = max(longest, float(np.max(np.abs(given))))
    for name, y in positions.items():
        digits[name] += _SOLVER_FLOOR * float(np.ptp(y)) + _ROUNDINGS * longest
    noises, shared = _noises(curve.t, positions, digits, law)
    drift, mismatch = 0.0, ""
    if len(positions) == 2:
        z = law.v * since - positions["x"]
        drift, mismatch = _compared(since, given, z, sum(digits.values()), noises)
    of_x = "x" in positions and (
        len(positions) == 1 or noises["x"] <= noises["F"] or drift > 0.0 or bool(mismatch)
    )
    source = "x" if of_x else "F"
    y = positions[source]
    z = law.v * since - y
    z_allowed = 0.0
    if curve.F is not None:
        z += float(np.median(given - z))
        scatter = _DEVIATIONS * math.hypot(*noises.values()) / math.sqrt(since.size)
        z_allowed = curve.F_rounding / k + drift + scatter
    return Motion(
        t=curve.t,
        y=y,
        z=z,
        x_dot=None if curve.x_dot is None else sign * curve.x_dot,
        absolute=curve.F is not None,
        digits=max(digits[source], 1e-300),
        noise=noises[source],
        noises=noises,
        shared=shared,
        source=source,
        x_dot_allowed=curve.x_dot_rounding,
        z_allowed=z_allowed,
        drift=k * drift,
        mismatch=mismatch,
        from_force=curve.x is None,
        v=law.v,
    )


def _noises(
    t: Floats, positions: Mapping[str, Floats], digits: Mapping[str, float], law: Law
) -> tuple[dict[str, float], bool]:
    """Return the noise of the positions [m] by column, and whether the columns share it.

    Coarse samples scatter for the motion as well. None of it is left in the difference of two
    positions, which has the noise of both, unless one was made from the other.
    """
    stick = law.relief / law.v if not math.isinf(law.t_slip) else 1.0 / law.w
    step = float(t[-1] - t[0]) / (t.size - 1)
    strides = [n for n in _STRIDES if n == 1 or 14.0 * n * step < stick]
    found = {name: noise_of(t, y, digits[name], strides) for name, y in positions.items()}
    if len(found) == 1:
        return found, False
    of_both = noise_of(t, positions["x"] - positions["F"], sum(digits.values()), strides)
    coarse = step * law.w >= COARSE
    shared = of_both <= (0.0 if coarse else _SHARED * min(found.values()))
    if coarse and not shared:
        found = {name: min(noise, of_both) for name, noise in found.items()}
        if not any(found.values()):
            # What rests to its digits has none.
            found = {
                name: 0.0 if _alike(y, digits[name], of_both) else of_both
                for name, y in positions.items()
            }
    return found, shared


def _alike(y: Floats, digits: float, noise: float) -> bool:
    """Tell whether neighbouring samples are alike more often than noise lets them be."""
    alike = float(np.mean(np.abs(np.diff(y[:_LOOKED_AT])) <= 2.0 * digits))
    by_chance = math.erf(digits / noise) if noise else 0.0
    return alike > 3.0 * by_chance + 0.02


def _compared(
    since: Floats, given: Floats, z: Floats, digits: float, noises: Mapping[str, float]
) -> tuple[float, str]:
    """Return how far F/k wanders off v t - x slowly [m], and why they contradict each other if so.

    A zero that drifts follows time; another stiffness follows the spring, a delay its rate.
    """
    stride = -(-since.size // _LOOKED_AT)
    t, given, z = since[::stride], given[::stride], z[::stride]
    # The spring's way as the column tells that has less noise: noise follows itself.
    way = given if noises["F"] < noises["x"] else z
    size = float(np.ptp(way)) or 1.0
    basis, _ = np.linalg.qr(np.polynomial.legendre.legvander(2.0 * t / t[-1] - 1.0, _DRIFTS))
    slow = basis @ (basis.T @ (given - z))
    apart = given - z - slow
    of_spring, of_rate = (s - basis @ (basis.T @ s) for s in (way, np.gradient(way, t)))
    early, sure_of_early, rest = _followed(apart, of_rate, 1e-6 * size / t[-1])
    share, sure, rms = _followed(apart, of_spring, 1e-6 * size)
    moved = abs(early) * math.sqrt(float(np.mean(of_rate**2)))
    if abs(early) > 2.0 * sure_of_early and moved > 4.0 * digits and rest < rms:
        return 0.0, (
            f"F is {'early' if early > 0.0 else 'late'} by about {time(abs(early))} against "
            "k (v t - x): a delay of one of them, or a filter"
        )
    if share:
        sure += min(noises.values()) ** 2 * t.size / float(of_spring @ of_spring)
    if abs(share) > _DRIFT * float(np.ptp(given)) / size + 16.0 * digits / size + 4.0 * sure:
        if abs(share + 2.0) < _OPPOSITE or abs(share - 2.0) < _OPPOSITE:
            return 0.0, "F is -k (v t - x) + const: it has the opposite sign"
        return 0.0, (
            "F is not k (v t - x) + const with the k and v given: "
            f"it is off by up to {0.5 * abs(share) * size / float(np.ptp(given)):.2g} of its range"
        )
    surely = 5.0 * rms * math.sqrt((_DRIFTS + 1) / t.size) + 4.0 * digits
    wander = float(np.ptp(slow))
    return (wander if wander > 2.0 * surely + 1e-6 * size else 0.0), ""


def _followed(apart: Floats, signal: Floats, least: float) -> tuple[float, float, float]:
    """Return the part of a signal in a difference, five deviations of it, and the rms of the rest.

    A signal of a smaller rms than `least` has no part.
    """
    power = float(signal @ signal)
    share = float(signal @ apart) / power if power > least**2 * apart.size else 0.0
    rms = math.sqrt(float(np.mean((apart - share * signal) ** 2)))
    return share, 5.0 * rms / math.sqrt(power) if share else 0.0, rms
