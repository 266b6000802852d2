"""The motion of the drive's inertia under one command, against spring, lag and dry friction.

Between two commands everything but the dry friction is linear. The speed is a Taylor series; what
the motor's force is off its command decays exponentially, and the inertia's answer to it is the
same series, summed over the moments of an exponential. Dry friction changes its sign, or holds,
where the speed passes 0: these instants are located.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from operator import mul
from typing import NamedTuple

# Terms of the Taylor series of a speed, and how long a sample may be for them, in units of 1 / r
# (`objection`). Since |v^(n)| <= C r^(n-1), with C the larger of |v'| and |v''| / r, what is left
# out over a time h is below C h (r h)^12 / 13! / (1 - r h / 14) = 4.1e-14 C h at r h = 0.5.
_TERMS = 12
_LONGEST = 0.5
# An instant is located to this, relative to the time in which it is sought.
_CLOSE = 1e-13
# Halvings suffice to get there.
_MOST = 60


def inertia_at_slide(J: float, pitch: float) -> float:
    """Return the inertia [kg] that J [kg.m2] is at the slide, with `pitch` [m] a turn.

    It is J (2 pi / pitch)^2, docs/feed-axis.md (1); 0 or infinity where no double holds it.
    """
    per_metre = 2.0 * math.pi / pitch
    return J * per_metre * per_metre


def objection(m_d: float, d: float, k: float, T_s: float) -> str | None:
    """Return why the motion cannot be told over a sample, with name, value and range; else None.

    Parameters
    ----------
    m_d, d, k
        As of `Inertia`.
    T_s
        Sample time [s].

    Notes
    -----
    Between samples m_d v'' + d v' + k v is constant, so from one derivative to the next v grows
    by r = delta + sqrt(delta^2 + k/m_d) at most, with delta = d / (2 m_d): the root of
    r^2 = 2 delta r + k/m_d. The lag of the motor's force does not matter.
    """
    if not 0.0 < m_d < math.inf:
        return f"m_d = {m_d!r} kg is out of range: J (2 pi / pitch)^2 must be finite, above 0"
    delta = 0.5 * d / m_d
    r = delta + math.hypot(delta, math.sqrt(k / m_d))
    if r * T_s <= _LONGEST:
        return None
    return (
        f"T_s = {T_s!r} s is out of range: it must be at most {_LONGEST / r:.3g} s "
        f"with k = {k:g} N/m, d = {d:g} N.s/m and m_d = {m_d:.4g} kg"
    )


class Place(NamedTuple):
    """Where the inertia is: position [m], speed [m/s], and the force that the motor has [N]."""

    x: float
    v: float
    F_motor: float


class Pull(NamedTuple):
    """What acts on it.

    Attributes
    ----------
    command
        The force that the motor's tends to [N].
    at_zero
        The spring force that belongs to position 0 [N], at the beginning.
    speed
        Speed of the spring's other end [m/s].
    """

    command: float
    at_zero: float
    speed: float


class Inertia:
    """Solves m_d v' = F_motor - F - d v - dry friction, and lag F_motor' = command - F_motor.

    Parameters
    ----------
    m_d
        Inertia of the drive, seen at the slide [kg].
    d
        Viscous friction of motor and nut [N.s/m].
    k
        Stiffness of the spring [N/m].
    lag
        Time constant of the motor's force [s]; 0: it is the command.
    dry
        Dry friction of motor and nut [N], static as kinetic.
    """

    def __init__(self, m_d: float, d: float, k: float, lag: float, dry: float) -> None:
        self._m_d, self._d, self._k, self._lag, self._dry = m_d, d, k, lag, dry
        # The Taylor coefficients of the speed after a push of 1 N.s, times m_d.
        answer = [1.0, -d / m_d]
        while len(answer) < _TERMS:
            answer.append(-(k * answer[-2] + d * answer[-1]) / m_d)
        self._answer = answer

    def moved(self, h: float, place: Place, pull: Pull) -> Place:
        """Return the place after h [s], a sample at most."""
        if self._dry <= 0.0:
            return self._free(h, place, pull, 0.0)
        direction = 0.0
        while h > 0.0:
            if place.v != 0.0:
                direction = math.copysign(1.0, place.v)
            elif direction == 0.0:
                t, direction = self._break_away(h, place, pull)
                F_motor = self._decayed(t, place.F_motor, pull.command)
                place = place._replace(F_motor=F_motor)
                h, pull = h - t, self._later(t, pull)
                continue
            friction = direction * self._dry
            end = self._free(h, place, pull, friction)
            t = self._standstill(h, place, end, pull, friction)
            if t > h:
                return end
            place = self._free(t, place, pull, friction)._replace(v=0.0)
            h, pull, direction = h - t, self._later(t, pull), 0.0
        return place

    def _free(self, h: float, place: Place, pull: Pull, friction: float) -> Place:
        """Return the place after h [s] under a constant friction [N]."""
        x, v, F_motor = place
        force = pull.command - friction - pull.at_zero - self._k * x - self._d * v
        derivative = force / self._m_d
        following = (self._k * (pull.speed - v) - self._d * derivative) / self._m_d
        x = x + h * v
        power = h
        for order in range(2, _TERMS + 2):
            v += power * derivative
            power *= h / order
            x += power * derivative
            derivative, following = (
                following,
                -(self._k * derivative + self._d * following) / self._m_d,
            )
        if self._lag <= 0.0:
            return Place(x, v, pull.command)
        moments = self._moments(h)
        off = (F_motor - pull.command) / self._m_d
        v += off * sum(map(mul, self._answer, moments))
        x += off * sum(map(mul, self._answer, moments[1:]))
        return Place(x, v, self._decayed(h, F_motor, pull.command))

    def _moments(self, h: float) -> list[float]:
        """Return the integrals of (h - s)^n / n! exp(-s / lag) over s from 0 to h, n to `_TERMS`.

        Each follows from the one before or after it, E[n] = lag (h^n / n! - E[n-1]), in the
        direction in which errors shrink.
        """
        lag = self._lag
        powers = [1.0]
        for n in range(1, _TERMS + 1):
            powers.append(powers[-1] * h / n)
        if h > lag:
            moments = [-lag * math.expm1(-h / lag)]
            for power in powers[1:]:
                moments.append(lag * (power - moments[-1]))
            return moments
        # Terms fall by a 14th and less: after 12 of them rounding is reached.
        term = last = powers[-1] * h / (_TERMS + 1)
        for n in range(_TERMS + 2, 2 * _TERMS + 2):
            term *= -h / (lag * n)
            last += term
        moments = [last]
        for power in reversed(powers):
            moments.append(power - moments[-1] / lag)
        # The last one is exp(-h / lag).
        return moments[-2::-1]

    def _decayed(self, t: float, F_motor: float, command: float) -> float:
        """Return the motor's force [N] after a time [s]."""
        if self._lag <= 0.0:
            return command
        return command + (F_motor - command) * math.exp(-t / self._lag)

    def _later(self, t: float, pull: Pull) -> Pull:
        """Return what acts after a time [s]: the spring's other end has gone on."""
        return pull._replace(at_zero=pull.at_zero - self._k * pull.speed * t)

    def _break_away(self, h: float, place: Place, pull: Pull) -> tuple[float, float]:
        """Return when within h [s] it moves off from rest, and in which direction.

        If it does not: h and 0. The motor's force tends to the command, and the spring's grows
        evenly: what pushes rises, or falls, up to one instant, and the other way after it.
        """
        growth = self._k * pull.speed
        off = place.F_motor - pull.command

        def push(t: float) -> tuple[float, float]:
            left = self._decayed(t, place.F_motor, pull.command) - pull.command
            slope = growth - (left / self._lag if self._lag > 0.0 else 0.0)
            return pull.command + left - pull.at_zero - self._k * place.x + growth * t, slope

        ends = [0.0, h]
        if self._lag > 0.0 and off * growth > 0.0:
            ratio = math.log(abs(off)) - math.log(abs(growth)) - math.log(self._lag)
            if 0.0 < self._lag * ratio < h:
                ends.insert(1, self._lag * ratio)
        start = 0.0
        for end in ends:
            reached, _ = push(end)
            if abs(reached) > self._dry:
                sign = math.copysign(1.0, reached)

                def held(t: float, sign: float = sign) -> tuple[float, float]:
                    force, slope = push(t)
                    return self._dry - sign * force, -sign * slope

                return _zero(held, start, end), sign
            start = end
        return h, 0.0

    def _standstill(self, h: float, place: Place, end: Place, pull: Pull, friction: float) -> float:
        """Return when within h [s], which end at `end`, the speed passes 0; else infinity."""
        sign = math.copysign(1.0, friction)

        def speed(t: float) -> tuple[float, float]:
            there = self._free(t, place, pull, friction)
            return sign * there.v, sign * self._slopes(there, self._later(t, pull), friction)[0]

        def fall(t: float) -> tuple[float, float]:
            there = self._free(t, place, pull, friction)
            first, second = self._slopes(there, self._later(t, pull), friction)
            return -sign * first, -sign * second

        high = h
        if sign * end.v > 0.0:
            first, _ = self._slopes(place, pull, friction)
            last, _ = self._slopes(end, self._later(h, pull), friction)
            if place.v == 0.0 or not sign * first < 0.0 < sign * last:
                return math.inf
            # It may fall below 0 and come back.
            high = _zero(fall, 0.0, h)
            if speed(high)[0] > 0.0:
                return math.inf
        low = 0.0
        if place.v == 0.0:
            # Off from rest it is above 0 at first.
            low = 0.5 * high
            while speed(low)[0] <= 0.0:
                low, high = 0.5 * low, low
                if low <= _CLOSE * h:
                    return h
        return _zero(speed, low, high)

    def _slopes(self, place: Place, pull: Pull, friction: float) -> tuple[float, float]:
        """Return the first two derivatives of the speed at a place."""
        x, v, F_motor = place
        first = (F_motor - friction - pull.at_zero - self._k * x - self._d * v) / self._m_d
        rise = (pull.command - F_motor) / self._lag if self._lag > 0.0 else 0.0
        return first, (rise + self._k * (pull.speed - v) - self._d * first) / self._m_d


def _zero(of: Callable[[float], tuple[float, float]], low: float, high: float) -> float:
    """Return where a value falls to 0 between two times [s], by Newton's steps or halves."""
    close = _CLOSE * high
    t = high
    for _ in range(_MOST):
        value, slope = of(t)
        if value > 0.0:
            low = t
        else:
            high = t
        if high - low <= close:
            break
        following = t - value / slope if slope < 0.0 else low
        if abs(following - t) <= close:
            # The root is this close: take its far side.
            return min(high, t + close)
        t = following if low < following < high else 0.5 * (low + high)
    return high
