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
    typed, wanted = units.get(symbol) or on_data_sheet(symbol), units.get(unit)
    wanted = wanted or on_data_sheet(unit)
    if typed is None:
        raise QuantityError(f"has the unknown unit {symbol!r}; the model's is {unit!r}")
    if wanted is None:
        raise QuantityError(f"has the unit {symbol!r}; only the model's {unit!r} is understood")
    if typed.dimension != wanted.dimension:
        raise QuantityError(f"has the unit {symbol!r}, which is no unit like the model's {unit!r}")
    # A number that is 0 as a double may have an exponent that a fraction must not expand.
    exact = Fraction(number) if float(number) != 0.0 else Fraction(0)
    try:
        return float((exact * typed.factor + typed.offset - wanted.offset) / wanted.factor)
    except OverflowError:
        raise QuantityError("is larger than a double can hold") from None


def between(units: Mapping[str, Unit], source: str, target: str) -> tuple[float, float] | None:
    """Return factor and offset from numbers in one unit to those in another, None if unknown.

    `QuantityError` if they are of different dimensions.
    """
    if source == target or not source or not target:
        return 1.0, 0.0
    one, other = units.get(source), units.get(target)
    if one is None or other is None:
        return None
    if one.dimension != other.dimension:
        raise QuantityError(f"has the unit {target!r}, and what drives it {source!r}")
    return (
        float(one.factor / other.factor),
        float((one.offset - other.offset) / other.factor),
    )
