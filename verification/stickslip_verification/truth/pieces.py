"""Pieces of a slip: the Taylor series of its motion about the beginning of a piece.

Counted along the slip, with the speed u = s x_dot >= 0, the force P = s (k z + F_ext) of spring and
surroundings, the pull V = s v and the friction R(u), docs/theory.md (1), (15):

    m u' = P - R(u) - c u          P' = k (V - u)
    distance' = u                  heat' = (R + c u) u          work of the pull' = V (P - s F_ext)

The friction law may have state variables of its own, with rates that depend on u and on them. One
piece holds the Taylor series of all of these. Its length comes from the coefficients of every
series in it, those inside the friction law's expression too; then the equation of motion is checked
at the piece's end against the law's own values there.

Two things have no Taylor series in time. At a knot, a speed at which the friction has a corner, a
piece ends; the friction of the band between two knots holds a little beyond both. And a friction
that changes from rest as u^e with e not whole has none at u = 0. It is analytic in ln u; so below a
speed that the law names, and while u is monotone there, the independent variable is sigma = |ln u|:

    dt = u dsigma / |u'|           u = u_0 exp(+-sigma)

Such a piece covers a factor of some ten in the speed, where one in time would cover a sixth.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from stickslip_verification.truth.parameters import Context, Number, Numbers
from stickslip_verification.truth.series import Series, derivative, integral, value_at
from stickslip_verification.truth.zeros import bracketed_zero

_ROUNDING_BITS = 16  # a series is cut where its last eighth is below 2^16 of its roundings
_LENGTH_BITS = 0.05  # the length of a piece is known to 2^0.05, of which the shorter side counts
_DEFECT_BITS = 30
"""The equation of motion must hold to 2^30 roundings at the end of a piece: the derivative of a
series of order 80 is known to some thousand times less than the series."""

_LONGEST = 8  # a piece, of 1/w, for series that end after a few terms; in sigma as it is
_MOST_HALVINGS = 40  # a piece still wrong at 1e-12 of the length of its series meets a kink


class NearRest(NamedTuple):
    """A friction that changes from rest by ``gap (u/speed)^exponent`` [N], exponent not whole.

    It is analytic in ln u below about `speed` [m/s].
    """

    speed: Number
    exponent: Number
    gap: Number


@dataclass(frozen=True)
class Friction:
    """What a friction law gives a march, under constant parameters.

    ``force`` takes the series of the speed [m/s], those of the own state and the number of the band
    between knots, and returns the friction [N]; ``rates`` takes the first two and returns the rates
    of the own state.
    """

    force: Callable[[Series, Sequence[Series], int], Series]
    rates: Callable[[Series, Sequence[Series]], Sequence[Series]]
    signed: bool = False  # whether the law has no stick: then u may change its sign
    knots: Sequence[Number] = ()  # rising speeds > 0 [m/s] at which the friction has a corner
    near_rest: NearRest | None = None  # where it has no Taylor series at u = 0, and no own state


class Start(NamedTuple):
    """The motion at the beginning of a piece: times, forces and lengths as in `Piece`."""

    begin: Number
    speed: Number
    pull: Number
    distance: Number
    heat: Number
    impulse: Number
    state: Sequence[Number]


@dataclass(frozen=True)
class Piece:
    """Polynomials from the time `begin` on, of `length` [s] or, with a `clock`, in sigma.

    `clock` gives the time since `begin`, or is None where the polynomials are of that time itself.
    """

    begin: Number
    length: Number
    speed: Sequence[Number]
    pull: Sequence[Number]
    friction: Sequence[Number]
    distance: Sequence[Number]
    heat: Sequence[Number]
    impulse: Sequence[Number]
    state: Sequence[Sequence[Number]]
    clock: Sequence[Number] | None = None

    @property
    def duration(self) -> Number:
        """Its length [s]."""
        return self.length if self.clock is None else value_at(self.clock, self.length)

    def argument(self, context: Context, t: Number) -> Number:
        """Return what the polynomials take at the time `t` [s] since the start of the slip."""
        elapsed = t - self.begin
        clock = self.clock
        if clock is None or elapsed <= 0:
            return elapsed
        if elapsed >= self.duration:
            return self.length
        slopes = derivative(clock)
        return bracketed_zero(
            context,
            lambda each: (value_at(clock, each) - elapsed, value_at(slopes, each)),
            context.zero,
            self.length,
        )

    def end(self) -> Start:
        """Return the motion at its end."""
        at = self.length
        return Start(
            begin=self.begin + self.duration,
            speed=value_at(self.speed, at),
            pull=value_at(self.pull, at),
            distance=value_at(self.distance, at),
            heat=value_at(self.heat, at),
            impulse=value_at(self.impulse, at),
            state=[value_at(each, at) for each in self.state],
        )


class Pieces:
    """Makes the pieces of a slip whose pulled end moves at `V` [m/s] along it."""

    def __init__(self, context: Context, numbers: Numbers, friction: Friction, V: Number) -> None:
        self._context = context
        self._numbers = numbers
        self._friction = friction
        self._V = V
        self._order = context.prec * 7 // 20

    def in_time(self, start: Start, band: int, frozen: Series | None = None) -> Piece:
        """Return the piece in powers of time; `frozen` [N], if given, is the friction in it."""
        context, n = self._context, self._numbers
        u = Series.unknown(context, start.speed)
        P = Series.unknown(context, start.pull)
        state = [Series.unknown(context, each) for each in start.state]
        R = frozen or self._friction.force(u, state, band)
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
        length = min(_LONGEST * context.sqrt(n.m / n.k), self._shortest_of([heating, P, *rates]))
        slope = derivative(u.terms)

        def forces(t: Number) -> list[Number]:
            speed, force = value_at(u.terms, t), value_at(P.terms, t)
            own = [Series(context, [value_at(each.terms, t)]) for each in state]
            dry = frozen or self._friction.force(Series(context, [speed]), own, band)
            return [n.m * value_at(slope, t), -force, dry.term(0), n.c * speed]

        length = self._checked(length, forces, start)
        return self._piece(start, length, u, P, R, [u, heating, P], state)

    def in_logarithm(self, start: Start, end: Number) -> Piece:
        """Return the piece in powers of sigma, at most up to the speed `end` [m/s]."""
        context, n = self._context, self._numbers
        along = 1 if end > start.speed else -1
        powers = [start.speed]
        for order in range(self._order):
            powers.append(along * powers[-1] / (order + 1))
        u = Series(context, powers)
        P = Series.unknown(context, start.pull)
        R = self._friction.force(u, [], 0)
        dt = u * (along * n.m) / (P - R - u * n.c)
        loading = (self._V - u) * dt * n.k
        heating = (R + u * n.c) * u * dt
        rates = [u * dt, heating, P * dt]
        for order in range(self._order):
            P.terms.append(loading.term(order) / (order + 1))
        for each in (u, R, dt, *rates):
            each.term(self._order)
        longest = min(context.mpf(_LONGEST), along * context.log(end / start.speed))
        length = min(longest, self._shortest_of([*rates, loading]))
        slope = derivative(P.terms)

        def forces(sigma: Number) -> list[Number]:
            speed, force = value_at(u.terms, sigma), value_at(P.terms, sigma)
            dry = self._friction.force(Series(context, [speed]), [], 0).term(0)
            net = force - dry - n.c * speed
            step = along * n.m * speed / net
            return [value_at(slope, sigma), -n.k * (self._V - speed) * step]

        length = self._checked(length, forces, start)
        piece = self._piece(start, length, u, P, R, rates, [])
        return replace(piece, clock=integral(dt.terms))

    def _piece(
        self,
        start: Start,
        length: Number,
        u: Series,
        P: Series,
        R: Series,
        rates: Sequence[Series],
        state: Sequence[Series],
    ) -> Piece:
        """Return the piece; `rates` are those of distance, heat and impulse."""
        distance, heat, impulse = (integral(each.terms) for each in rates)
        distance[0], heat[0], impulse[0] = start.distance, start.heat, start.impulse
        own = [each.terms for each in state]
        return Piece(start.begin, length, u.terms, P.terms, R.terms, distance, heat, impulse, own)

    def _shortest_of(self, wholes: Sequence[Series]) -> Number:
        """Return the longest step at which every series that these are made of still holds."""
        series = {id(part): part for each in wholes for part in each.all_parts()}
        return min(_length(self._context, part.terms) for part in series.values())

    def _checked(
        self, length: Number, forces: Callable[[Number], Sequence[Number]], start: Start
    ) -> Number:
        """Return `length`, halved until the terms of the equation of motion sum up to 0 there."""
        context = self._context
        for _ in range(_MOST_HALVINGS):
            terms = forces(length)
            largest = max(*(abs(each) for each in terms), abs(start.pull))
            if abs(context.fsum(terms)) <= context.ldexp(largest, _DEFECT_BITS - context.prec):
                return length
            length /= 2
        raise ValueError(
            "the friction law is no analytic function of speed near "
            f"{context.nstr(start.speed, 6)} m/s"
        )


def _length(context: Context, terms: Sequence[Number]) -> Number:
    """Return the longest step at which the last eighth of a series is rounding.

    The terms of the last eighth are then below 2^-(prec - 16) of the largest term, and what
    follows them is less by the ratio of the terms at the eighth's beginning and end.
    """
    sizes = [(n, context.mag(term)) for n, term in enumerate(terms) if term]
    tail = [each for each in sizes if each[0] >= len(terms) * 7 // 8]
    if not tail:
        return context.inf
    lost = context.prec - _ROUNDING_BITS
    low, high = -4096.0, 4096.0
    while high - low > _LENGTH_BITS:
        middle = (low + high) / 2
        if max(size + n * middle for n, size in tail) + lost <= max(
            size + n * middle for n, size in sizes
        ):
            low = middle
        else:
            high = middle
    return context.mpf(2) ** low
