"""Falling kinetic friction in the block, in closed form.

The kinetic friction is ``(mu_k - slope |x_dot|) N`` while that is not below 0, so a slip in the
direction ``s`` obeys

``m x_ddot = k z + F_ext - s mu_k N - (c - slope N) x_dot``,

Coulomb's equation of slip with the damping ``c - slope N`` in place of ``c``: docs/theory.md (3).
Where that is negative the motion grows. With ``rho = s (x_dot - v)`` the speed along the slip is
``p = s v + rho``, and for ``abs(a) < w`` its slope is

``p' = exp(-a t) (A cos b t + B sin b t)``,
``A = s x_ddot(0)``, ``B = (s w^2 (v - x_dot(0)) - a A)/b``,

so the extremes of ``p`` are ``pi/b`` apart and ``rho`` there grows by ``-exp(-a pi/b)`` from one to
the next; for ``abs(a) >= w`` there is one extreme at most. Between two extremes ``p`` is monotone,
so the first time at which it is 0 (the slip ends) or ``mu_k/slope`` (the law ends) is enclosed. A
growing motion that swings many times before is taken to its last turns by the logarithm of what it
lacks. Heat is ``mu_k N`` times the way, and ``(c - slope N)`` times the integral of ``x_dot^2``.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator

from fmukit.model import ModelError
from fmukit.table import Quantity, Unit
from stickslip_fmu.interface import parameter
from stickslip_fmu.laws.coulomb.arcs import SlipArc
from stickslip_fmu.laws.coulomb.law import Coulomb, CoulombFriction
from stickslip_fmu.laws.coulomb.oscillator import Oscillator
from stickslip_fmu.laws.law import Arc, Friction
from stickslip_fmu.laws.sticking import SlipOfSticking, StickArc
from stickslip_fmu.numerics.quadrature import integral
from stickslip_fmu.numerics.roots import falling_zero
from stickslip_fmu.settings import Settings

# Panels of the quadrature hold a growth by exp(4) at most.
_PANEL = 4.0
# A motion that would need a growth by exp(600) to move has no digit of one.
_MOST_GROWTH = 600.0


class FallingSlip(SlipArc):
    """A slip whose friction falls with speed, up to the end of the slip or of the law.

    Parameters are those of `SlipArc`, and `limit`, the speed mu_k/slope [m/s].
    """

    __slots__ = ("limit", "passed_limit")

    def __init__(
        self,
        oscillator: Oscillator,
        v: float,
        z: float,
        x_dot: float,
        mode: int,
        net: float,
        kinetic: float,
        limit: float,
    ) -> None:
        self.limit = limit
        self.passed_limit = False
        super().__init__(oscillator, v, z, x_dot, mode, net, kinetic)

    def extreme_velocity(self, tau: float) -> float:
        """Return the velocity of largest magnitude up to `tau` [m/s]: at an end or an extreme."""
        candidates = [self.x_dot_start, self.state(tau)[1]]
        for time in self._extremes(tau):
            if time < tau:
                candidates.append(self.state(time)[1])
        return max(candidates, key=abs)

    def heat(self, tau: float, displacement: float) -> float:
        """Return the heat of friction and damping up to `tau` [J]."""
        heat = self._kinetic * abs(displacement)
        if self._oscillator.c != 0.0:
            heat += self._oscillator.c * self._squared_velocity(tau, displacement)
        return heat

    def _squared_velocity(self, tau: float, displacement: float) -> float:
        oscillator = self._oscillator
        if not (oscillator.overdamped and oscillator.c < 0.0):
            return super()._squared_velocity(tau, displacement)
        count = math.ceil(oscillator.quickest * tau / _PANEL)
        return math.fsum(
            integral(self._velocity_squared, tau * n / count, tau * (n + 1) / count)
            for n in range(count)
        )

    def _find_end(self) -> float:
        """Return when the mass first comes to rest or leaves the law, or infinity."""
        start = self.mode * self.x_dot_start
        # Where the acceleration is 0 its rate decides.
        rise = self.mode * (self._acceleration or self._fade)
        if start > self.limit or (start == self.limit and rise > 0.0):
            self.passed_limit = True
            return 0.0
        if start == 0.0 and self.mode * self._acceleration < 0.0:
            return 0.0
        if start > 0.0 and rise == 0.0 and self._oscillator.c >= 0.0:
            return math.inf
        growth = -self._oscillator.slow
        most = _MOST_GROWTH / growth if growth > 0.0 else sys.float_info.max
        low = 0.0
        for extreme in self._extremes():
            high = extreme if extreme < most else self._enclose_tail(low, most)
            if high == math.inf:
                break
            speed = self._speed(high)[0]
            if speed <= 0.0:
                return falling_zero(self._speed, low, high)
            if speed > self.limit:
                self.passed_limit = True
                return falling_zero(self._below_limit, low, high)
            low = high
        return math.inf

    def _below_limit(self, tau: float) -> tuple[float, float]:
        speed, slope = self._speed(tau)
        return self.limit - speed, -slope

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
        swing = abs(self._speed(first)[0] - self.mode * self.v)
        if a >= 0.0 or swing == 0.0:
            return
        # Turns until the swing reaches standstill or the limit, whichever is nearer to the pull.
        pull = self.mode * self.v
        reach = max(min(pull, self.limit - pull), swing)
        turns = math.log(reach / swing) / (-a * half)
        if before < math.inf:
            turns = min(turns, (before - first) / half)
        n = max(2, math.floor(turns) - 2)
        while n < turns + 6.0:
            yield first + n * half
            n += 1

    def _enclose_tail(self, low: float, most: float) -> float:
        """Return a time up to `most` by which a monotone speed has ended the slip or the law.

        Returns infinity where it has not by then. `low` [s] is the time of the last extreme.
        """
        oscillator = self._oscillator
        if oscillator.c > 0.0 and 0.0 <= self.mode * self.v <= self.limit:
            return math.inf
        reach, high = 1.0 / oscillator.quickest, low
        while high < most:
            high = min(low + reach, most)
            if not 0.0 < self._speed(high)[0] <= self.limit:
                return high
            reach *= 2.0
        return math.inf


class FallingFriction(CoulombFriction):
    """Falling kinetic friction under given settings."""

    __slots__ = ("limit",)

    def __init__(self, settings: Settings, before: Friction | None) -> None:
        super().__init__(settings, before)
        damping = settings.c - settings.slope * settings.normal_force()
        constants = (settings.k, settings.m, damping)
        if constants != self.oscillator.constants:
            self.oscillator = Oscillator(*constants)
        self.limit = self.mu_k_used / settings.slope if settings.slope > 0.0 else math.inf

    def slip_terms(self) -> tuple[float, ...]:
        """Return what the equation of slip is made of, and where the law ends."""
        return (*super().slip_terms(), self.oscillator.c, self.limit)

    def slip(self, mode: int, z: float, x_dot: float, net: float) -> Arc:
        """Return the slip that starts so."""
        if self.limit == math.inf:
            return super().slip(mode, z, x_dot, net)
        v = self.settings.v
        return FallingSlip(self.oscillator, v, z, x_dot, mode, net, self.kinetic, self.limit)

    def after(self, arc: StickArc | SlipOfSticking, z: float) -> Arc:
        """Return what follows the end of an arc; raises ModelError where the law ends."""
        if isinstance(arc, FallingSlip) and arc.passed_limit:
            raise ModelError(
                f"x_dot = {arc.state(arc.duration)[1]!r} m/s is out of range: falling "
                f"friction ends at the speed mu_k/slope = {self.limit!r} m/s, where it is 0"
            )
        return super().after(arc, z)


class Falling(Coulomb):
    """Kinetic friction that falls linearly with speed."""

    interface = Coulomb.interface._replace(
        model="FallingFriction",
        description="A mass pulled through a spring over friction that falls with speed.",
        rows=(
            *Coulomb.interface.rows,
            parameter(
                34,
                "slope",
                Quantity("Slope", "Real", "", "s/m", 0.1),
                "tunable",
                0.1,
                "Fall of the kinetic friction coefficient with speed",
                0.0,
            ),
        ),
        in_slip=(*Coulomb.interface.in_slip, "slope"),
        units={"s/m": Unit({"s": 1, "m": -1})},
    )

    def under(self, settings: Settings, before: Friction | None = None) -> Friction:
        """Return the law under these settings."""
        return FallingFriction(settings, before)


LAW = Falling()
