"""A slip under any friction that is an analytic function of speed, by Taylor series.

Counted along the slip, with the speed u = s x_dot >= 0, the force P = s (k z + F_ext) of spring and
surroundings, the pull V = s v and the friction R(u), docs/theory.md (1), (15):

    m u' = P - R(u) - c u          P' = k (V - u)
    distance' = u                  heat' = (R + c u) u          work of the pull' = V (P - s F_ext)

The friction law may have state variables of its own, with rates that depend on u and on them. One
piece of the march holds the Taylor series of all of these about its beginning. Its length comes
from the coefficients of every series in it, those inside the friction law's expression too; then
the equation of motion is checked at the piece's end against the law's own values there.

The slip ends at the first zero of u. Between two turns of u, which are isolated by bounds
(`zeros`), u is monotone, so its sign at turns and ends decides: no zero is missed, however shallow.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from stickslip_verification.truth.parameters import Context, Number, Numbers
from stickslip_verification.truth.series import (
    Series,
    derivative,
    integral,
    polynomial,
    value_at,
)
from stickslip_verification.truth.zeros import bracketed_zero, polynomial_zeros

_ROUNDING_BITS = 16
"""A series is cut where its last quarter is below 2^16 roundings of its largest term."""

_DEFECT_BITS = 30
"""The equation of motion must hold to 2^30 roundings at the end of a piece: the derivative of a
series of order 80 is known to some thousand times less than the series, and a half of the piece is
tried where it does not hold."""

_TOUCH_BITS = 44
"""A turn of u within 2^44 roundings of the largest speed from zero counts as zero: rounding of
some hundred pieces, amplified; see `docs/theory.md (5)` for a slip that touches zero."""

_LONGEST = 8
"""Longest piece in units of 1/w, for series that end after a few terms."""

_MOST_HALVINGS = 40
"""A piece that is still wrong at 1e-12 of the length that its series promise meets a kink."""

_OVERLAP_BITS = 20
"""Turns are looked for up to 2^-20 of a piece beyond its end, so that none falls between two."""


@dataclass(frozen=True)
class Friction:
    """What a friction law gives a march, under constant parameters.

    Attributes
    ----------
    force
        Takes the series of the speed [m/s] and those of the own state; returns that of the
        friction [N].
    rates
        Takes the same; returns the series of the rates of the own state.
    limit
        Speed up to which the law holds [m/s]; None without a limit.
    signed
        Whether the law has no stick: then u may change its sign, and does not end the slip.
    """

    force: Callable[[Series, Sequence[Series]], Series]
    rates: Callable[[Series, Sequence[Series]], Sequence[Series]]
    limit: Number | None = None
    signed: bool = False


@dataclass(frozen=True)
class _Piece:
    """Polynomials from the time `begin` on, of `length` [s]."""

    begin: Number
    length: Number
    speed: Sequence[Number]
    pull: Sequence[Number]
    friction: Sequence[Number]
    distance: Sequence[Number]
    heat: Sequence[Number]
    impulse: Sequence[Number]
    state: Sequence[Sequence[Number]]


class March:
    """A slip from its start (or the last change of a parameter) on; times count from there.

    Parameters
    ----------
    context, numbers
        High-precision context and the parameters in it.
    friction
        What the friction law gives.
    direction
        s = +1 or -1.
    speed
        u at the start [m/s]; exactly 0 for a slip from rest, else positive.
    acceleration
        u' at the start [m/s2].
    state
        The friction law's own state at the start.

    Attributes
    ----------
    speed
        As given [m/s].
    duration
        Time from the start to the end of the slip [s]; None if `reach` has met no end yet.
    end_acceleration
        u' at that end [m/s2], <= 0; exactly 0 where u only touches zero.
    """

    def __init__(
        self,
        context: Context,
        numbers: Numbers,
        friction: Friction,
        direction: int,
        speed: Number,
        acceleration: Number,
        state: Sequence[Number] = (),
    ) -> None:
        self._context = context
        self._numbers = numbers
        self._friction = friction
        self._V = direction * numbers.v
        self._F_ext = direction * numbers.F_ext
        self._start_state = tuple(state)
        self.speed = speed
        self.duration: Number | None = None
        self.end_acceleration: Number | None = None
        n = numbers
        dry = friction.force(
            Series(context, [speed]), [Series(context, [each]) for each in state]
        ).term(0)
        self._force = n.m * acceleration + dry + n.c * speed
        self._order = context.prec * 7 // 20
        self._pieces: list[_Piece] = []
        self._begins: list[Number] = []
        self._turns: list[tuple[Number, Number, bool]] = []
        self._largest = max(abs(speed), abs(self._V))

    def reach(self, t: Number) -> None:
        """Follow the slip up to the time `t` [s], or to its end if that is earlier.

        Raises
        ------
        ValueError
            If the speed passes the limit of the friction law; the message names both.
        """
        self._check_limit(t)
        while self.duration is None and self._reached() < t:
            self._go_on()
            self._check_limit(t)

    def _check_limit(self, t: Number) -> None:
        """Refuse a slip that is known to pass the friction law's limit by the time `t` [s]."""
        limit = self._friction.limit
        if limit is None:
            return
        known = self._reached() if self.duration is None else self.duration
        top = self.top_speed(min(t, known))
        if top > limit:
            nstr = self._context.nstr
            raise ValueError(
                f"the mass reaches {nstr(top, 6)} m/s, but the friction law holds up to "
                f"{nstr(limit, 6)} m/s; change its parameters, or what makes the slip so fast"
            )

    def stays(self, changed: Numbers, t: Number) -> bool:
        """Return whether the slip goes on as it is with `changed` numbers: it begins anew."""
        return False

    def decision(self, t: Number) -> Number | None:
        """Return how clearly the slip has ended or gone on up to `t`; None if nothing decided.

        The smallest |u| / (|V| + |u - V|) at the least speeds passed by. At the end of the slip
        q^2 / (|V| + hypot(V, q))^2 with q = u' sqrt(m/k), which is the same for a slip without
        damping.
        """
        V = abs(self._V)
        found = [
            abs(speed) / (V + abs(speed - self._V))
            for time, speed, least in self._turns
            if least and time <= t and speed
        ]
        if self.duration is not None and self.duration <= t and self.end_acceleration is not None:
            n = self._numbers
            reach = self.end_acceleration * self._context.sqrt(n.m / n.k)
            if reach:
                found.append((reach / (V + self._context.hypot(V, reach))) ** 2)
        return min(found) if found else None

    def motion(self, t: Number) -> tuple[Number, Number]:
        """Return speed u [m/s] and distance s (x - x_0) [m] at the time `t` [s]."""
        piece, tau = self._at(t)
        return value_at(piece.speed, tau), value_at(piece.distance, tau)

    def dry_friction(self, t: Number) -> Number:
        """Return the friction R [N] at the time `t` [s]."""
        piece, tau = self._at(t)
        return value_at(piece.friction, tau)

    def state(self, t: Number) -> tuple[Number, ...]:
        """Return the friction law's own state at the time `t` [s]."""
        if not self._start_state:
            return ()
        piece, tau = self._at(t)
        return tuple(value_at(each, tau) for each in piece.state)

    def work_and_heat(self, t: Number, speed: Number, distance: Number) -> tuple[Number, Number]:
        """Return work done by the pulled end and heat [J] from the start to `t` [s]."""
        piece, tau = self._at(t)
        work = self._V * (value_at(piece.impulse, tau) - self._F_ext * t)
        return work, value_at(piece.heat, tau)

    def top_speed(self, t: Number) -> Number:
        """Return the largest |u| [m/s] between the start and `t` [s]."""
        turns = (abs(speed) for time, speed, _ in self._turns if time <= t)
        return max(abs(self.speed), abs(self.motion(t)[0]) if t else 0, *turns)

    def _reached(self) -> Number:
        if not self._pieces:
            return self._context.zero
        return self._pieces[-1].begin + self._pieces[-1].length

    def _at(self, t: Number) -> tuple[_Piece, Number]:
        """Return the piece that holds the time `t`, and the time from its beginning on."""
        if not self._pieces:
            self._go_on()
        piece = self._pieces[max(bisect_right(self._begins, t) - 1, 0)]
        return piece, t - piece.begin

    def _go_on(self) -> None:
        """Append the next piece and look for turns and the end of the slip in it."""
        piece = self._next_piece()
        self._pieces.append(piece)
        self._begins.append(piece.begin)
        context, u = self._context, piece.speed
        slope = derivative(u)
        overlap = piece.length * context.ldexp(1, -_OVERLAP_BITS)
        turns = polynomial_zeros(context, slope, piece.length + overlap)
        # From rest u has a zero at 0 itself, which is divided out.
        order = next((n for n, term in enumerate(u) if term), 0) if u[0] == 0 else 0
        signs = u[order:]
        before = context.zero
        for t in [*turns, piece.length]:
            if t < before:
                continue
            at = value_at(u, t)
            touching = context.ldexp(self._largest, _TOUCH_BITS - context.prec)
            touches = t in turns and abs(at) <= touching
            if self._friction.signed or not (touches or value_at(signs, t) <= 0):
                self._largest = max(self._largest, abs(at))
                if t in turns:
                    bent = value_at(derivative(slope), t)
                    self._turns.append((piece.begin + t, at, bent > 0))
                before = t
                continue
            if touches:
                self.end_acceleration = context.zero
            else:
                t = bracketed_zero(context, polynomial(signs), before, t)
                self.end_acceleration = value_at(slope, t)
            self.duration = piece.begin + t
            return

    def _next_piece(self) -> _Piece:
        """Return the piece that follows the last one."""
        context, n = self._context, self._numbers
        if self._pieces:
            last = self._pieces[-1]
            starts = [
                value_at(each, last.length)
                for each in (last.speed, last.pull, last.distance, last.heat, last.impulse)
            ]
            begin = last.begin + last.length
            own = [value_at(each, last.length) for each in last.state]
        else:
            starts = [self.speed, self._force, *([context.zero] * 3)]
            begin, own = context.zero, list(self._start_state)
        u = Series.unknown(context, starts[0])
        P = Series.unknown(context, starts[1])
        state = [Series.unknown(context, each) for each in own]
        R = self._friction.force(u, state)
        rates = self._friction.rates(u, state)
        heating = (R + u * n.c) * u
        for order in range(self._order):
            over = order + 1
            rate = P.term(order) - R.term(order) - n.c * u.term(order)
            drift = (self._V if order == 0 else context.zero) - u.term(order)
            following = [each.term(order) / over for each in rates]
            u.terms.append(rate / (n.m * over))
            P.terms.append(n.k * drift / over)
            for each, term in zip(state, following, strict=True):
                each.terms.append(term)
        for each in (R, heating, *rates):
            each.term(self._order)
        series = {id(part): part for each in (heating, P, *rates) for part in each.all_parts()}
        length = min(
            [
                _LONGEST * context.sqrt(n.m / n.k),
                *(_length(context, part.terms) for part in series.values()),
            ]
        )
        length = self._checked(length, u.terms, P.terms, [each.terms for each in state])
        distance, heat, impulse = (integral(each.terms) for each in (u, heating, P))
        for terms, start in zip((distance, heat, impulse), starts[2:], strict=True):
            terms[0] = start
        return _Piece(
            begin,
            length,
            u.terms,
            P.terms,
            R.terms,
            distance,
            heat,
            impulse,
            [each.terms for each in state],
        )

    def _checked(
        self,
        length: Number,
        u: Sequence[Number],
        P: Sequence[Number],
        state: Sequence[Sequence[Number]],
    ) -> Number:
        """Return `length`, halved until the equation of motion holds at its end."""
        context, n = self._context, self._numbers
        slope = derivative(u)
        for _ in range(_MOST_HALVINGS):
            speed, force = value_at(u, length), value_at(P, length)
            own = [Series(context, [value_at(each, length)]) for each in state]
            dry = self._friction.force(Series(context, [speed]), own).term(0)
            terms = (n.m * value_at(slope, length), -force, dry, n.c * speed)
            largest = max(*(abs(each) for each in terms), abs(P[0]))
            if abs(context.fsum(terms)) <= context.ldexp(largest, _DEFECT_BITS - context.prec):
                return length
            length /= 2
        raise ValueError(
            f"the friction law is no analytic function of speed near {context.nstr(u[0], 6)} m/s"
        )


def _length(context: Context, terms: Sequence[Number]) -> Number:
    """Return the longest time [s] at which the last quarter of a series is rounding.

    The terms of the last quarter are then below 2^-(prec - 16) of the largest term, and what
    follows them is less by the ratio of the terms at the quarter's beginning and end.
    """
    sizes = [(n, context.mag(term)) for n, term in enumerate(terms) if term]
    tail = [each for each in sizes if each[0] >= len(terms) * 3 // 4]
    if not tail:
        return context.inf
    lost = context.prec - _ROUNDING_BITS
    low, high = -4096.0, 4096.0
    for _ in range(24):
        middle = (low + high) / 2
        if max(size + n * middle for n, size in tail) + lost <= max(
            size + n * middle for n, size in sizes
        ):
            low = middle
        else:
            high = middle
    return context.mpf(2) ** low
