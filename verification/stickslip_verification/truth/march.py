"""A slip under any friction that is analytic in the speed between corners, by Taylor series.

The slip is laid out in pieces (`pieces`), each a Taylor series of the motion. It ends at the first
zero of u = s x_dot. Between two turns of u, which are isolated by bounds (`zeros`), u is monotone,
so its sign at turns and ends decides: no zero is missed, however shallow. A corner of the friction
is met where u passes its speed, a knot; that is isolated by the same bounds.
"""

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

from .parameters import Context, Number, Numbers, sign
from .series import (
    Series,
    bracketed_zero,
    derivative,
    integral,
    polynomial,
    polynomial_zeros,
    value_at,
)

_ROUNDING_BITS = 16  # a series is cut where its last eighth is below 2^16 of its roundings
_STEP_BITS, _LENGTH_BITS = 4096.0, 0.03125
"""Bounds of the length of a piece; it is known to 2^(1/32), of which the shorter side counts."""
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
    between knots, and returns the friction [N]; ``rates`` takes the same and returns the rates of
    the own state. Where there is no inertia, ``velocity`` [m/s] follows from the own state.
    """

    force: Callable[[Series, Sequence[Series], int], Series]
    rates: Callable[[Series, Sequence[Series], int], Sequence[Series]]
    signed: bool = False  # whether the law has no stick: then u may change its sign
    knots: Sequence[Number] = ()  # rising speeds [m/s] at which the friction has a corner
    velocity: Callable[[Sequence[Series]], Series] | None = None
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
        courses = (self.speed, self.pull, self.distance, self.heat, self.impulse)
        speed, pull, distance, heat, impulse = (value_at(each, self.length) for each in courses)
        state = [value_at(each, self.length) for each in self.state]
        return Start(self.begin + self.duration, speed, pull, distance, heat, impulse, state)


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
        P = Series.unknown(context, start.pull)
        state = [Series.unknown(context, each) for each in start.state]
        velocity = self._friction.velocity
        u = velocity(state) if velocity else Series.unknown(context, start.speed)
        R = frozen or self._friction.force(u, state, band)
        rates = self._friction.rates(u, state, band)
        heating = (R + u * n.c) * u
        for order in range(self._order):
            over = order + 1
            drift = (self._V if order == 0 else context.zero) - u.term(order)
            following = [each.term(order) / over for each in rates]
            if not velocity:
                rate = P.term(order) - R.term(order) - n.c * u.term(order)
                u.terms.append(rate / (n.m * over))
            P.terms.append(n.k * drift / over)
            for each, term in zip(state, following, strict=True):
                each.terms.append(term)
        for each in (R, heating, *rates):
            each.term(self._order)
        length = self._shortest_of([heating, P, *rates])
        if not velocity:
            length = min(length, _LONGEST * context.sqrt(n.m / n.k))
        slope = derivative(u.terms)

        def forces(t: Number) -> list[Number]:
            speed, force = value_at(u.terms, t), value_at(P.terms, t)
            own = [Series(context, [value_at(each.terms, t)]) for each in state]
            dry = frozen or self._friction.force(Series(context, [speed]), own, band)
            inertia = 0 if velocity else n.m * value_at(slope, t)
            return [inertia, -force, dry.term(0), n.c * speed]

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
    begin = len(terms) * 7 // 8
    head, tail = ([each for each in sizes if (each[0] >= begin) is last] for last in (False, True))
    if not tail:
        return context.inf
    lost = context.prec - _ROUNDING_BITS
    # In the logarithm of the step each size is a line, those of the tail are the steeper ones.
    longest = min(
        max(((high - low - lost) / (m - n) for n, high in head), default=-_STEP_BITS)
        for m, low in tail
    )
    longest = _LENGTH_BITS * math.floor(longest / _LENGTH_BITS)
    return context.mpf(2) ** max(-_STEP_BITS, min(longest, _STEP_BITS))


_TOUCH_BITS = 44
"""A turn of u within 2^44 roundings of the largest speed from zero counts as zero: rounding of
some hundred pieces, amplified; see `docs/theory.md (5)` for a slip that touches zero."""
_OVERLAP_BITS = 20  # turns are looked for up to 2^-20 of a piece beyond its end: none is missed
_KNOT_BITS = 16  # a piece that ends within 2^16 roundings of the largest speed from a knot is on it


class March:
    """A slip from its start (or the last change of a parameter) on; times count from there.

    It starts in the `direction` s with the `speed` u [m/s], exactly 0 from rest, else positive,
    with u' = `acceleration` [m/s2] and the friction law's own `state`. ``duration`` [s] is the time
    to its end, None if `reach` has met none yet; ``end_acceleration`` [m/s2] is u' there, <= 0,
    exactly 0 where u only touches zero.
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
        self._make = Pieces(context, numbers, friction, self._V)
        self._largest = max(abs(speed), abs(self._V))
        self._band = bisect_left(friction.knots, speed)
        self._met: Number | None = None
        if speed in friction.knots:
            self._meet(speed, acceleration)
        self._force = n.m * acceleration + self._dry(speed) + n.c * speed
        self._pieces: list[Piece] = []
        self._begins: list[Number] = []
        self._turns: list[tuple[Number, Number, bool]] = []
        self._s = -1 if self._V < 0 else 1
        self._ahead = self._s * (speed - self._V) > 0
        self._passes: list[tuple[Number, bool]] = []

    def reach(self, t: Number) -> None:
        """Follow the slip up to the time `t` [s], or to its end if that is earlier."""
        while self.duration is None and self._reached() < t:
            self._go_on()

    def stays(self, changed: Numbers, t: Number) -> bool:
        """Return whether the slip goes on as it is with `changed` numbers: it begins anew."""
        return False

    def decision(self, t: Number) -> Number | None:
        """Return how clearly the slip has ended or gone on up to `t`; None if nothing decided.

        The smallest |u| / (|V| + |u - V|) at the least speeds passed by. At the end of the slip
        q^2 / (|V| + hypot(V, q))^2 with q = u' sqrt(m/k), which is the same for a slip without
        damping. Of a law without a stick, the smallest |u - V| / (|V| + |u|) at the turns of u.
        """
        V = abs(self._V)
        if self._friction.signed:
            turns = [speed for time, speed, _ in self._turns if time <= t and speed != self._V]
            return min((abs(speed - self._V) / (V + abs(speed)) for speed in turns), default=None)
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
        # A turn on a knot may be lost between the two pieces that meet there.
        ends = (abs(each.speed[0]) for each in self._pieces if each.begin <= t)
        return max(abs(self.speed), abs(self.motion(t)[0]) if t else 0, *turns, *ends)

    def passes(self, begin: Number, end: Number) -> list[tuple[Number, bool]]:
        """Return when u passes V in (begin, end] [s], and whether it is beyond it from then on.

        A pass at the very start of the slip counts where `begin` is below 0.
        """
        return [each for each in self._passes if begin < each[0] <= end]

    def farthest(self, begin: Number, end: Number) -> Number:
        """Return the largest speed along the pull [m/s] between two times."""
        turns = [speed for time, speed, _ in self._turns if begin <= time <= end]
        ends = [self.motion(t)[0] if t else self.speed for t in (begin, end)]
        return max(self._s * speed for speed in (*turns, *ends))

    def _note_passes(self, piece: Piece) -> None:
        """Note where u passes V in a piece: where its side changes between the zeros of u - V."""
        off = [piece.speed[0] - self._V, *piece.speed[1:]]
        zeros = polynomial_zeros(self._context, off, piece.length)
        for begin, end in pairwise([self._context.zero, *zeros, piece.length]):
            side = self._s * sign(value_at(off, (begin + end) / 2))
            if side and (side > 0) != self._ahead:
                self._ahead = side > 0
                self._passes.append((piece.begin + begin, self._ahead))

    def _reached(self) -> Number:
        if not self._pieces:
            return self._context.zero
        return self._pieces[-1].begin + self._pieces[-1].duration

    def _at(self, t: Number) -> tuple[Piece, Number]:
        """Return the piece that holds the time `t`, and what its polynomials take there."""
        if not self._pieces:
            self._go_on()
        piece = self._pieces[max(bisect_right(self._begins, t) - 1, 0)]
        return piece, piece.argument(self._context, t)

    def _go_on(self) -> None:
        """Append the next piece and look for turns and the end of the slip in it."""
        piece = self._next_piece()
        self._pieces.append(piece)
        self._begins.append(piece.begin)
        context, u = self._context, piece.speed
        if piece.clock is not None:
            # Monotone, and above 0 to its end.
            self._largest = max(self._largest, abs(piece.end().speed))
            return
        if self._friction.signed:
            self._note_passes(piece)
        slope = derivative(u)
        # Beyond a knot the polynomial is not the motion any more.
        overlap = piece.length * context.ldexp(1, -_OVERLAP_BITS) if self._met is None else 0
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

    def _next_piece(self) -> Piece:
        zero = self._context.zero
        if self._pieces:
            start = self._pieces[-1].end()
        else:
            start = Start(zero, self.speed, self._force, zero, zero, zero, self._start_state)
        if self._met is not None and not self._friction.velocity:
            start = start._replace(speed=self._met)
        near = self._friction.near_rest
        piece = None if near is None else self._near_rest(start, near)
        return piece or self._until_knot(self._make.in_time(start, self._band))

    def _until_knot(self, piece: Piece) -> Piece:
        """Return the piece up to where u first meets a knot, and change to the band beyond it."""
        context, knots = self._context, self._friction.knots
        self._met = None
        rounding = context.ldexp(self._largest, _KNOT_BITS - context.prec)
        first, met = piece.length, None
        for knot in knots[max(self._band - 1, 0) : self._band + 1]:
            away = [piece.speed[0] - knot, *piece.speed[1:]]
            if value_at([abs(each) for each in away], piece.length) <= rounding:
                continue  # the mass slides at the knot's speed
            zeros = polynomial_zeros(context, away, piece.length)
            if not zeros and abs(value_at(away, piece.length)) <= rounding:
                zeros = [piece.length]
            if zeros and (met is None or zeros[0] < first):
                first, met = zeros[0], knot
        if met is None:
            return piece
        self._meet(met, value_at(derivative(piece.speed), first))
        return replace(piece, length=first)

    def _meet(self, knot: Number, slope: Number) -> None:
        """Change to the band that u enters from a knot with u' = `slope` [m/s2].

        Where u' = 0, the sign of m u'' = k (V - u) decides; where that is 0 too, u stays.
        """
        context, n = self._context, self._numbers
        none = context.ldexp(self._largest, _TOUCH_BITS - context.prec) * context.sqrt(n.k / n.m)
        direction = sign(slope) if abs(slope) > none else sign(self._V - knot)
        if direction:
            self._band = bisect_left(self._friction.knots, knot) + (direction > 0)
        self._met = knot

    def _dry(self, speed: Number) -> Number:
        """Return the friction [N] at a speed, for the own state at the start."""
        own = [Series(self._context, [each]) for each in self._start_state]
        return self._friction.force(Series(self._context, [speed]), own, self._band).term(0)

    def _near_rest(self, start: Start, near: NearRest) -> Piece | None:
        """Return the next piece where the friction has no Taylor series at u = 0, or None.

        Below a speed at which the friction's change from rest, over the time spent there, is less
        than a rounding of the slip's impulse gap/w, that change is left out. Above it, up to a part
        of the law's own speed, u is monotone if the spring's force, c u and the friction cannot
        turn u'; then the piece is one in ln u. None: neither holds, a piece in time it is.
        """
        context, n, V, u = self._context, self._numbers, self._V, start.speed
        w = context.sqrt(n.k / n.m)
        rate = (start.pull - self._dry(u) - n.c * u) / n.m
        lost = context.ldexp(near.speed**near.exponent, -context.prec)
        if rate < 0:
            room = n.m * -rate / 2 - n.c * u - 2 * n.k * max(abs(V), abs(V - u)) * u / -rate
            if u > near.speed / 4 or room < 0:
                return None
            least = (lost * n.m * rate * rate / (near.gap * w)) ** (1 / (1 + near.exponent))
            if u > 2 * least:
                return self._make.in_logarithm(start, least)
            return self._make.in_time(start, self._band, self._at_rest())
        half = context.mpf(1) / 2
        limits = []
        if V > 0:
            slow = (lost * context.sqrt(V / 2)) ** (1 / (near.exponent + half))
            limits.append((slow, context.sqrt(2 * slow / V) / w))
        if rate > 0:
            slow = (lost * rate / w) ** (1 / (near.exponent + 1))
            limits.append((slow, slow / rate))
        slow = max((each for each, _ in limits), default=context.inf)
        if u <= slow:
            piece = self._make.in_time(start, self._band, self._at_rest())
            return replace(piece, length=min([piece.length, *(time for _, time in limits)]))
        reach = n.m * rate * rate / (16 * n.k)
        way = (
            max(V - u, context.sqrt(reach))
            if u < V
            else min(context.sqrt(reach), reach / (u - V) if u > V else context.inf)
        )
        if n.c:
            way = min(way, n.m * rate / (4 * n.c))
        end = min(u + way, near.speed / 4)
        return self._make.in_logarithm(start, end) if end >= 2 * u else None

    def _at_rest(self) -> Series:
        return Series(self._context, [self._dry(self._context.zero)])
