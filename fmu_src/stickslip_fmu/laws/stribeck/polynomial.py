"""Polynomials on ``0 <= s <= end``: value, first zero and maximum, isolated by Bernstein bounds.

A polynomial is the list of its coefficients, that of ``s^0`` first. On an interval it lies between
the least and the largest of its Bernstein coefficients, and it is monotone or convex where these
are (Farouki and Rajan, Computer Aided Geometric Design 4, 1987, 191): no zero and no extreme is
missed between two points.
"""

from typing import List, Optional, Sequence, Tuple

from ...numerics.roots import falling_zero

# An interval this much shorter than the whole one is not divided again.
_NARROW = 2.0**-40


def value(coefficients: Sequence[float], s: float) -> float:
    """Return the value at `s`, by Horner's scheme from the highest power down."""
    total = 0.0
    for coefficient in reversed(coefficients):
        total = total * s + coefficient
    return total


def value_and_slope(coefficients: Sequence[float], s: float) -> Tuple[float, float]:
    """Return value and derivative at `s`, by Horner's scheme from the highest power down."""
    total = slope = 0.0
    for coefficient in reversed(coefficients):
        slope = slope * s + total
        total = total * s + coefficient
    return total, slope


def first_zero(coefficients: Sequence[float], end: float) -> Optional[float]:
    """Return the first s up to `end` at which a polynomial that starts above 0 reaches 0, or None.

    Intervals are halved from left to right until the polynomial is above 0, falls, or is convex.
    """
    if _stays_above(coefficients, end):
        return None
    whole = _bernstein(coefficients, end)
    waiting = [(whole, 0.0, end)]
    while waiting:
        bounds, low, high = waiting.pop()
        if min(bounds) > 0.0:
            continue
        narrow = high - low <= _NARROW * end
        if narrow or _falls(bounds):
            if bounds[-1] <= 0.0:
                return _falling_zero(coefficients, low, high)
        elif _bends(bounds, 1.0):
            if bounds[1] < bounds[0]:
                lowest = _turn(coefficients, low, high, -1.0)
                if value(coefficients, lowest) <= 0.0:
                    return _falling_zero(coefficients, low, lowest)
        else:
            left, right = _halves(bounds)
            middle = low + 0.5 * (high - low)
            waiting.append((right, middle, high))
            waiting.append((left, low, middle))
    return None


def highest(coefficients: Sequence[float], end: float) -> float:
    """Return the largest value from 0 to `end`.

    Intervals are halved from left to right until the polynomial is monotone, concave, or nowhere
    above the largest value found.
    """
    best = max(coefficients[0], value(coefficients, end))
    if _one_way(coefficients, end):
        return best
    waiting = [(_bernstein(coefficients, end), 0.0, end)]
    while waiting:
        bounds, low, high = waiting.pop()
        # The value at the right end; that at the left one was seen as the one before.
        best = max(best, bounds[-1])
        if max(bounds) <= best:
            continue
        # Concave and higher inside than at its ends, so it turns.
        if _bends(bounds, -1.0):
            best = max(best, value(coefficients, _turn(coefficients, low, high, 1.0)))
        elif high - low > _NARROW * end:
            left, right = _halves(bounds)
            middle = low + 0.5 * (high - low)
            waiting.append((right, middle, high))
            waiting.append((left, low, middle))
    return best


def _stays_above(coefficients: Sequence[float], end: float) -> bool:
    """Whether the first coefficient is larger than all that the others can take from it."""
    taken = 0.0
    for coefficient in reversed(coefficients[1:]):
        if coefficient < 0.0:
            taken -= coefficient
        taken *= end
    return coefficients[0] > taken * (1.0 + 2.0**-40)


def _one_way(coefficients: Sequence[float], end: float) -> bool:
    """Whether the first term of the derivative is larger than all others together."""
    others = 0.0
    for position in range(len(coefficients) - 1, 1, -1):
        others = (others + position * abs(coefficients[position])) * end
    return abs(coefficients[1]) > others * (1.0 + 2.0**-40)


def _bernstein(coefficients: Sequence[float], end: float) -> List[float]:
    """Return the Bernstein coefficients on 0 to `end`."""
    degree = len(coefficients) - 1
    bounds, power, choices = [], 1.0, 1.0
    for position in range(degree + 1):
        bounds.append(coefficients[position] * power / choices)
        power *= end
        choices = choices * (degree - position) / (position + 1)
    for first in range(1, degree + 1):
        for position in range(degree, first - 1, -1):
            bounds[position] += bounds[position - 1]
    return bounds


def _halves(bounds: Sequence[float]) -> Tuple[List[float], List[float]]:
    """Return the Bernstein coefficients on the two halves, by de Casteljau's scheme."""
    right = list(bounds)
    degree = len(right) - 1
    left = [right[0]]
    for last in range(degree, 0, -1):
        for position in range(last):
            right[position] = 0.5 * (right[position] + right[position + 1])
        left.append(right[0])
    return left, right


def _falls(bounds: Sequence[float]) -> bool:
    """Whether the Bernstein coefficients fall, so the polynomial does."""
    return all(bounds[position + 1] <= bounds[position] for position in range(len(bounds) - 1))


def _bends(bounds: Sequence[float], sign: float) -> bool:
    """Whether the Bernstein coefficients are convex, or concave for the sign -1."""
    for position in range(1, len(bounds) - 1):
        bend = (bounds[position + 1] - bounds[position]) - (bounds[position] - bounds[position - 1])
        if sign * bend < 0.0:
            return False
    return True


def _falling_zero(coefficients: Sequence[float], low: float, high: float) -> float:
    return falling_zero(lambda s: value_and_slope(coefficients, s), low, high)


def _turn(coefficients: Sequence[float], low: float, high: float, sign: float) -> float:
    """Return where the derivative times `sign` falls through 0, between `low` and `high`."""
    slopes = [sign * (power * coefficients[power]) for power in range(1, len(coefficients))]
    return falling_zero(lambda s: value_and_slope(slopes, s), low, high)
