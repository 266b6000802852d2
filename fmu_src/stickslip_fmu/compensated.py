"""Sums that keep what rounding would drop, so that a million small terms lose nothing."""

from typing import List, Tuple


def add(high: float, low: float, term: float) -> Tuple[float, float]:
    """Add `term` to the unevaluated sum `high + low`.

    Returns the new pair with ``abs(low) <= ulp(high) / 2``, about 32 digits in all
    (Knuth, The Art of Computer Programming, vol. 2, 4.2.2, theorem B).
    """
    total = high + term
    shadow = total - high
    low += (high - (total - shadow)) + (term - shadow)
    high = total + low
    return high, low - (high - total)


class CompensatedSum:
    """A running sum of floats with a second float for what the first one cannot hold.

    `frozen` says that a state holds it: then it is to be copied before it is added to.
    """

    __slots__ = ("frozen", "high", "low")

    def __init__(self, start: float = 0.0) -> None:
        self.high = start
        self.low = 0.0
        self.frozen = False

    def add(self, term: float) -> None:
        """Add one term."""
        self.high, self.low = add(self.high, self.low, term)

    def plus(self, term: float) -> float:
        """Return the sum with one more term, without adding it."""
        return self.high + (self.low + term)

    def clear(self) -> None:
        """Start again from zero."""
        self.high = self.low = 0.0

    def copy(self) -> "CompensatedSum":
        """Return the same sum, to be added to by itself."""
        twin = CompensatedSum(self.high)
        twin.low = self.low
        return twin

    def save(self) -> List[float]:
        """Return the sum as two floats, for `restore`."""
        return [self.high, self.low]

    def restore(self, saved: List[float]) -> None:
        """Take up a sum that `save` returned."""
        self.high, self.low = saved
