"""Zeros of polynomials and of monotone functions, isolated by bounds and not by signs at ends.

In the Bernstein basis of an interval the number of sign changes among the coefficients is at least
the number of zeros inside, and exceeds it by an even number (R. T. Farouki, The Bernstein
polynomial basis: a centennial retrospective, Computer Aided Geometric Design 29 (2012) 379-419,
doi 10.1016/j.cagd.2012.03.001). So no sign change proves that there is no zero, one that there is
exactly one, and with more the interval is halved.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

from stickslip_verification.truth.parameters import Context, Number, root_tolerance, sign
from stickslip_verification.truth.series import polynomial, value_at

_NOISE_BITS = 12
"""A Bernstein coefficient below 2^12 roundings of the largest is rounding."""


def polynomial_zeros(context: Context, terms: Sequence[Number], end: Number) -> list[Number]:
    """Return the zeros of a polynomial in (0, end), in order.

    Parameters
    ----------
    terms
        Coefficients of t^0, t^1, ...
    end
        End of the interval, > 0.

    Notes
    -----
    Two zeros nearer than half of the context's digits are told apart only if the polynomial
    between them is more than rounding. A point where it touches zero may be returned or not; a
    zero where the interval is halved may be returned twice, and one at `end` be missing.
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
    context: Context,
    function: Callable[[Number], tuple[Number, Number]],
    low: Number,
    high: Number,
) -> Number:
    """Return the zero of a function that changes its sign between `low` and `high`.

    Parameters
    ----------
    function
        Gives value and derivative. What it gives at `low` and `high` themselves is not looked at
        but for the sign at `high`.
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

    A step is cut where it leaves the bracket or does not halve the last one, so that it ends
    whatever the function does. A step is small beside t, or beside the bracket where the zero lies
    at its very start.

    Parameters
    ----------
    function
        Whether the zero lies at t or before, and the step to it; None where there is none.
    """
    tolerance = root_tolerance(context)
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
