"""Coulomb's friction law: its slip in closed form. docs/theory.md (3), (5), (15), (19).

Everything is counted along the slip: a slip backward is the mirror image of one forward, so the
pulling speed V = s v carries the sign and the speed of the mass is never negative.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from .law import FrictionLaw
from .parameters import (
    Context,
    Kind,
    Number,
    Numbers,
    Parameter,
    complete,
    exact,
    high_precision,
    sign,
)
from .series import Series, safeguarded_zero


class _Fall(NamedTuple):
    start: Number
    stop: Number | None  # None where it never turns


class _Oscillation:
    """The free oscillation rho, speed of the mass less that of the pulled end, for zeta < 1, (3).

    ``fall`` is its first fall from time 0 on, None if it only rises, or rests; ``rise_end`` the
    time of its first maximum after time 0, None if there is none.
    """

    def __init__(
        self, context: Context, alpha: Number, omega: Number, rho_0: Number, a_0: Number
    ) -> None:
        self._context = context
        self._alpha = alpha
        self._omega = omega
        self._w2 = alpha * alpha + omega * omega
        self._cosine = rho_0
        self._sine = (a_0 + alpha * rho_0) / omega
        self._rate_cosine = a_0
        self._rate_sine = -(alpha * a_0 + self._w2 * rho_0) / omega
        self.fall: _Fall | None = None
        self.rise_end: Number | None = None
        if rho_0 == 0 and a_0 == 0:
            return
        self.phase = context.atan2(a_0, -self._rate_sine)
        pi = context.pi
        self.fall = _Fall(
            start=self.phase / omega if self.phase > 0 else context.zero,
            stop=(self.phase + pi) / omega,
        )
        self.rise_end = (self.phase if self.phase > 0 else self.phase + 2 * pi) / omega

    def at(self, t: Number) -> tuple[Number, Number]:
        """Return rho [m/s] and its rate [m/s2] at the time t [s] after the start."""
        cosine, sine = self._context.cos_sin(self._omega * t)
        rho = self._cosine * cosine + self._sine * sine
        rate = self._rate_cosine * cosine + self._rate_sine * sine
        if self._alpha:
            decay = self._context.exp(-self._alpha * t)
            return decay * rho, decay * rate
        return rho, rate

    def extreme(self, t: Number) -> Number:
        """Return the magnitude of rho [m/s] at the time t of one of its extremes."""
        start = self._context.hypot(self._cosine, self._sine) * self._omega
        return start * self._context.exp(-self._alpha * t) / self._context.sqrt(self._w2)

    def square_integral(self, t: Number) -> Number:
        """Return the integral of rho^2 over time, from 0 to t [m2/s]; damped motion only."""
        alpha, omega = self._alpha, self._omega
        decay = self._context.exp(-2 * alpha * t)
        cosine, sine = self._context.cos_sin(2 * omega * t)
        mean = (1 - decay) / (2 * alpha)
        cosine_part = (decay * (omega * sine - alpha * cosine) + alpha) / (2 * self._w2)
        sine_part = (omega - decay * (alpha * sine + omega * cosine)) / (2 * self._w2)
        A, B = self._cosine, self._sine
        return (A * A + B * B) / 2 * mean + (A * A - B * B) / 2 * cosine_part + A * B * sine_part


class _CriticalDecay:
    """zeta = 1: one rate, an exponential times a straight line. docs/theory.md (3), (5)."""

    def __init__(self, context: Context, alpha: Number, rho_0: Number, a_0: Number) -> None:
        self._context = context
        self._alpha = alpha
        self._rho_0 = rho_0
        self._slope = a_0 + alpha * rho_0
        turn = a_0 / (alpha * self._slope) if self._slope else context.zero
        self.fall, self.rise_end = _single_turn(context, turn, rho_0, a_0)

    def at(self, t: Number) -> tuple[Number, Number]:
        decay = self._context.exp(-self._alpha * t)
        line = self._rho_0 + self._slope * t
        return decay * line, decay * (self._slope - self._alpha * line)

    def square_integral(self, t: Number) -> Number:
        rate = 2 * self._alpha
        decay = self._context.exp(-rate * t)
        zeroth = (1 - decay) / rate
        first = (zeroth - t * decay) / rate
        second = (2 * first - t * t * decay) / rate
        A, B = self._rho_0, self._slope
        return A * A * zeroth + 2 * A * B * first + B * B * second


class _TwoDecays:
    """zeta > 1: a fast and a slow exponential. docs/theory.md (3), (5)."""

    def __init__(
        self, context: Context, alpha: Number, beta: Number, w2: Number, rho_0: Number, a_0: Number
    ) -> None:
        self._context = context
        self._fast = alpha + beta
        self._slow = w2 / self._fast
        split = 2 * beta
        slow_amplitude = a_0 + self._fast * rho_0
        self._A_fast = -(a_0 + self._slow * rho_0) / split
        self._A_slow = slow_amplitude / split
        turn = context.zero
        if slow_amplitude:
            ratio = split * a_0 / (self._slow * slow_amplitude)
            if ratio > 0:
                turn = context.log1p(ratio) / split
        self.fall, self.rise_end = _single_turn(context, turn, rho_0, a_0)

    def at(self, t: Number) -> tuple[Number, Number]:
        fast = self._A_fast * self._context.exp(-self._fast * t)
        slow = self._A_slow * self._context.exp(-self._slow * t)
        return fast + slow, -self._fast * fast - self._slow * slow

    def square_integral(self, t: Number) -> Number:
        total = self._context.zero
        for amplitude, rate in (
            (self._A_fast * self._A_fast, 2 * self._fast),
            (self._A_slow * self._A_slow, 2 * self._slow),
            (2 * self._A_fast * self._A_slow, self._fast + self._slow),
        ):
            total -= amplitude * self._context.expm1(-rate * t) / rate
        return total


def _single_turn(
    context: Context, turn: Number, rho_0: Number, a_0: Number
) -> tuple[_Fall | None, Number | None]:
    """Return the fall and the maximum of a motion with one extreme, at `turn` if that is > 0."""
    rises = a_0 > 0 or (a_0 == 0 and rho_0 <= 0)
    if turn > 0:
        return (_Fall(turn, None), turn) if rises else (_Fall(context.zero, turn), None)
    return (None if rises else _Fall(context.zero, None)), None


class Slip:
    """A slip with all inputs and parameters constant, from its start (or their last change) on.

    It starts in the `direction` s with the `speed` s x_dot [m/s], exactly 0 from rest, and the
    `acceleration` s x_ddot [m/s2], from rest >= 0, and 0 only if the pull goes along.

    ``duration`` [s] is the time from here to its end, docs/theory.md (5), None if it never ends;
    ``end_acceleration`` [m/s2] is s x_ddot there, <= 0, undamped from rest exactly -acceleration.
    ``margin`` says how clearly it ends or goes on: |p_min| / (|V| + |rho_min|) at the minimum that
    decides (0: it just touches zero); None where no number decides, as in an undamped slip from
    rest or against the pull, which end by structure. ``decided_after`` [s] is when that has been
    met.
    """

    def __init__(
        self,
        context: Context,
        numbers: Numbers,
        direction: int,
        speed: Number,
        acceleration: Number,
    ) -> None:
        self._context = context
        self._numbers = numbers
        self._V = direction * numbers.v
        self._direction = direction
        self.speed = speed
        self._acceleration = acceleration
        self._rho_0 = speed - self._V
        self._velocity = self._relative_velocity()
        self.duration: Number | None = None
        self.end_acceleration: Number | None = None
        self.margin: Number | None = None
        self.decided_after: Number | None = None
        self._structural_margin: Number | None = None
        if numbers.c == 0:
            self._end_undamped()
        else:
            self._end_damped()

    def stays(self, changed: Numbers, t: Number) -> bool:
        """Return whether the slip under way at the time t is the same with `changed` numbers.

        So it is when mu_s changes, or a load without friction: the arc is kept, and with it a
        grazing stop that is exact. Whoever starts anew there, in rounded numbers, decides it by a
        rounding; from here on the margin says so.
        """
        if t == 0 and self.speed == 0:
            return False
        n = self._numbers
        before = (n.k, n.c, n.v, n.F_ext, n.F_k)
        if before != (changed.k, changed.c, changed.v, changed.F_ext, changed.F_k):
            return False
        if self._structural_margin is not None:
            self.margin = self._structural_margin
            self.decided_after = self.duration
        return True

    def reach(self, t: Number) -> None:
        """Do nothing: `duration` is known from the start."""

    def decision(self, t: Number) -> Number | None:
        """Return `margin` if the decision has been met by the time t [s], else None."""
        return self.margin if self.margin is not None and t >= self.decided_after else None

    def dry_friction(self, t: Number) -> Number:
        """Return mu_k N [N] at any time."""
        return self._numbers.F_k

    def state(self, t: Number) -> tuple[Number, ...]:
        """Return nothing: the law has no state of its own."""
        return ()

    def _relative_velocity(self) -> _Oscillation | _CriticalDecay | _TwoDecays:
        context, n = self._context, self._numbers
        alpha = n.c / (2 * n.m)
        # 4 m^2 (w^2 - alpha^2), whose sign is exact: products of doubles fit the context.
        discriminant = 4 * n.k * n.m - n.c * n.c
        root = context.sqrt(abs(discriminant)) / (2 * n.m)
        if discriminant > 0:
            return _Oscillation(context, alpha, root, self._rho_0, self._acceleration)
        if discriminant == 0:
            return _CriticalDecay(context, alpha, self._rho_0, self._acceleration)
        return _TwoDecays(context, alpha, root, n.k / n.m, self._rho_0, self._acceleration)

    def _end_undamped(self) -> None:
        """Set the end of a slip without damping in closed form, docs/theory.md (5), zeta = 0."""
        context, n = self._context, self._numbers
        fall = self._velocity.fall
        if fall is None:
            return
        w = context.sqrt(n.k / n.m)
        if self.speed == 0:
            reach = self._acceleration / w
            self.end_acceleration = -self._acceleration
            if self._V > 0:
                self._structural_margin = (
                    reach / (self._V + context.hypot(self._rho_0, reach))
                ) ** 2
        else:
            square = (
                self.speed * (self.speed - 2 * self._V)
                + self._acceleration * self._acceleration * n.m / n.k
            )
            if self._V > 0:
                swing = context.hypot(self._rho_0, self._acceleration / w)
                self.margin = abs(square) / (self._V + swing) ** 2
                self.decided_after = fall.stop
            if square < 0 and self._V > 0:
                return
            reach = context.sqrt(square)
            self.end_acceleration = -w * reach
        angle = context.atan2(self._acceleration / w, self._rho_0)
        self.duration = (angle + context.atan2(reach, -self._V)) / w
        if self.decided_after is not None:
            self.decided_after = self.duration

    def _end_damped(self) -> None:
        """Set the end of a slip with damping: isolate between extremes, polish, (5)."""
        fall = self._velocity.fall
        if fall is None:
            return
        if fall.stop is None:
            self._margin_of_creep()
            if self._V >= 0:
                return
            bracket = self._bracket_endless_fall(fall.start)
        else:
            if isinstance(self._velocity, _Oscillation):
                swing = self._velocity.extreme(fall.stop)
                lowest = self._V - swing
                decided_by_structure = self._V <= 0
            else:
                swing = self._velocity.at(fall.stop)[0]
                lowest = self._V + swing
                decided_by_structure = self._V < 0
            if not decided_by_structure:
                self.margin = abs(lowest) / (self._V + abs(swing))
                self.decided_after = fall.stop
                if self._V == 0:
                    self._margin_of_creep()
            if lowest > 0:
                return
            bracket = (fall.start, fall.stop)
        self.duration = self._falling_zero(*bracket)
        self.end_acceleration = self._velocity.at(self.duration)[1]
        if self.margin is not None:
            self.decided_after = self.duration

    def _margin_of_creep(self) -> None:
        """Set the margin of an over-damped slip at V = 0, which creeps if its slow part does."""
        if self._V != 0 or self.speed == 0:
            return
        n = self._numbers
        fast = (n.c + self._context.sqrt(n.c * n.c - 4 * n.k * n.m)) / (2 * n.m)
        forward = fast * self._rho_0
        self.margin = abs(self._acceleration + forward) / (abs(self._acceleration) + forward)
        self.decided_after = self._context.zero

    def _bracket_endless_fall(self, start: Number) -> tuple[Number, Number]:
        """Return two times about the zero of a fall that tends to V < 0."""
        n = self._numbers
        before = start
        length = n.m / n.c
        while self._V + self._velocity.at(start + length)[0] > 0:
            before = start + length
            length *= 2
        return before, start + length

    def _falling_zero(self, low: Number, high: Number) -> Number:
        """Return the zero of the speed in (low, high], where it falls from > 0 to <= 0, by Halley.

        Inside the bracket the speed has no extreme, so a small step has found the zero.
        """
        n = self._numbers
        damping, stiffness = n.c / n.m, n.k / n.m

        def speed(t: Number) -> tuple[bool, Number | None]:
            rho, rate = self._velocity.at(t)
            p = self._V + rho
            curvature = -damping * rate - stiffness * rho
            slope = 2 * rate * rate - p * curvature
            return p <= 0, -2 * p * rate / slope if rate and slope else None

        return safeguarded_zero(self._context, speed, low, high)

    def motion(self, t: Number) -> tuple[Number, Number]:
        """Return speed s x_dot [m/s] and distance s (x - x_0) [m] at the time t [s] from here."""
        n = self._numbers
        rho, rate = self._velocity.at(t)
        stretch = n.m * (rate - self._acceleration) + n.c * (rho - self._rho_0)
        return self._V + rho, self._V * t - stretch / n.k

    def work_and_heat(self, t: Number, speed: Number, distance: Number) -> tuple[Number, Number]:
        """Return work done by the pulled end and heat [J] from here to t, docs/theory.md (15).

        `speed` and `distance` are those of `motion` at t.
        """
        n = self._numbers
        impulse = (
            n.m * (speed - self.speed) + n.c * distance + (n.F_k - self._direction * n.F_ext) * t
        )
        heat = n.F_k * distance
        if n.c:
            drift = self._V * t
            square = self._velocity.square_integral(t)
            heat += n.c * (self._V * (2 * distance - drift) + square)
        return self._V * impulse, heat

    def top_speed(self, t: Number) -> Number:
        """Return the largest speed [m/s] between here and t."""
        top = max(self.speed, self._V + self._velocity.at(t)[0])
        rise_end = self._velocity.rise_end
        if rise_end is not None and rise_end <= t:
            top = max(top, self._V + self._velocity.at(rise_end)[0])
        return top


class Coulomb(FrictionLaw):
    """Coulomb's law: mu_s N holds at rest, mu_k N drags in slip. docs/theory.md (1).

    At rest mu_s may grow with the age of the stick, docs/theory.md (19); numbers without the
    parameters of that growth mean none.
    """

    parameters = (
        Parameter("tau_s", "s", 0.0, Kind.TUNABLE, low=0.0),
        Parameter("B", "1", 0.0, Kind.TUNABLE, low=0.0),
        Parameter("t_0", "s", 1.0, Kind.TUNABLE, low=0.0, strict=True),
        Parameter("age_start", "s", 0.0, Kind.FIXED, low=0.0),
    )

    def ages(self, n: Numbers) -> bool:
        """Return whether mu_s grows at rest: with tau_s and a gap, or with B; not without N."""
        growing = (n.own.get("tau_s") and n.gap) or (n.own.get("B") and n.N)
        return bool(growing)

    def age_start(self, n: Numbers) -> Number:
        """Return the age [s] of the first stick of a run that begins at rest."""
        return n.own.get("age_start", 0)

    def hold(self, n: Numbers, age: Series, state: Sequence[Number]) -> Series | Number:
        """Return mu_s N [N], at an age where it grows: docs/theory.md (19).

        Written from mu_k N upward, so that it is exactly this where nothing has grown.
        """
        if not self.ages(n):
            return n.F_s
        grown = (age / n.own["t_0"] + 1).log() * (n.own["B"] * n.N)
        if not n.own["tau_s"]:
            return grown + n.F_s
        return grown + (1 - (age / -n.own["tau_s"]).exp()) * n.gap + n.F_k

    def kinetic(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Series:
        """Return mu_k N [N] at any speed."""
        return Series(speed.context, [n.F_k])

    def gap(self, n: Numbers, hold: Number, sliding: Number) -> Number:
        """Return (mu_s - mu_k) N [N], rounded once; what has grown where mu_s grows."""
        return hold - sliding if self.ages(n) else n.gap

    def slip(
        self,
        context: Context,
        n: Numbers,
        direction: int,
        speed: Number,
        acceleration: Number,
        state: tuple[Number, ...],
    ) -> Slip:
        """Return the slip in closed form."""
        return Slip(context, n, direction, speed, acceleration)


COULOMB = Coulomb()


def steady_cycle(parameters: Mapping[str, float], *, digits: int = 50) -> dict[str, Number] | None:
    """Return the steady stick-slip cycle of exactly these numbers, or None where there is none.

    That is for v = 0 and, damped, for lambda < lambda_c. `parameters` are m g k c mu_s mu_k v load
    (SI), the rest at their start values; F_ext and the start do not matter. `ValueError` names a
    parameter, its value and its range. docs/theory.md (7) to (11) without damping, (13) with: F_s
    [N], Delta [m], lambda_ [1], spring_drop [m], delta_x [m], t_slip [s], t_stick [s], T [s], f
    [Hz], x_dot_peak [m/s], to `digits` decimal digits; lengths and x_dot_peak with the sign of v.
    """
    context = high_precision(digits)
    n = exact(context, complete(parameters))
    direction = sign(n.v)
    if direction == 0:
        return None
    slip = Slip(context, n, direction, context.zero, n.gap / n.m)
    if slip.duration is None:
        return None
    spring_drop = (n.gap - n.m * slip.end_acceleration) / n.k
    t_stick = spring_drop / abs(n.v)
    T = t_stick + slip.duration
    Delta = n.gap / n.k
    return {
        "F_s": n.F_s,
        "Delta": Delta,
        "lambda_": context.sqrt(n.k / n.m) * Delta / abs(n.v),
        "spring_drop": direction * spring_drop,
        "delta_x": n.v * T,
        "t_slip": slip.duration,
        "t_stick": t_stick,
        "T": T,
        "f": 1 / T,
        "x_dot_peak": direction * slip.top_speed(slip.duration),
    }


def critical_lambda(zeta: float, *, digits: int = 50) -> Number:
    """Return lambda_c(zeta), the least lambda = w Delta/|v| with a cycle, docs/theory.md (13).

    0 for zeta = 0 (a cycle at every speed), +inf for zeta >= 1 (at none). The damping ratio c/(2 m
    w) [1] is a double or a number of high precision, taken exactly; the result carries `digits`
    decimal digits. `ValueError` if zeta is negative or no number.
    """
    context = high_precision(digits)
    ratio = context.mpf(zeta)
    if not ratio >= 0:
        raise ValueError(f"zeta = {zeta} is outside zeta >= 0")
    if ratio == 0:
        return context.zero
    if ratio >= 1:
        return context.inf
    nu = context.sqrt((1 - ratio) * (1 + ratio))

    def excess(logarithm: Number) -> tuple[bool, Number]:
        L = context.exp(logarithm)
        square = (L - ratio) ** 2 + nu * nu
        turn = 2 * context.pi - context.atan2(L * nu, 1 - ratio * L)
        left = context.log(square) - 2 * ratio / nu * turn
        return left > 0, -left * square / (2 * L * L)

    low = context.log(2 * ratio)
    high = context.log1p(context.exp(2 * context.pi * ratio / nu))
    return context.exp(safeguarded_zero(context, excess, low, high))
