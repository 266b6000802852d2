"""Compensated sums: pairs of floats that keep what rounding would drop from a long sum.

A sum is a pair ``(high, low)``, the unevaluated sum of two floats with
``abs(low) <= ulp(high) / 2``: about 32 digits. Pairs are never changed in place, so states share
them.
"""

from typing import Tuple

Sum = Tuple[float, float]

ZERO: Sum = (0.0, 0.0)


def add(total: Sum, term: float) -> Sum:
    """Return the sum with one more term.

    Source: Knuth, The Art of Computer Programming, vol. 2, 4.2.2, theorem B.
    """
    start, low = total
    high = start + term
    shadow = high - start
    low += (start - (high - shadow)) + (term - shadow)
    rounded = high + low
    return rounded, low - (rounded - high)
