"""Roots and rounding that the claims share."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from mpmath import mp, mpf

from stickslip_verification.model import formulas
from stickslip_verification.model.formulas import DIGITS

Number = Any
"""An mpmath number; mpmath carries no type information."""

# 2^-64 of any interval here is below the rounding of a double, and no figure shows more.
_HALVINGS = 64


def threshold(
    deviation: Callable[[Number], Number], level: float, low: float, high: float
) -> Number:
    """Return where a monotone deviation passes `level`, between `low` and `high`, all above 0.

    Raises
    ------
    ValueError
        If it does not pass the level there.
    """
    with mp.workdps(DIGITS):
        below, above = mp.log(low), mp.log(high)
        start = deviation(mp.exp(below)) > level
        if start == (deviation(mp.exp(above)) > level):
            raise ValueError(f"no deviation of {level} between {low} and {high}")
        for _ in range(_HALVINGS):
            middle = (below + above) / 2
            if (deviation(mp.exp(middle)) > level) == start:
                below = middle
            else:
                above = middle
        return mp.exp((below + above) / 2)


def lambda_of(p: Mapping[str, Number]) -> Number:
    """Return ``lambda = w Delta/v`` for v > 0, docs/theory.md (2)."""
    with mp.workdps(DIGITS):
        return mp.pi / formulas.half_period(p) * formulas.spring_relief(p) / 2 / mpf(p["v"])


def pulled_at(lambda_: Number, p: Mapping[str, Number]) -> dict[str, Number]:
    """Return the block with the speed v [m/s] that makes lambda what is asked."""
    with mp.workdps(DIGITS):
        return {**p, "v": lambda_of({**p, "v": 1}) / lambda_}


def figure(value: Number, digits: int = 3) -> str:
    """Return a number to so many significant digits, without an exponent."""
    number = float(f"{float(value):.{digits - 1}e}")
    exponent = int(f"{number:e}".partition("e")[2]) if number else 0
    return f"{number:.{max(digits - 1 - exponent, 0)}f}"


def percent(fraction: Number, digits: int = 2) -> str:
    """Return a fraction in percent to so many significant digits, with the sign for percent."""
    return f"{figure(100 * fraction, digits)} %"


def spoken(parts: Sequence[str]) -> str:
    """Return parts as one speaks them: a, b and c."""
    return " and ".join(part for part in (", ".join(parts[:-1]), parts[-1]) if part)
