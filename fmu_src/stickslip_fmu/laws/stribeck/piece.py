"""A piece of a slip under friction that falls smoothly with speed, as power series of the time.

In the direction of the slip, with ``q = u/v_s``, the shape ``e(q)`` (`shapes`), the drop of
friction ``D = N (mu_s - mu_k)`` and the net force at standstill ``R = s (k z + F_ext) - mu_s N``,

``m u' = R + D (1 - e) - c u``,  ``R' = k (s v - u)``.

The series (`series`) run in ``s = tau/H``, H the shortest time of the motion at the start. The
piece ends where the speed reaches 0, or where the last terms of the series of speed or friction
are no longer below rounding. There the slope of the speed is compared with the force of the law
itself, and the piece is shortened until they agree.
"""

import math
from typing import List, Optional, Protocol, Tuple

from ...numerics.finite import finite
from ..law import Motion, Start
from . import polynomial
from .series import ORDER, Expand, product

# The last terms of the series, relative to the first ones, where the piece ends.
_TAIL = 2.0**-50
# What the slope of the speed may differ from the force of the law, relative to the forces in it.
# The error of the speed is 1/ORDER of it.
_DEFECT = 2.0**-47
_SHORTER = 0.8
# Longest piece in units of H; its powers stay in the range of numbers.
_LONGEST = 2.0**30
_MOST_TRIALS = 200
# Factor by which H is shortened where the coefficients leave the range of numbers.
_QUICKER = 2.0**20
_MOST_SCALES = 8


class Shape(Protocol):
    """A shape of friction over speed: see `shapes.Stribeck`."""

    delta: float
    analytic: bool
    breadth: float
    flat_from: float

    @property
    def expand(self) -> Expand: ...  # noqa: D102 - as in `shapes`
    def inner(self, q: float) -> float: ...  # noqa: D102
    def left(self, q: float) -> float: ...  # noqa: D102
    def fallen(self, q: float) -> float: ...  # noqa: D102
    def steepness(self, q: float) -> float: ...  # noqa: D102


class Smooth:
    """Friction that falls smoothly with speed, on its mass and spring.

    Attributes
    ----------
    k, m, c
        Stiffness [N/m], mass [kg] and damping [N.s/m].
    v
        Velocity of the pulled end [m/s].
    shape
        The shape of the fall.
    v_s
        Speed of the fall [m/s].
    drop
        Friction at standstill less that of high speeds [N].
    rest
        Friction of high speeds [N].
    """

    def __init__(
        self,
        k: float,
        m: float,
        c: float,
        v: float,
        shape: Shape,
        v_s: float,
        drop: float,
        rest: float,
    ) -> None:
        self.k, self.m, self.c, self.v = k, m, c, v
        self.shape, self.v_s, self.drop, self.rest = shape, v_s, drop, rest
        self.w = math.sqrt(k / m)

    def friction(self, speed: float) -> float:
        """Return the friction without its viscous part [N]."""
        return self.rest + self.drop * self.shape.left(speed / self.v_s)


class PieceSlip:
    """A piece of a slip.

    Parameters
    ----------
    law
        Friction, mass and spring.
    z, x_dot
        Spring extension [m] and velocity of the mass [m/s] at the start.
    mode
        +1 forward, -1 backward; `x_dot` is zero or of this sign.
    net
        Force on the mass at the start but for the damping, as if it had the friction at
        standstill: k z + F_ext - mode mu_s N [N].

    Attributes
    ----------
    leaves
        1 where the slip goes on after the piece, 0 where it comes to rest or never ends.
    """

    age = 0.0

    def __init__(self, law: Smooth, z: float, x_dot: float, mode: int, net: float) -> None:
        self._law = law
        self._net = net
        self.v = law.v
        self.mode = mode
        self.z_start = z
        self.x_dot_start = x_dot
        self._heat: Optional[List[float]] = None
        self._expand(mode * x_dot, mode * net)
        # Speed and way beyond that at the speed of the start, at the end of the piece.
        self._last = (mode * x_dot, 0.0)
        self.leaves = 0
        self.duration = self._find_end(mode * net)

    @property
    def start(self) -> Start:
        """Where the arc starts."""
        return Start(self.mode, self.z_start, self.x_dot_start, self._net)

    @property
    def exit_speed(self) -> float:
        """The speed at the end of the piece, where the next one starts [m/s]."""
        return self._last[0]

    def state(self, tau: float) -> Motion:
        """Return the motion at `tau`."""
        return self._motion(tau, self._along(tau))

    def end(self) -> Motion:
        """Return the motion at the end of the piece; at the end of the slip the velocity is 0."""
        return self._motion(self.duration, self._last)

    def own(self, tau: float) -> Tuple[float, ...]:
        """Return the law's own state: none."""
        return ()

    def net_at_end(self, growth: float) -> float:
        """Return the net force with the friction at standstill at the end [N]."""
        return self._net + self._law.k * growth

    def way_to_break_away(self, gap: float) -> float:
        """Return what the force lacks of F_s at the end, in the direction of the slip [N]."""
        return gap - self.mode * self.net_at_end(self.end()[0])

    def extreme_velocity(self, tau: float) -> float:
        """Return the velocity of largest magnitude up to `tau` [m/s]."""
        return self.mode * polynomial.highest(self._speeds, tau / self._scale)

    def pull_work(self, tau: float) -> float:
        """Return the work of the pulling end up to `tau` [J]: docs/theory.md (15)."""
        s = tau / self._scale
        more = 0.0
        power = ORDER + 2.0
        for _, of_way in self._descending:
            more = (more + of_way / power) * s
            power -= 1.0
        more *= tau * tau
        first = self.mode * self.x_dot_start
        growth = self.mode * (0.5 * (self.mode * self.v - first) * tau * tau - more)
        return self._law.k * self.v * (self.z_start * tau + growth)

    def heat(self, tau: float, displacement: float) -> float:
        """Return the heat of friction and damping up to `tau` [J]: docs/theory.md (15).

        From the product of the series of speed and friction, each coefficient added up from the
        lowest power of the speed on; its integral by Horner's scheme.
        """
        coefficients = self._heat
        if coefficients is None:
            # An arc is shared, and this only keeps what any of its readers would compute.
            coefficients = self._heat = self._expand_heat()
        s = tau / self._scale
        total, power = 0.0, float(ORDER)
        for coefficient in reversed(coefficients):
            total = (total + coefficient / power) * s
            power -= 1.0
        return total * self._scale

    def _motion(self, tau: float, along: Tuple[float, float]) -> Motion:
        """Return the motion at `tau`, for its speed and way."""
        law, mode = self._law, self.mode
        speed, more = along
        if speed < 0.0:
            # Rounding beside an end of the slip; the motion itself never turns.
            speed = 0.0
        first = mode * self.x_dot_start
        x_dot = mode * speed
        friction = -(mode * law.friction(speed) + law.c * x_dot)
        growth = mode * ((mode * self.v - first) * tau - more)
        return growth, x_dot, mode * (first * tau + more), friction

    def _along(self, tau: float) -> Tuple[float, float]:
        """Return the speed [m/s], and the way beyond that at the speed of the start [m].

        Both by Horner's scheme from the highest power down.
        """
        s = tau / self._scale
        speed = way = 0.0
        for of_speed, of_way in self._descending:
            speed = (speed + of_speed) * s
            way = (way + of_way) * s
        return speed + self._speeds[0], way * tau

    def _expand(self, speed: float, net: float) -> None:
        """Compute the coefficients of speed and friction, and the time that scales them."""
        law = self._law
        shape = law.shape
        first = speed / law.v_s
        steep = law.drop / law.v_s * shape.steepness(first)
        rate = law.w + (law.c + steep) / law.m
        inner, fall = shape.inner(first), shape.left(first)
        driving = net + law.drop * shape.fallen(first)
        for _ in range(_MOST_SCALES):
            scale = 1.0 / rate
            self._speeds, self._fall, self._descending = shape.expand(
                first,
                inner,
                fall,
                driving,
                scale / (law.m * law.v_s),
                law.drop,
                scale * law.c / law.m,
                scale * law.k * law.v_s,
                scale * law.k * (self.mode * law.v),
                shape.delta,
                law.v_s,
            )
            # The last coefficient of the speed has all others in it, those of friction too.
            if abs(self._speeds[-1]) < math.inf:
                break
            # The motion is quicker than its start shows.
            rate *= _QUICKER
        finite(self._speeds[-1])
        self._scale = scale

    def _expand_heat(self) -> List[float]:
        """Return the coefficients of the power of friction and damping."""
        law, speeds = self._law, self._speeds
        forces = [law.drop * e + law.c * u for e, u in zip(self._fall, speeds)]
        forces[0] += law.rest
        return product(speeds[:ORDER], forces)

    def _find_end(self, net: float) -> float:
        """Return when the slip or the piece ends, or infinity where the speed stays as it is."""
        speeds = self._speeds
        # A slip from rest has zeros as its first coefficients.
        lowest = 0
        while lowest < ORDER and speeds[lowest] == 0.0:
            lowest += 1
        if speeds[lowest] < 0.0:
            return 0.0
        end = self._reach()
        if end == math.inf:
            return math.inf
        rising = speeds[lowest:] if lowest > 0 else speeds
        last, zero = end, None
        for _ in range(_MOST_TRIALS):
            zero = polynomial.first_zero(rising, end)
            last = end if zero is None else zero
            self._last = self._along(last * self._scale)
            if self._agrees(last, net, zero is not None):
                break
            end = _SHORTER * last
        if zero is None:
            self.leaves = 1
        else:
            self._last = (0.0, self._last[1])
        return last * self._scale

    def _reach(self) -> float:
        """Return the s up to which the last terms of the series are below rounding."""
        law, speeds, fall = self._law, self._speeds, self._fall
        per_force = self._scale / law.m * law.drop
        largest = max(abs(speeds[0]), abs(speeds[1]), abs(speeds[2]), abs(speeds[3]))
        end = math.inf
        for j in (ORDER - 1, ORDER):
            for term in (abs(speeds[j]), per_force * abs(fall[j - 1]) / j):
                if term > 0.0:
                    end = min(end, math.pow(_TAIL * largest / term, 1.0 / j))
        if end == math.inf and any(speeds[1:]):
            return _LONGEST
        return min(end, _LONGEST) if end < math.inf else end

    def _agrees(self, s: float, net: float, stops: bool) -> bool:
        """Whether the slope of the speed at `s`, the last of the piece, is that of the force."""
        law = self._law
        speed, way = self._last
        if stops:
            speed = 0.0
        elif not speed > 0.0:
            return False
        slope, power = 0.0, float(ORDER)
        for of_speed, _ in self._descending:
            slope = slope * s + power * of_speed
            power -= 1.0
        first = self.mode * self.x_dot_start
        tau = s * self._scale
        end = net + law.k * ((self.mode * self.v - first) * tau - way)
        ratio = speed / law.v_s
        drop = law.drop * law.shape.fallen(ratio)
        damping = law.c * speed
        # The last is what the friction may change by with the rounding of the speed.
        forces = (
            abs(net) + abs(end) + drop + damping + law.drop * law.shape.steepness(ratio) * ratio
        )
        defect = end + drop - damping - law.m / self._scale * slope
        return abs(defect) <= _DEFECT * forces
