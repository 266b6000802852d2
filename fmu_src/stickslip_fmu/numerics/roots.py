"""The zero of a falling function between two points that are known to enclose it."""

from typing import Callable, Tuple

# Newton's step doubles the digits and a halving adds one, so 200 is never reached; it only keeps
# a function that returns nonsense from looping for ever.
_MOST_STEPS = 200
# Below this relative step the next iterate would differ by rounding alone.
_SETTLED = 2.0**-52


def falling_zero(
    function: Callable[[float], Tuple[float, float]], low: float, high: float
) -> float:
    """Return the zero of a function that falls from above zero at `low` to below it at `high`.

    Newton's method kept inside the bracket: where a step would leave it, or would not halve the
    step before the last, the bracket is halved instead (Press et al., Numerical Recipes,
    3rd ed., 9.4).

    Parameters
    ----------
    function
        Returns value and slope; only the value's sign decides where the zero lies, so an
        inexact slope costs steps and not digits.
    low, high
        The bracket, ``low <= high``.
    """
    guess = low + 0.5 * (high - low)
    step = step_before = high - low
    for _ in range(_MOST_STEPS):
        value, slope = function(guess)
        if value > 0.0:
            low = guess
        elif value < 0.0:
            high = guess
        else:
            return guess
        halving = low + 0.5 * (high - low)
        newton = guess - value / slope if slope < 0.0 else halving
        if not low < newton < high or abs(2.0 * value) > abs(step_before * slope):
            newton = halving
        step_before, step = step, newton - guess
        guess = newton
        if abs(step) <= _SETTLED * guess:
            break
    return guess
