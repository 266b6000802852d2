"""Arithmetic of Taylor series in high precision, coefficient by coefficient.

A `Series` computes a coefficient when it is asked for, from coefficients of no higher order of the
series that it is made of. So a differential equation can be solved by recurrence: the coefficients
of the unknown are appended as they become known, and those of any expression in it follow.
Formulas: E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed.,
Springer 1993, section I.8.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise

from .parameters import Context, Number, sign

Rule = Callable[[int], Number]


class Series:
    """A power series in the time since the point of expansion.

    Supports ``+ - * /`` with series and numbers, ``**`` with a number, `exp` and `log`. It begins
    with `terms`; `rule`, which reads the series `parts`, gives the coefficients of higher orders,
    else 0.
    """

    def __init__(
        self,
        context: Context,
        terms: Sequence[Number],
        rule: Rule | None = None,
        parts: tuple[Series, ...] = (),
    ) -> None:
        self.context = context
        self.terms = list(terms)
        self._rule = rule or (lambda order: context.zero)
        self._parts = parts
        self._scaled: list[Number] = []

    @classmethod
    def unknown(cls, context: Context, start: Number) -> Series:
        """Return the series of an unknown that starts at `start`; append to its ``terms``."""

        def missing(order: int) -> Number:
            raise LookupError(f"the coefficient of order {order} is not known yet")

        return cls(context, [start], missing)

    @classmethod
    def variable(cls, context: Context, start: Number) -> Series:
        """Return the series of ``start + t``."""
        return cls(context, [start, context.one])

    def term(self, order: int) -> Number:
        """Return the coefficient of t^order."""
        while len(self.terms) <= order:
            self.terms.append(self._rule(len(self.terms)))
        return self.terms[order]

    def all_parts(self) -> Iterator[Series]:
        """Yield this series and every series that it is made of."""
        yield self
        for part in self._parts:
            yield from part.all_parts()

    def exp(self) -> Series:
        """Return e to this series."""
        result = self._made(self.context.exp(self.term(0)))

        def rule(n: int) -> Number:
            return self._dot_of_slope(result, n) / n

        result._rule = rule
        return result

    def log(self) -> Series:
        """Return the natural logarithm of this series; its value must be > 0."""
        self._check(self.term(0) > 0, "the logarithm")
        result = self._made(self.context.log(self.term(0)))

        def rule(n: int) -> Number:
            inner = result._dot_of_slope(self, n, n - 1) if n > 1 else 0
            return (self.term(n) - inner / n) / self.term(0)

        result._rule = rule
        return result

    def __pow__(self, exponent: Number) -> Series:
        if exponent == int(exponent) and exponent >= 0:
            return self._whole_power(int(exponent))
        self._check(self.term(0) > 0 or exponent == int(exponent), "a power")
        self._check(self.term(0) != 0, "a power")
        result = self._made(self.term(0) ** self.context.mpf(exponent))

        def rule(n: int) -> Number:
            weighted = (exponent + 1) * self._dot_of_slope(result, n)
            plain = self.context.fdot(self.terms[1 : n + 1], result.terms[n - 1 :: -1])
            return (weighted / n - plain) / self.term(0)

        result._rule = rule
        return result

    def __add__(self, other: Series | Number) -> Series:
        if isinstance(other, Series):
            return self._of(other, lambda n: self.term(n) + other.term(n))
        return self._of(None, lambda n: self.term(n) if n else self.term(0) + other)

    def __neg__(self) -> Series:
        return self._of(None, lambda n: -self.term(n))

    def __sub__(self, other: Series | Number) -> Series:
        return self + -other

    def __rsub__(self, other: Number) -> Series:
        result: Series = -self + other
        return result

    def __mul__(self, other: Series | Number) -> Series:
        if not isinstance(other, Series):
            return self._of(None, lambda n: self.term(n) * other)

        def rule(n: int) -> Number:
            other.term(n)
            self.term(n)
            return self.context.fdot(self.terms[: n + 1], other.terms[n::-1])

        return self._of(other, rule)

    def __truediv__(self, other: Series | Number) -> Series:
        if not isinstance(other, Series):
            return self._of(None, lambda n: self.term(n) / other)
        inverse: Series = other.__rtruediv__(self.context.one)
        return self * inverse

    def __rtruediv__(self, other: Number) -> Series:
        self._check(self.term(0) != 0, "a quotient")
        result = self._made(other / self.term(0))

        def rule(n: int) -> Number:
            self.term(n)
            return -self.context.fdot(self.terms[1 : n + 1], result.terms[n - 1 :: -1]) / self.term(
                0
            )

        result._rule = rule
        return result

    __radd__ = __add__
    __rmul__ = __mul__

    def _of(self, other: Series | None, rule: Rule) -> Series:
        parts = (self,) if other is None else (self, other)
        return Series(self.context, [], rule, parts)

    def _made(self, value: Number) -> Series:
        return Series(self.context, [value], None, (self,))

    def _dot_of_slope(self, other: Series, n: int, last: int | None = None) -> Number:
        """Return the sum over i = 1 .. last (n by default) of i a_i b_(n-i), b being `other`."""
        last = n if last is None else last
        for order in range(len(self._scaled), last + 1):
            self._scaled.append(order * self.term(order))
        others = [other.term(order) for order in range(n - 1, n - last - 1, -1)]
        return self.context.fdot(self._scaled[1 : last + 1], others)

    def _whole_power(self, exponent: int) -> Series:
        result = self if exponent else Series(self.context, [self.context.one])
        for _ in range(exponent - 1):
            result = result * self
        return result

    def _check(self, good: bool, what: str) -> None:
        if not good:
            raise ValueError(f"{what} has no Taylor series at the value {self.term(0)}")


def value_at(terms: Sequence[Number], t: Number) -> Number:
    """Return the polynomial with these coefficients at `t`."""
    value = terms[-1]
    for term in reversed(terms[:-1]):
        value = value * t + term
    return value


def derivative(terms: Sequence[Number]) -> list[Number]:
    """Return the coefficients of the derivative."""
    return [n * term for n, term in enumerate(terms)][1:]


def polynomial(terms: Sequence[Number]) -> Callable[[Number], tuple[Number, Number]]:
    """Return the function that gives value and derivative of the polynomial."""
    slopes = derivative(terms)
    return lambda t: (value_at(terms, t), value_at(slopes, t))


def integral(terms: Sequence[Number]) -> list[Number]:
    """Return the coefficients of the integral that is 0 at 0."""
    return [0 * terms[0], *(term / (n + 1) for n, term in enumerate(terms))]


_ROOT_BITS = 30
"""A root is done when its last step moves it by less than 2^30 roundings: the step itself still
squares the error, while nearer the rounding near-double roots only jitter."""
_NOISE_BITS = 12  # a Bernstein coefficient below 2^12 roundings of the largest is rounding


def polynomial_zeros(context: Context, terms: Sequence[Number], end: Number) -> list[Number]:
    """Return the zeros of a polynomial with the coefficients `terms` in (0, end), in order.

    Two zeros nearer than half of the context's digits are told apart only if the polynomial between
    them is more than rounding. A point where it touches zero may be returned or not; a zero where
    the interval is halved may be returned twice, and one at `end` be missing.
    """
    terms = list(terms)
    while terms and terms[0] == 0:
        del terms[0]
    if len(terms) < 2 or abs(terms[0]) > end * value_at([abs(a) for a in terms[1:]], end):
        return []
    found: list[Number] = []
    narrowest = context.ldexp(1, -context.prec // 2)
    pending = [(context.zero, context.one, _bernstein(context, terms, end))]
    while pending:
        begin, width, coefficients = pending.pop()
        noise = context.ldexp(max(abs(b) for b in coefficients), _NOISE_BITS - context.prec)
        signs = [sign(b) for b in coefficients if abs(b) > noise]
        changes = sum(a != b for a, b in pairwise(signs))
        low, high = begin * end, (begin + width) * end
        if changes == 1 and sign(value_at(terms, low)) * sign(value_at(terms, high)) < 0:
            found.append(bracketed_zero(context, polynomial(terms), low, high))
        elif changes and width < narrowest:
            if changes % 2:
                found.append((low + high) / 2)
        elif changes:
            left, right = _halves(coefficients)
            if abs(right[0]) <= noise:
                found.append((low + high) / 2)
            half = width / 2
            pending += [(begin, half, left), (begin + half, half, right)]
    return sorted(found)


def bracketed_zero(
    context: Context, function: Callable[[Number], tuple[Number, Number]], low: Number, high: Number
) -> Number:
    """Return the zero of a function that changes its sign between `low` and `high`.

    It gives value and derivative. What it gives at `low` and `high` themselves is not looked at but
    for the sign at `high`.
    """
    above = sign(function(high)[0])

    def newton(t: Number) -> tuple[bool, Number | None]:
        value, slope = function(t)
        return sign(value) == above, -value / slope if slope else None if value else value

    return safeguarded_zero(context, newton, low, high) if above else high


def safeguarded_zero(
    context: Context,
    function: Callable[[Number], tuple[bool, Number | None]],
    low: Number,
    high: Number,
) -> Number:
    """Return the zero between `low` and `high`, by steps cut to bisection.

    `function` says whether the zero lies at t or before, and the step to it; None where there is
    none. A step is cut where it leaves the bracket or does not halve the last one, so that it ends
    whatever the function does. A step is small beside t, or beside the bracket where the zero lies
    at its start.
    """
    tolerance = context.ldexp(1, _ROOT_BITS - context.prec)
    t = (low + high) / 2
    last = high - low
    negligible = tolerance * tolerance * last
    while True:
        is_before, step = function(t)
        low, high = (low, t) if is_before else (t, high)
        step = high - low if step is None else step
        near = abs(step) <= tolerance * abs(t)
        if not near and (not (low < t + step < high) or 2 * abs(step) > last):
            step = (low + high) / 2 - t
        t += step
        last = abs(step)
        if last <= tolerance * abs(t) or last <= negligible:
            return t


def _bernstein(context: Context, terms: Sequence[Number], end: Number) -> list[Number]:
    """Return the coefficients of a polynomial in the Bernstein basis of [0, end]."""
    degree = len(terms) - 1
    power, binomial = context.one, 1
    coefficients = []
    for n, term in enumerate(terms):
        coefficients.append(term * power / binomial)
        power *= end
        binomial = binomial * (degree - n) // (n + 1)
    for first in range(1, degree + 1):
        for n in range(degree, first - 1, -1):
            coefficients[n] += coefficients[n - 1]
    return coefficients


def _halves(coefficients: Sequence[Number]) -> tuple[list[Number], list[Number]]:
    """Return the coefficients on the two halves of the interval (de Casteljau)."""
    row = list(coefficients)
    left, right = [row[0]], [row[-1]]
    while len(row) > 1:
        row = [(a + b) / 2 for a, b in pairwise(row)]
        left.append(row[0])
        right.append(row[-1])
    return left, right[::-1]
