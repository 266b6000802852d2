"""Stick and slip as arcs: where one began, its coefficients, when it ends.

An arc is made once, at an event or at a change of input or parameter, and then only read: at any
elapsed time `tau` it gives the state in closed form, so its end and its quantities do not depend
on the steps that cut it. docs/theory.md (3), (5), (8).
"""

import math
from typing import Tuple

from .oscillator import Oscillator
from .quadrature import integral
from .roots import falling_zero

_TURN = 2.0 * math.pi

# The heat of damping has a closed form, of differences that cancel while the motion has hardly
# begun. Up to this multiple of the shortest time, and in heavy damping up to this fraction of
# the longest one, it is integrated instead.
_SHORT = 4.0
_EARLY = 1e-2


class StickArc:
    """The mass rests while the pulled end loads the spring.

    Parameters
    ----------
    k
        Stiffness [N/m].
    v
        Pulling velocity [m/s].
    z
        Spring extension at the start [m].
    breakaway
        Break-away force F_s [N].
    external
        External force F_ext [N].
    """

    __slots__ = ("duration", "k", "mode", "v", "x_dot_start", "z_end", "z_start")

    def __init__(self, k: float, v: float, z: float, breakaway: float, external: float) -> None:
        self.mode = 0
        self.x_dot_start = 0.0
        self.k = k
        self.v = v
        self.z_start = z
        if v == 0.0:
            self.z_end = z
            self.duration = math.inf
        else:
            # A rest that rounding put beyond the threshold breaks away at once.
            self.z_end = (math.copysign(breakaway, v) - external) / k
            self.duration = max((self.z_end - z) / v, 0.0)

    def state(self, tau: float) -> Tuple[float, float, float]:
        """Return spring extension, velocity and displacement of the mass at `tau`."""
        return self.z_start + self.v * tau, 0.0, 0.0

    def end(self) -> Tuple[float, float, float]:
        """Return spring extension, velocity and displacement of the mass at the end."""
        return self.z_end, 0.0, 0.0

    def extreme_velocity(self, tau: float) -> float:
        """Return the velocity of largest magnitude up to `tau`: none."""
        return 0.0

    def pull_work(self, tau: float, z: float, x_dot: float) -> float:
        """Return the work of the pulling end up to `tau`, with its state [J]: (15)."""
        return self.k * (self.v * tau) * (self.z_start + 0.5 * self.v * tau)

    def heat(self, tau: float, z: float, displacement: float) -> float:
        """Return the heat of friction and damping up to `tau` [J]: none."""
        return 0.0


class SlipArc:
    """The mass slips one way under a constant kinetic friction.

    Parameters
    ----------
    oscillator
        Mass, spring and damping.
    v
        Pulling velocity [m/s].
    z, x_dot
        Spring extension [m] and velocity of the mass [m/s] at the start.
    mode
        +1 forward, -1 backward; `x_dot` is zero or of this sign.
    net
        Force on the mass at the start but for the damping, k z + F_ext - mode mu_k N [N].
    kinetic
        Kinetic friction mu_k N [N].
    """

    __slots__ = (
        "_fade",
        "_from_rest",
        "_kinetic",
        "_oscillator",
        "_peak_time",
        "_u",
        "_z_dot",
        "duration",
        "mode",
        "q",
        "v",
        "x_dot_start",
        "z_start",
    )

    def __init__(
        self,
        oscillator: Oscillator,
        v: float,
        z: float,
        x_dot: float,
        mode: int,
        net: float,
        kinetic: float,
    ) -> None:
        self._oscillator = oscillator
        self._kinetic = kinetic
        self.v = v
        self.mode = mode
        self.z_start = z
        self.x_dot_start = x_dot
        self._z_dot = v - x_dot
        # Acceleration of the mass, and distance of the spring from the centre of the swing.
        self.q = (net - oscillator.c * x_dot) / oscillator.m
        self._u = (net - oscillator.c * v) / oscillator.k
        # Factor of the impulse response in the acceleration.
        self._fade = oscillator.w2 * self._z_dot - 2.0 * oscillator.a * self.q
        # An undamped slip from rest to rest has its own closed form.
        self._from_rest = x_dot == 0.0 and oscillator.c == 0.0
        self._peak_time = math.inf
        self.duration = self._find_end()

    def state(self, tau: float) -> Tuple[float, float, float]:
        """Return spring extension, velocity and displacement of the mass at `tau`."""
        step, impulse = self._oscillator.responses(tau)
        growth = self._z_dot * impulse - self._u * step
        x_dot = self.x_dot_start + self._z_dot * step + self.q * impulse
        if x_dot * self.mode < 0.0:
            # Rounding beside an end of the slip; the motion itself never turns.
            x_dot = 0.0
        return self.z_start + growth, x_dot, self.v * tau - growth

    def end(self) -> Tuple[float, float, float]:
        """Return spring extension, velocity and displacement of the mass at the end."""
        if self._from_rest:
            relief = 2.0 * self._u
            return self.z_start - relief, 0.0, self.v * self.duration + relief
        z, _, displacement = self.state(self.duration)
        return z, 0.0, displacement

    def extreme_velocity(self, tau: float) -> float:
        """Return the velocity of largest magnitude up to `tau` [m/s]: (11).

        Of all maxima the first is the highest, for damping only takes from them.
        """
        candidates = [self.x_dot_start, self.state(tau)[1]]
        if self._peak_time < tau:
            candidates.append(self.state(self._peak_time)[1])
        return max(candidates, key=abs)

    def pull_work(self, tau: float, z: float, x_dot: float) -> float:
        """Return the work of the pulling end up to `tau`, with its state [J]: (15).

        The spring's impulse follows from the momentum of the mass and its damping.
        """
        oscillator = self._oscillator
        impulse = (
            oscillator.k * (self.z_start - self._u) * tau
            + oscillator.m * (x_dot - self.x_dot_start)
            - oscillator.c * (z - self.z_start)
        )
        return self.v * impulse

    def heat(self, tau: float, z: float, displacement: float) -> float:
        """Return the heat of friction and damping up to `tau`, with its state [J]: (15)."""
        heat = self._kinetic * abs(displacement)
        if self._oscillator.c > 0.0:
            heat += self._oscillator.c * self._squared_velocity(tau, displacement)
        return heat

    def _squared_velocity(self, tau: float, displacement: float) -> float:
        """Return the integral of x_dot^2 up to `tau` [m2/s]: (15)."""
        oscillator = self._oscillator
        end = _SHORT / max(oscillator.w, oscillator.fast)
        if tau <= end:
            return integral(self._velocity_squared, 0.0, tau)
        if oscillator.slow * tau < _EARLY and oscillator.overdamped:
            total = integral(self._velocity_squared, 0.0, end)
            while end < tau:
                start, end = end, min(2.0 * end, tau)
                total += integral(self._velocity_squared, start, end)
            return total
        x_dot, z_dot, q = self.x_dot_start, self._z_dot, self.q
        of_step, of_impulse = oscillator.integrals(tau)
        step = oscillator.responses(tau)[0]
        return (
            x_dot * (2.0 * displacement - x_dot * tau)
            + z_dot * (z_dot * of_step + q * step * step / oscillator.w2)
            + q * q * of_impulse
        )

    def _velocity_squared(self, tau: float) -> float:
        step, impulse = self._oscillator.responses(tau)
        x_dot = self.x_dot_start + self._z_dot * step + self.q * impulse
        return x_dot * x_dot

    def _find_end(self) -> float:
        """Return when the mass first comes to rest, or infinity: (5)."""
        oscillator = self._oscillator
        if self.x_dot_start == 0.0 and self.mode * self.q < 0.0:
            return 0.0
        if oscillator.overdamped:
            low, high = self._enclose_decaying()
        else:
            low, high = self._enclose_swinging()
        if self._from_rest:
            mode = self.mode
            angle = math.atan2(oscillator.w * (mode * self._u), mode * self.v)
            return (_TURN - 2.0 * angle) / oscillator.w
        if high == math.inf or self._speed(high)[0] > 0.0:
            return math.inf
        return falling_zero(self._speed, low, high)

    def _speed(self, tau: float) -> Tuple[float, float]:
        """Return the speed along the slip and its slope at `tau`."""
        step, impulse = self._oscillator.responses(tau)
        x_dot = self.x_dot_start + self._z_dot * step + self.q * impulse
        x_ddot = self.q * (1.0 - step) + self._fade * impulse
        return self.mode * x_dot, self.mode * x_ddot

    def _enclose_swinging(self) -> Tuple[float, float]:
        """Return the interval in which the speed falls to its first minimum, for a < w.

        The acceleration is a damped sine: it first turns from falling to rising speed a
        quarter turn before the phase of its own maximum.
        """
        a, b = self._oscillator.a, self._oscillator.b
        phase = math.atan2(self.mode * (self._fade + a * self.q), self.mode * self.q * b)
        lowest = phase - 0.5 * math.pi
        if lowest <= 0.0:
            lowest += _TURN
        highest = lowest - math.pi
        if highest < 0.0:
            # The speed falls from the start, so the maximum that counts lies behind the minimum.
            self._peak_time = (highest + _TURN) / b
            return 0.0, lowest / b
        self._peak_time = highest / b
        return self._peak_time, lowest / b

    def _enclose_decaying(self) -> Tuple[float, float]:
        """Return an interval in which the speed falls through zero, for a >= w.

        There is one extreme at most, and the speed ends at that of the pulling end.
        """
        oscillator = self._oscillator
        rising = self.mode * self.q > 0.0 or (self.q == 0.0 and self.mode * self._fade > 0.0)
        turn = self._turning_time()
        if rising:
            self._peak_time = turn
            low = turn
        elif turn < math.inf:
            return 0.0, turn
        else:
            low = 0.0
        if low == math.inf or self.mode * self.v >= 0.0:
            return 0.0, math.inf
        reach = 1.0 / oscillator.w
        while self._speed(low + reach)[0] > 0.0:
            reach *= 2.0
        return low, low + reach

    def _turning_time(self) -> float:
        """Return when the acceleration changes sign, or infinity, for a >= w."""
        a, b = self._oscillator.a, self._oscillator.b
        of_sine = self._fade + a * self.q
        if of_sine == 0.0 or self.q == 0.0:
            return math.inf
        ratio = -self.q / of_sine
        if ratio < 0.0 or ratio * b >= 1.0:
            return math.inf
        return math.atanh(ratio * b) / b if b > 0.0 else ratio
