"""Quantities in the unit that a model declares for a variable."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction

from stickslip_verification import Unit

from ..quantity import QuantityError, on_data_sheet, parts_of


def read_as(units: Mapping[str, Unit], text: str, unit: str) -> float:
    """Read a number in the unit that a model declares, which defines `units`.

    A plain number is in that unit; where it is empty only these are understood. `QuantityError` if
    the text is no finite number, or its unit is unknown or of another dimension.
    """
    number, symbol = parts_of(text)
    if not math.isfinite(float(number)):
        raise QuantityError("is larger than a double can hold")
    return in_unit(units, number, symbol, unit)


def in_unit(units: Mapping[str, Unit], number: str, symbol: str, unit: str) -> float:
    """Return a number with a unit as one in another unit; arguments and errors as of `read_as`."""
    if symbol in ("", unit):
        return float(number)
    if not unit:
        raise QuantityError(f"has the unit {symbol!r}, and the model declares none")
    factor, offset = between(units, symbol, unit)
    # A number that is 0 as a double may have an exponent that a fraction must not expand.
    exact = Fraction(number) if float(number) != 0.0 else Fraction(0)
    try:
        return float(exact * factor + offset)
    except OverflowError:
        raise QuantityError("is larger than a double can hold") from None


def between(units: Mapping[str, Unit], source: str, target: str) -> tuple[Fraction, Fraction]:
    """Return factor and offset from numbers in one unit to those in another.

    `QuantityError` if one of them is unknown, or they are of different dimensions.
    """
    one, other = (units.get(each) or on_data_sheet(each) for each in (source, target))
    if one is None:
        raise QuantityError(f"has the unknown unit {source!r}; the model's is {target!r}")
    if other is None:
        raise QuantityError(f"has the unit {source!r}; only the model's {target!r} is understood")
    if one.dimension != other.dimension:
        raise QuantityError(
            f"has the unit {source!r}, which is no unit like the model's {target!r}"
        )
    return one.factor / other.factor, (one.offset - other.offset) / other.factor
