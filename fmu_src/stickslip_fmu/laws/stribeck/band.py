"""Slip while the speed stays in a band where friction is a straight line, in closed form.

In the direction of the slip the friction at the speed u is ``intercept + slope u`` [N], so the
equation of slip is Coulomb's with that intercept for the kinetic friction and with the damping
``c + slope``, which may be negative: docs/theory.md (3). Between two extremes the speed is
monotone, so the first time at which it reaches an end of the band is enclosed. With
``rho = u - s v`` the extremes of a swing are ``pi/b`` apart, and rho there grows by
``-exp(-a pi/b)`` from one to the next. A growing motion that swings many times before it leaves is
taken to its last turns by the logarithm of what it lacks.
"""

import math
import sys
from typing import Iterator, NamedTuple, Tuple

from ...numerics.quadrature import integral
from ...numerics.roots import falling_zero
from ..coulomb.arcs import SlipArc
from ..coulomb.oscillator import Oscillator
from ..law import Motion, Start

# Panels of the quadrature hold a growth or decay by exp(4) at most, at most so many of them.
_PANEL = 4.0
_MOST_PANELS = 256
# A motion that would need a growth by exp(600) to move has no digit of one.
_MOST_GROWTH = 600.0
# A speed that passes the end of a band by rounding alone stays in the band.
_SLACK = 2.0**-49
_SETTLES, _UP, _DOWN = 0, 1, -1


class Band(NamedTuple):
    """A band of speeds in which friction is a straight line.

    Attributes
    ----------
    low, high
        Ends of the band [m/s]; 0 is the lowest, infinity the highest.
    rise
        Intercept of the line less the friction at standstill [N].
    slope
        Slope of the line [N.s/m].
    friction
        Friction on the line at the speed `low` [N].
    """

    low: float
    high: float
    rise: float
    slope: float
    friction: float


class BandSlip(SlipArc):
    """A slip up to its end, or up to where its speed leaves a band.

    Parameters
    ----------
    oscillator
        Mass, spring, and the damping c + slope of the band.
    v, z, x_dot, mode
        As of `SlipArc`.
    net
        Force on the mass at the start but for the damping, as if it had the friction at
        standstill: k z + F_ext - mode kinetic [N].
    kinetic
        Friction at standstill [N].
    band
        The band; ``leaves`` is +1 where the arc ends at its upper end, -1 at its lower one, else 0.
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
        band: Band,
    ) -> None:
        self._band = band
        self._base = net
        self.leaves = _SETTLES
        self._steady = False
        net = net - mode * band.rise
        scale = abs(v) + abs(x_dot) + abs(net) / (oscillator.m * oscillator.quickest)
        self._floor = 0.0
        if band.low > 0.0:
            self._floor = band.low - _SLACK * (band.low + scale)
        self._ceiling = math.inf
        if band.high < math.inf:
            self._ceiling = band.high + _SLACK * (band.high + scale)
        super().__init__(oscillator, v, z, x_dot, mode, net, kinetic + band.rise)

    @property
    def start(self) -> Start:
        """Where the arc starts."""
        return Start(self.mode, self.z_start, self.x_dot_start, self._base)

    def state(self, tau: float) -> Motion:
        """Return the motion at `tau`; where it is exactly steady, rounding does not grow."""
        if not self._steady:
            return super().state(tau)
        growth, x_dot, _, friction = super().state(0.0)
        return growth, x_dot, x_dot * tau, friction

    @property
    def exit_speed(self) -> float:
        """The speed at which the next arc of the same slip starts [m/s], just beyond."""
        if self.leaves == _UP:
            return self._band.high * (1.0 + 2.0**-52)
        return self._band.low * (1.0 - 2.0**-52)

    def net_at_end(self, growth: float) -> float:
        """Return the net force with the friction at standstill at the end [N]."""
        return self._base + self._oscillator.k * growth

    def extreme_velocity(self, tau: float) -> float:
        """Return the velocity of largest magnitude up to `tau` [m/s]: at an end or an extreme."""
        times = [tau, *(time for time in self._extremes(tau) if time < tau)]
        return max(self.x_dot_start, *(self.state(time)[1] for time in times), key=abs)

    def heat(self, tau: float, displacement: float) -> float:
        """Return the heat of friction and damping up to `tau` [J]: docs/theory.md (15).

        While the speed of the pull is in the band, the friction is counted from that at this
        speed: ``f(V) way + (c + slope) (-V growth + integral of rho^2)``. Beyond, and while the
        motion has hardly begun, the power is integrated.
        """
        band, oscillator = self._band, self._oscillator
        if band.slope == 0.0:
            return super().heat(tau, displacement)
        pull = self.mode * self.v
        if tau > _PANEL / oscillator.quickest and band.low <= pull <= band.high:
            viscous = oscillator.c - band.slope
            friction = band.friction + band.slope * (pull - band.low) + viscous * pull
            way = self.mode * displacement
            if oscillator.c == 0.0:
                return friction * way
            if not oscillator.overdamped or abs(oscillator.slow) * tau > 1.0:
                growth = pull * tau - way
                return friction * way + oscillator.c * (self._squared_excess(tau) - pull * growth)
        return self._integrated_heat(tau)

    def _squared_excess(self, tau: float) -> float:
        """Return the integral of (x_dot - v)^2 up to `tau` [m2/s]."""
        oscillator = self._oscillator
        z_dot, acceleration = self._z_dot, self._acceleration
        of_rest, of_impulse = oscillator.squares(tau)
        step, _, _ = oscillator.responses(tau)
        mixed = step * (2.0 - step) / oscillator.w2
        return (
            z_dot * (z_dot * of_rest - acceleration * mixed)
            + acceleration * acceleration * of_impulse
        )

    def _integrated_heat(self, tau: float) -> float:
        """Return the heat by quadrature over panels, which grow with time in heavy damping."""
        panel = _PANEL / self._oscillator.quickest
        grows = self._oscillator.overdamped and self._oscillator.c > 0.0
        if not grows and tau > _MOST_PANELS * panel:
            panel = tau / _MOST_PANELS
        total = end = 0.0
        while end < tau:
            start, end = end, min(end + panel, tau)
            total += integral(self._power, start, end)
            if grows:
                panel = end
        return total

    def _power(self, tau: float) -> float:
        """Return the power of friction and damping at `tau` [W]."""
        band = self._band
        speed = self._speed(tau)[0]
        viscous = self._oscillator.c - band.slope
        return (band.friction + band.slope * (speed - band.low) + viscous * speed) * speed

    def _find_end(self) -> float:
        """Return when the mass first comes to rest or leaves the band, or infinity."""
        start = self.mode * self.x_dot_start
        # Where the acceleration is 0 its rate decides.
        rise = self.mode * (self._acceleration or self._fade)
        if start == 0.0 and self.mode * self._acceleration < 0.0:
            return 0.0
        if start > 0.0 and rise == 0.0:
            self._steady = self._oscillator.c < 0.0
            return math.inf
        growth = -self._oscillator.slow
        most = _MOST_GROWTH / growth if growth > 0.0 else sys.float_info.max
        low = 0.0
        for extreme in self._extremes():
            high = extreme if extreme < most else self._enclose_tail(low, most)
            if high == math.inf:
                break
            speed = self._speed(high)[0]
            if speed <= self._floor:
                return self._fall_to_low(low, high)
            if speed > self._ceiling:
                self.leaves = _UP
                self._from_rest = False
                return falling_zero(self._below_high, low, high)
            low = high
        return math.inf

    def _fall_to_low(self, low: float, high: float) -> float:
        """Return when the speed is that of the band's lower end, between these times."""
        if self._band.low > 0.0:
            self.leaves = _DOWN
        elif self._from_rest:
            return super()._find_end()
        self._from_rest = False
        return falling_zero(self._above_low, low, high)

    def _above_low(self, tau: float) -> Tuple[float, float]:
        speed, slope = self._speed(tau)
        return speed - self._band.low, slope

    def _below_high(self, tau: float) -> Tuple[float, float]:
        speed, slope = self._speed(tau)
        return self._band.high - speed, -slope

    def _extremes(self, before: float = math.inf) -> Iterator[float]:
        """Give times of extremes of the speed between which it is monotone, those that count.

        The last one is infinity where the speed goes on without an extreme. Up to `before` the
        extreme of largest magnitude is among them.
        """
        oscillator = self._oscillator
        if oscillator.overdamped:
            turn = self._turning_time()
            if turn < math.inf:
                yield turn
            yield math.inf
            return
        a, b = oscillator.a, oscillator.b
        along = self.mode * self._acceleration
        half = math.pi / b
        first = math.atan2(-along * b, self.mode * self._fade - a * along) / b
        while first <= 0.0:
            first += half
        yield first
        yield first + half
        pull = self.mode * self.v
        # Where rounding hides the swing beside the pull, by its own terms.
        step, impulse, _ = oscillator.responses(first)
        swing = abs(self._speed(first)[0] - pull)
        swing = swing or abs(self._acceleration * impulse - self._z_dot * (1.0 - step))
        if a >= 0.0 or swing == 0.0:
            return
        # Turns until the swing reaches an end of the band, whichever is nearer to the pull.
        reach = max(min(pull - self._band.low, self._band.high - pull), swing)
        turns = math.log(reach / swing) / (-a * half)
        if before < math.inf:
            turns = min(turns, (before - first) / half)
        n = max(2, math.floor(turns) - 2)
        while n < turns + 6.0:
            yield first + n * half
            n += 1

    def _enclose_tail(self, low: float, most: float) -> float:
        """Return a time up to `most` by which a monotone speed has left the band.

        Returns infinity where it has not by then. `low` [s] is the time of the last extreme.
        """
        pull = self.mode * self.v
        if self._oscillator.c > 0.0 and self._floor <= pull <= self._ceiling:
            return math.inf
        reach, high = 1.0 / self._oscillator.quickest, low
        while high < most:
            high = min(low + reach, most)
            if not self._floor < self._speed(high)[0] <= self._ceiling:
                return high
            reach *= 2.0
        return math.inf
