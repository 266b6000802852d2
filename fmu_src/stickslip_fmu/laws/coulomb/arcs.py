"""Slip under constant kinetic friction, in closed form: docs/theory.md (3), (5), (8)."""

import math
from typing import Tuple

from ...numerics.quadrature import integral
from ...numerics.roots import falling_zero
from ..law import Motion, Start
from .oscillator import Oscillator

_TURN = 2.0 * math.pi

# The heat of damping has a closed form, of differences that cancel while the motion has hardly
# begun. Up to this multiple of the shortest time, and in heavy damping up to this fraction of
# the longest one, it is integrated instead.
_SHORT = 4.0
_EARLY = 1e-2


class SlipArc:
    """The mass slips one way under a constant kinetic friction.

    With the responses G, K of the `Oscillator`, the integral H of G, and the net force R:

    ``x_dot = x_dot_start K' + v G + R/m K``
    ``x - x_start = x_dot_start K + v H + R/k G``
    ``z - z_start = (v - x_dot_start) K - (R - c v)/k G``

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
        R, the force on the mass at the start but for the damping: k z + F_ext - mode mu_k N [N].
    kinetic
        Kinetic friction mu_k N [N].
    """

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
        self._net = net
        self.v = v
        self.mode = mode
        self.z_start = z
        self.x_dot_start = x_dot
        self._z_dot = v - x_dot
        self._push = net / oscillator.m
        self._acceleration = (net - oscillator.c * x_dot) / oscillator.m
        self._reach = net / oscillator.k
        # Distance of the spring from the centre of its swing.
        self._swing = (net - oscillator.c * v) / oscillator.k
        # Factor of K in the acceleration, whose factor of K' is that at the start.
        self._fade = oscillator.w2 * self._z_dot
        # An undamped slip from rest to rest has its own closed form.
        self._from_rest = x_dot == 0.0 and oscillator.c == 0.0 and mode * self._acceleration >= 0.0
        self._peak_time = math.inf
        self.duration = self._find_end()

    age = 0.0

    @property
    def start(self) -> Start:
        """Where the arc starts."""
        return Start(self.mode, self.z_start, self.x_dot_start, self._net)

    def state(self, tau: float) -> Motion:
        """Return the motion at `tau`."""
        oscillator = self._oscillator
        step, impulse, slope = oscillator.responses(tau)
        start, v = self.x_dot_start, self.v
        x_dot = start * slope + v * step + self._push * impulse
        if x_dot * self.mode < 0.0:
            # Rounding beside an end of the slip; the motion itself never turns.
            x_dot = 0.0
        integral_of_step = oscillator.step_integral(tau, step, impulse)
        displacement = start * impulse + v * integral_of_step + self._reach * step
        friction = -(self.mode * self._kinetic + oscillator.c * x_dot)
        return self._z_dot * impulse - self._swing * step, x_dot, displacement, friction

    def end(self) -> Motion:
        """Return the motion at the end of the slip, where the velocity is 0."""
        growth, _, displacement, friction = self.state(self.duration)
        if self._from_rest:
            growth = -2.0 * self._swing
            if self.mode * self.v > 0.0:
                displacement = self.v * self.duration - growth
        return growth, 0.0, displacement, friction

    def own(self, tau: float) -> Tuple[float, ...]:
        """Return the law's own state: none."""
        return ()

    def way_to_break_away(self, gap: float) -> float:
        """Return what the force lacks of F_s at the end, in the direction of the slip [N].

        Known from the acceleration at the stop without the difference of two large forces.

        Parameters
        ----------
        gap
            Break-away force less kinetic friction [N].
        """
        if self._from_rest:
            return gap + self.mode * self._net
        _, impulse, slope = self._oscillator.responses(self.duration)
        acceleration = self._acceleration * slope + self._fade * impulse
        return gap - self.mode * self._oscillator.m * acceleration

    def extreme_velocity(self, tau: float) -> float:
        """Return the velocity of largest magnitude up to `tau` [m/s]: (11).

        Of all maxima the first is the highest, for damping only takes from them.
        """
        candidates = [self.x_dot_start, self.state(tau)[1]]
        if self._peak_time < tau:
            candidates.append(self.state(self._peak_time)[1])
        return max(candidates, key=abs)

    def pull_work(self, tau: float) -> float:
        """Return the work of the pulling end up to `tau` [J]: (15)."""
        oscillator = self._oscillator
        step, impulse, _ = oscillator.responses(tau)
        integral_of_step = oscillator.step_integral(tau, step, impulse)
        growth = self._z_dot * step / oscillator.w2 - self._swing * integral_of_step
        return oscillator.k * self.v * (self.z_start * tau + growth)

    def heat(self, tau: float, displacement: float) -> float:
        """Return the heat of friction and damping up to `tau` [J]: (15)."""
        heat = self._kinetic * abs(displacement)
        if self._oscillator.c > 0.0:
            heat += self._oscillator.c * self._squared_velocity(tau, displacement)
        return heat

    def _squared_velocity(self, tau: float, displacement: float) -> float:
        """Return the integral of x_dot^2 up to `tau` [m2/s]: (15)."""
        oscillator = self._oscillator
        end = _SHORT / oscillator.quickest
        if tau <= end:
            return integral(self._velocity_squared, 0.0, tau)
        if oscillator.overdamped and oscillator.slow * tau < _EARLY:
            total = integral(self._velocity_squared, 0.0, end)
            while end < tau:
                start, end = end, min(2.0 * end, tau)
                total += integral(self._velocity_squared, start, end)
            return total
        v, z_dot, acceleration = self.v, self._z_dot, self._acceleration
        of_rest, of_impulse = oscillator.squares(tau)
        step, _, _ = oscillator.responses(tau)
        mixed = step * (2.0 - step) / oscillator.w2
        return (
            v * (2.0 * displacement - v * tau)
            + z_dot * (z_dot * of_rest - acceleration * mixed)
            + acceleration * acceleration * of_impulse
        )

    def _velocity_squared(self, tau: float) -> float:
        x_dot = self._speed(tau)[0]
        return x_dot * x_dot

    def _speed(self, tau: float) -> Tuple[float, float]:
        """Return the speed along the slip and its slope at `tau`."""
        step, impulse, slope = self._oscillator.responses(tau)
        x_dot = self.x_dot_start * slope + self.v * step + self._push * impulse
        x_ddot = self._acceleration * slope + self._fade * impulse
        return self.mode * x_dot, self.mode * x_ddot

    def _find_end(self) -> float:
        """Return when the mass first comes to rest, or infinity: (5)."""
        oscillator = self._oscillator
        if self.x_dot_start == 0.0 and self.mode * self._acceleration < 0.0:
            return 0.0
        if oscillator.overdamped:
            low, high = self._enclose_decaying()
        else:
            low, high = self._enclose_swinging()
        if self._from_rest:
            reach = oscillator.w * abs(self._swing)
            return 2.0 * math.atan2(reach, -self.mode * self.v) / oscillator.w
        if high == math.inf or self._speed(high)[0] > 0.0:
            return math.inf
        return falling_zero(self._speed, low, high)

    def _enclose_swinging(self) -> Tuple[float, float]:
        """Return the interval in which the speed falls to its first minimum, for a < w.

        The acceleration is a damped sine: it first turns from falling to rising speed a
        quarter turn before the phase of its own maximum.
        """
        a, b = self._oscillator.a, self._oscillator.b
        of_sine = self._fade - a * self._acceleration
        phase = math.atan2(self.mode * of_sine, self.mode * self._acceleration * b)
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
        acceleration = self.mode * self._acceleration
        turn = self._turning_time()
        if acceleration > 0.0 or (acceleration == 0.0 and self.mode * self._fade > 0.0):
            self._peak_time = turn
            low = turn
        elif turn < math.inf:
            return 0.0, turn
        else:
            low = 0.0
        if low == math.inf or self.mode * self.v >= 0.0:
            return 0.0, math.inf
        reach = 1.0 / self._oscillator.w
        while low + reach < math.inf and self._speed(low + reach)[0] > 0.0:
            reach *= 2.0
        return low, low + reach

    def _turning_time(self) -> float:
        """Return when the acceleration changes sign, or infinity, for a >= w: (5)."""
        oscillator = self._oscillator
        slow, fast, apart = oscillator.slow, oscillator.fast, 2.0 * oscillator.b
        lead = slow * (self._push - slow * self.x_dot_start - fast * self.v)
        if lead == 0.0:
            return math.inf
        ratio = self._acceleration / lead
        if ratio <= 0.0:
            return math.inf
        return math.log1p(apart * ratio) / apart if apart > 0.0 else ratio
