"""What the mass does at a pulling speed: which motions exist there, and where a start leads.

Three facts that do not depend on each other: the damping of steady sliding with the slope of the
friction there (docs/theory.md (29)), the existence of a cycle with a stick ((14), (22), (30)), and
the motion after a start from rest, which is integrated. Orbits of the mass on its spring do not
cross. So a mass that does not stick again swings or slides evenly from then on, and the swings
that others cannot be inside of are found from outside, by the start from rest, and from inside, by
a small deviation from steady sliding.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from .cycle import steady_cycle
from .dwell import LEAST_STICK, dwell_attractors, last_break_away
from .laws import COULOMB, FrictionLaw, friction_law
from .laws.coulomb import dwells
from .limits import critical_velocity
from .parameters import Parameters
from .ranges import EVEN, STICKS, SWINGS
from .simulation import simulate
from .trajectory import Trajectory

Floats = NDArray[np.float64]
Kind = Literal["even", "swings", "sticks"]

SETTLED: Final = 0.05
"""A motion has settled where its velocity stays this near to the pulling speed, relative."""

_BESIDE: Final = 1e-9
"""A range of speeds this narrow is one speed."""
_DEVIATION: Final = 0.02
"""Of the velocity from the pulling speed where a motion near steady sliding begins."""
_PERIODS, _SAMPLES, _WINDOWS = 8, 64, 30
"""Periods of the spring that are followed at a time, samples of each, and how often at most."""
_STEADY: Final = 1e-4
"""A swing is steady where its amplitude changes by less over a window, relative."""
_STILL: Final = 1e-3
"""A swing of a smaller amplitude, over the pulling speed, is steady sliding."""
_BAND: Final = 64
"""Speeds of a swing at which the slope of the friction is looked at."""
_CONSTANT: Final = 1e-6
"""A damping ratio that differs by less over the speeds of a swing is one."""


@dataclass(frozen=True)
class Swinging:
    """A motion that swings about the pulling speed and never stops.

    Attributes
    ----------
    amplitude : float
        Half of the difference between greatest and least velocity, over the pulling speed [-].
    frequency : float
        Swings per second [Hz].
    """

    amplitude: float
    frequency: float


@dataclass(frozen=True)
class StickSlip:
    """A cycle with a stick.

    Attributes
    ----------
    jump : float
        Displacement of the mass from one stick to the next [m]; NaN where it does not repeat.
    period : float
        From one break-away to the next [s]; NaN where it does not repeat.
    reverses : bool
        Whether the mass turns back between two sticks.
    """

    jump: float
    period: float
    reverses: bool = False


@dataclass(frozen=True)
class Regime:
    """What exists at a speed, and what a start from rest reaches.

    Attributes
    ----------
    speed : float
        The pulling speed, or the feed [m/s].
    damping, frequency : float
        Damping ratio [-] and frequency [Hz] of the least damped small swing about steady sliding,
        with the slope of the friction there. Steady sliding is stable where the ratio is >= 0.
    swings : tuple of Swinging
        The swings without a stop that were found.
    stick_slip : StickSlip or None
        The cycle with a stick; None where there is none.
    from_rest : str
        "even", "swings" or "sticks": where a start from rest with a relaxed spring leads.
    settling : float
        Time from the first break-away until the velocity stays within `SETTLED` of the speed [s];
        infinite where the start from rest does not end in even motion.
    """

    speed: float
    damping: float
    frequency: float
    swings: tuple[Swinging, ...]
    stick_slip: StickSlip | None
    from_rest: Kind
    settling: float

    @property
    def even(self) -> bool:
        """Whether even motion is stable."""
        return self.damping >= 0.0

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """The motions that exist: that of a start from rest first."""
        exist = {STICKS: self.stick_slip is not None, SWINGS: bool(self.swings), EVEN: self.even}
        beside: list[Kind] = [kind for kind in ("sticks", "swings", "even") if exist[kind]]
        return (self.from_rest, *(kind for kind in beside if kind != self.from_rest))

    @property
    def words(self) -> str:
        """What happens at the speed, in words: what a start from rest reaches first."""
        said = _NOW[self.kinds[0]].format(*self._numbers(self.kinds[0]))
        if self.stick_slip is not None and self.stick_slip.reverses and self.kinds[0] == "sticks":
            said += ", turning back"
        for kind in self.kinds[1:]:
            said += f"; {_BESIDE_IT[kind].format(*self._numbers(kind))}"
        return said

    def _numbers(self, kind: Kind) -> tuple[str, ...]:
        if kind != "swings":
            return ()
        percent = 100.0 * self.swings[0].amplitude
        return (f"{percent:.0f}" if percent >= 10.0 else f"{percent:.2g}",)


_NOW: Final[dict[Kind, str]] = {
    "even": "moves evenly",
    "swings": "swings by ± {} % of the speed, without a stop",
    "sticks": "sticks and slips",
}
_BESIDE_IT: Final[dict[Kind, str]] = {
    "even": "moves evenly after another start",
    "swings": "can swing by ± {} % of the speed after a bump",
    "sticks": "can stick and slip after a bump",
}


def regime(
    p: Parameters, law: FrictionLaw | str = COULOMB, own: Mapping[str, float] | None = None
) -> Regime:
    """Return what the mass does at the pulling speed ``|p.v|``.

    Parameters
    ----------
    p : Parameters
        Numbers only, ``v`` not 0; ``F_ext`` and the initial state are of no influence.
    law : FrictionLaw or str
        A friction law with a stick and without state, or its name.
    own : mapping of str to float, optional
        Values of the friction law's own parameters, beside those in ``p.own``.

    Raises
    ------
    ValueError
        If ``v`` is 0, the law has no stick, or as `critical_velocity` does.
    RuntimeError
        As `critical_velocity` does.
    """
    law = friction_law(law) if isinstance(law, str) else law
    if not law.sticks:
        raise ValueError(
            "regime needs a friction law with a stick; critical_velocity and memory_cycle take "
            "those without"
        )
    speed = abs(float(p.v))
    if speed == 0.0:
        raise ValueError("v = 0.0 m/s is out of range; what happens at a speed needs one")
    still = replace(p, v=speed, F_ext=0.0, x_start=0.0, x_dot_start=0.0)
    p = law.complete(still, {**p.own, **(own or {})})
    stick_slip, reached = _stick_slip(p, law)
    w = float(p.w)
    damping = (float(p.c) + law.slope(p, speed)) / (2.0 * float(p.m) * w)
    inner = None if damping >= 0.0 else _course(p, law, speed * (1.0 + _DEVIATION), _even(p, law))
    if not reached:
        ages = law.ages(p)
        start = last_break_away(p) if ages else law.break_away_force(p) / float(p.k)
        closed = law.constant_in_slip and p.zeta < 1.0
        outer = _slides_on(p, law, start) if closed else _course(p, law, 0.0, start)
    else:
        outer = _Course("sticks", None, math.inf)
    swings = [found.swing for found in (outer, inner) if found is not None and found.swing]
    if len(swings) == 2 and abs(swings[0].amplitude / swings[1].amplitude - 1.0) < 10.0 * _STILL:
        swings.pop()
    return Regime(
        speed=speed,
        damping=damping,
        frequency=w * math.sqrt(max(1.0 - damping * damping, 0.0)) / (2.0 * math.pi),
        swings=tuple(swings),
        stick_slip=stick_slip,
        from_rest=outer.kind,
        settling=outer.settling,
    )


def _stick_slip(p: Parameters, law: FrictionLaw) -> tuple[StickSlip | None, bool]:
    """Return a cycle with a stick, and whether a start from rest leads to it."""
    if law is COULOMB and dwells(p):
        found = dwell_attractors(p)
        if not found.attractors:
            return None, False
        chosen = found.from_rest or found.attractors[0]
        cycle = steady_cycle(p)
        alone = chosen is found.from_rest and cycle.exists
        jump, period = (cycle.delta_x, cycle.T) if alone else (math.nan, math.nan)
        return StickSlip(float(jump), float(period), chosen.reverses), found.from_rest is not None
    if law is COULOMB:
        cycle = steady_cycle(p)
        # Without a gap and without damping the mass only touches rest.
        if not cycle.exists or float(p.w * cycle.t_stick) < LEAST_STICK:
            return None, False
        return StickSlip(float(cycle.delta_x), float(cycle.T)), True
    speed = float(p.v)
    if not critical_velocity(p, law, between=(speed * (1.0 - _BESIDE), speed)).cycle:
        return None, False
    # Every slip from break-away is alike.
    start = law.break_away_force(p) / float(p.k)
    time = 4.0 * math.pi / float(p.w) + 2.0 * start / speed
    while True:
        run = _followed(p, law, 0.0, start, np.array([time]))
        broke = [event for event in run.events if event.kind == "break-away"]
        if len(broke) > 1:
            break
        time *= 2.0
    slips = [event for event in run.events if event.time < broke[1].time]
    reverses = any(event.kind == "reversal" for event in slips)
    return StickSlip(broke[1].x - broke[0].x, broke[1].time - broke[0].time, reverses), True


def _even(p: Parameters, law: FrictionLaw) -> float:
    """Return the extension of the spring in steady sliding [m]."""
    speed = float(p.v)
    return (law.slip_friction(p, speed) + float(p.c) * speed) / float(p.k)


def _followed(p: Parameters, law: FrictionLaw, x_dot: float, z: float, times: Floats) -> Trajectory:
    """Return the motion from a velocity [m/s] and an extension of the spring [m]."""
    start = replace(p, x_dot_start=x_dot, z_start=z)
    return simulate(start, float(times[-1]), times=times, law=law, own=p.own)


class _Course(NamedTuple):
    """Where a motion leads: its kind, the swing, and after which time it is even [s]."""

    kind: Kind
    swing: Swinging | None
    settling: float


def _slides_on(p: Parameters, law: FrictionLaw, z: float) -> _Course:
    """Return where the slip from rest leads that does not end, under friction that is constant.

    Its deviation from the pull is a linear swing from -1, of rate lambda; docs/theory.md (13).
    """
    w, zeta = float(p.w), float(p.zeta)
    lambda_ = w * (z - law.slip_friction(p, 0.0) / float(p.k)) / float(p.v)
    if zeta == 0.0:
        return _Course("swings", Swinging(math.hypot(1.0, lambda_), w / (2.0 * math.pi)), math.inf)
    return _Course("even", None, _settling(zeta, w, -1.0, lambda_))


def _settling(zeta: float, w: float, off: float, rate: float) -> float:
    """Return when a linear swing stays within `SETTLED` [s], from its deviation and rate over w.

    At the times t/w it is ``exp(-zeta t) ((rate + zeta off)/nu sin(nu t) + off cos(nu t))``.
    """
    nu = math.sqrt((1.0 - zeta) * (1.0 + zeta))
    across = (rate + zeta * off) / nu
    # After it no swing is off; before it the last one is.
    last = math.log(math.hypot(off, across) / SETTLED) / zeta
    t = np.linspace(max(0.0, last - 2.0 * math.pi / nu), last, 4 * _SAMPLES)
    beyond = np.exp(-zeta * t) * np.abs(across * np.sin(nu * t) + off * np.cos(nu * t)) > SETTLED
    return float(t[np.flatnonzero(beyond)[-1]]) / w if beyond.any() else 0.0


def _course(p: Parameters, law: FrictionLaw, x_dot: float, z: float) -> _Course:
    """Follow a motion from a velocity [m/s] and an extension of the spring [m]."""
    speed, w = float(p.v), float(p.w)
    window = _PERIODS * 2.0 * math.pi / w
    times = np.linspace(0.0, window, _PERIODS * _SAMPLES + 1)
    passed, last_off, amplitude = 0.0, 0.0, math.inf
    for _ in range(_WINDOWS):
        run = _followed(p, law, x_dot, z, times)
        if any(event.kind == "re-stick" for event in run.events):
            return _Course("sticks", None, math.inf)
        relative = run.x_dot / speed - 1.0
        off = np.flatnonzero(np.abs(relative) > SETTLED)
        if off.size:
            last_off = passed + float(times[min(off[-1] + 1, times.size - 1)])
        passed += window
        x_dot, z = float(run.x_dot[-1]), float(run.z[-1])
        before, amplitude = amplitude, _amplitude(relative)
        zeta = _damping_within(p, law, float(np.max(np.abs(relative[-2 * _SAMPLES :]))))
        if zeta is not None and 0.0 < zeta < 1.0:
            # From here on it is linear.
            force = float(p.k) * z - law.slip_friction(p, x_dot) - float(p.c) * x_dot
            left = _settling(zeta, w, x_dot / speed - 1.0, force / (float(p.m) * w * speed))
            return _Course("even", None, passed + left if left else last_off)
        if amplitude < _STILL or (amplitude < SETTLED and _decays(p, law, amplitude)):
            return _Course("even", None, last_off)
        if abs(amplitude / before - 1.0) < _STEADY and not _decays(p, law, amplitude):
            return _Course("swings", Swinging(amplitude, _frequency(times, relative)), math.inf)
    if amplitude > (1.0 + _STEADY) * before:
        # It grows so slowly that its end is not seen: that of a start from rest is known.
        return _Course("sticks", None, math.inf)
    ends = None if _decays(p, law, amplitude) else _fades_to(p, law, amplitude, times)
    if ends is None:
        rate = -math.log(amplitude / before) / window
        left = math.log(amplitude / SETTLED) / rate if rate > 0.0 else math.inf
        return _Course("even", None, passed + max(left, 0.0))
    return _Course("swings", Swinging(ends, _frequency(times, relative)), math.inf)


def _fades_to(p: Parameters, law: FrictionLaw, amplitude: float, times: Floats) -> float | None:
    """Return the amplitude at which a swing that fades slowly no longer does; None: it dies."""

    def growth(logarithm: float) -> float:
        x_dot = float(p.v) * (1.0 + math.exp(logarithm))
        relative = _followed(p, law, x_dot, _even(p, law), times).x_dot / float(p.v) - 1.0
        return math.log(_amplitude(relative) / _amplitude(relative[: 2 * _SAMPLES]))

    high = math.log(min(amplitude, 1.0 - _DEVIATION))
    low = high
    while growth(low) <= 0.0:
        high, low = low, low - math.log(2.0)
        if low < math.log(_STILL):
            return None
    if low == high:
        return amplitude
    return math.exp(float(brentq(growth, low, high, xtol=_STEADY)))


def _slopes(p: Parameters, law: FrictionLaw, amplitude: float) -> Floats:
    """Return c and the slope of the friction at the speeds of a swing of this amplitude [N.s/m]."""
    speed = float(p.v)
    looks = np.linspace(speed * (1.0 - amplitude), speed * (1.0 + amplitude), _BAND)
    knots = [knot for knot in law.knots(p) if looks[0] < knot < looks[-1]]
    looks = np.union1d(looks, knots)
    return np.asarray(float(p.c) + np.diff(law.friction_at(p, looks)) / np.diff(looks))


def _decays(p: Parameters, law: FrictionLaw, amplitude: float) -> bool:
    """Return whether a swing of this amplitude meets damping at all of its speeds."""
    return amplitude < 1.0 and bool(np.all(_slopes(p, law, amplitude) >= 0.0))


def _damping_within(p: Parameters, law: FrictionLaw, amplitude: float) -> float | None:
    """Return the damping ratio at speeds off by this amplitude; None where it is no constant."""
    if not 0.0 < amplitude < 1.0:
        return None
    ratios = _slopes(p, law, amplitude) / (2.0 * float(p.m) * float(p.w))
    return float(np.mean(ratios)) if np.ptp(ratios) < _CONSTANT else None


def _amplitude(relative: Floats) -> float:
    """Return half of the height of the last swing in a window, its extremes by parabolas."""
    last = relative[-2 * _SAMPLES :]
    return 0.5 * (_greatest(last) + _greatest(-last))


def _greatest(values: Floats) -> float:
    at = int(np.argmax(values))
    if not 0 < at < values.size - 1:
        return float(values[at])
    before, there, after = (float(value) for value in values[at - 1 : at + 2])
    curved = 2.0 * there - before - after
    return there + (after - before) ** 2 / (8.0 * curved) if curved > 0.0 else there


def _frequency(
    times: Floats,
    relative: Floats,
) -> float:
    """Return how often a second the velocity rises through the pulling speed [Hz]."""
    at = np.flatnonzero((relative[:-1] < 0.0) & (relative[1:] >= 0.0))
    if at.size < 2:
        return 0.0
    part = relative[at] / (relative[at] - relative[at + 1])
    crossings = times[at] + part * (times[at + 1] - times[at])
    return float((at.size - 1) / (crossings[-1] - crossings[0]))
