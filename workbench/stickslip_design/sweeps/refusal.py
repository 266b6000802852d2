"""Refusals of a sweep: their one kind of error, nearest names, numbers in the model's units."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from fractions import Fraction

from stickslip_verification import Unit

from ..chunks import StudyError
from ..quantity import QuantityError, on_data_sheet, parts_of

MOST_SHOWN = 5
"""Nearest names that a refusal lists."""


class SweepError(StudyError):
    """A model, a plan or a table of it cannot be used; one line with file, line, name, reason."""


def nearest(name: str, known: Iterable[str]) -> str:
    """Return the names most like one that is not known, as the end of a refusal."""
    names = list(known)
    folded = {other.lower(): other for other in names}
    near = [folded[match] for match in get_close_matches(name.lower(), folded, MOST_SHOWN, 0.5)]
    # The last part of a structured name may be all that a person remembers.
    last = name.rpartition(".")[2].lower()
    near += [other for other in names if other.rpartition(".")[2].lower() == last]
    if near:
        return f"nearest: {', '.join([*dict.fromkeys(near)][:MOST_SHOWN])}"
    listed = ", ".join(names[:MOST_SHOWN])
    more = len(names) - MOST_SHOWN
    return f"there is {listed or 'none'}{f' and {more} more' if more > 0 else ''}"


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
    one, other = (units.get(symbol) or on_data_sheet(symbol) for symbol in (source, target))
    if one is None:
        raise QuantityError(f"has the unknown unit {source!r}; the model's is {target!r}")
    if other is None:
        raise QuantityError(f"has the unit {source!r}; only the model's {target!r} is understood")
    if one.dimension != other.dimension:
        raise QuantityError(
            f"has the unit {source!r}, which is no unit like the model's {target!r}"
        )
    return one.factor / other.factor, (one.offset - other.offset) / other.factor
