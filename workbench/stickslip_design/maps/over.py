"""Ranges of parameters as people type them: ``v=0.1..50 mm/s log 400``."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Final, NamedTuple

import numpy as np

from ..quantity import QuantityError, parts_of

DEFAULT_COUNT: Final = 200
"""Values of a range that says no number of them."""

MOST_VALUES: Final = 10_000_000
"""Most values of a range: they are held in memory."""

LOG, LIN = "log", "lin"
_WHOLE: Final = re.compile(r"\d+")
_FORM: Final = "NAME=LOW..HIGH [UNIT] [log|lin] [COUNT]"


class OverError(ValueError):
    """A range cannot be taken; the message says which, why, and what is expected."""


class Quantity(NamedTuple):
    """What may be mapped over.

    Attributes
    ----------
    unit
        SI unit, "1" for a plain number.
    description
        The meaning, in words.
    read
        Reads a quantity with its unit into SI; raises QuantityError.
    objection
        Returns why a value cannot be taken; None if it can.
    """

    unit: str
    description: str
    read: Callable[[str], float]
    objection: Callable[[float], str | None]


@dataclass(frozen=True)
class Dimension:
    """A parameter and the values that it takes, rising.

    Attributes
    ----------
    name
        The parameter.
    values
        Its values [SI].
    unit, description
        As of `Quantity`.
    shown
        The unit in which it was typed; "" for none.
    log
        Whether it is drawn on a logarithmic scale.
    """

    name: str
    values: tuple[float, ...]
    unit: str
    description: str
    shown: str = ""
    log: bool = False


def dimensions(
    over: Mapping[str, str | Sequence[float]], known: Mapping[str, Quantity]
) -> tuple[Dimension, ...]:
    """Return the dimensions of a map.

    Parameters
    ----------
    over
        By the name of a parameter its range, ``"0.1..50 mm/s log 400"``, or its values [SI].
    known
        What may be mapped over, by name.

    Raises
    ------
    OverError
        If there are less than two, a name is unknown, or a range cannot be taken.
    """
    found = tuple(
        _typed(name, each, known) if isinstance(each, str) else _listed(name, each, known)
        for name, each in over.items()
    )
    if len(found) < 2:
        raise OverError(
            f"a map is over two parameters or more, not {len(found)}; give each as {_FORM}"
        )
    return found


def split(texts: Sequence[str]) -> dict[str, str]:
    """Return ranges by the name of their parameter, of texts such as ``v=0.1..50 mm/s``.

    Raises
    ------
    OverError
        If a text has no name, or two have the same.
    """
    found: dict[str, str] = {}
    for text in texts:
        name, equals, span = (part.strip() for part in text.partition("="))
        if not (name and equals):
            raise OverError(f"{text!r} is no range; expected {_FORM}")
        if name in found:
            raise OverError(f"{name} is given twice: {found[name]!r} and {span!r}")
        found[name] = span
    return found


def _known(name: str, known: Mapping[str, Quantity]) -> Quantity:
    if name in known:
        return known[name]
    near = get_close_matches(name, known, 3, 0.4)
    remedy = f"nearest: {', '.join(near)}" if near else f"known are {', '.join(known)}"
    raise OverError(f"{name!r} is no parameter that can be mapped over; {remedy}")


def _typed(name: str, span: str, known: Mapping[str, Quantity]) -> Dimension:
    quantity = _known(name, known)
    text = f"{name}={span}"
    low_text, dots, rest = span.partition("..")
    words = rest.split()
    spacing, count = LIN, DEFAULT_COUNT
    said: set[str] = set()
    # The first word begins the quantity, so a number alone there is its value.
    while len(words) > 1 and (words[-1] in (LOG, LIN) or _WHOLE.fullmatch(words[-1])):
        word = words.pop()
        kind = "count" if _WHOLE.fullmatch(word) else "spacing"
        if kind in said:
            raise OverError(f"{text!r} has two words for its {kind}; expected {_FORM}")
        said.add(kind)
        spacing, count = (word, count) if kind == "spacing" else (spacing, int(word))
    if not (dots and low_text.strip() and words):
        raise OverError(f"{text!r} is no range; expected {_FORM}")
    (low, high), shown = _ends(text, low_text, " ".join(words), quantity)
    if not low < high:
        what = "empty" if low == high else "reversed"
        raise OverError(f"{text!r} is {what}: its end must be above its begin")
    if not 2 <= count <= MOST_VALUES:
        raise OverError(f"{text!r} has {count} values; 2 to {MOST_VALUES:g} are possible")
    if spacing == LOG and low <= 0.0:
        raise OverError(f"{text!r} is logarithmic: both ends must be above 0")
    values = np.geomspace(low, high, count) if spacing == LOG else np.linspace(low, high, count)
    if not np.all(np.diff(values) > 0.0):
        raise OverError(f"{text!r} has not so many numbers between its ends")
    return _made(name, values.tolist(), quantity, text, shown, log=spacing == LOG)


def _ends(text: str, low: str, high: str, quantity: Quantity) -> tuple[tuple[float, float], str]:
    """Read both ends; an end without a unit takes that of the other."""
    try:
        (low_number, low_unit), (high_number, high_unit) = map(parts_of, (low, high))
        shown = high_unit or low_unit
        ends = (f"{low_number} {low_unit or shown}", f"{high_number} {shown}")
        return (quantity.read(ends[0].strip()), quantity.read(ends[1].strip())), shown
    except QuantityError as error:
        raise OverError(f"{text!r} {error}") from None


def _listed(name: str, values: Sequence[float], known: Mapping[str, Quantity]) -> Dimension:
    quantity = _known(name, known)
    numbers = np.asarray(values, dtype=np.float64)
    text = f"the range of {name}"
    if numbers.ndim != 1 or numbers.size < 2:
        raise OverError(f"{text} has {numbers.size} values; at least 2 are needed, in one row")
    if not np.all(np.diff(numbers) > 0.0):
        raise OverError(f"{text} does not rise from value to value")
    # Drawn as it is spaced: by equal ratios or by equal distances.
    log = bool(numbers[0] > 0.0) and _even(np.log(numbers)) and not _even(numbers)
    return _made(name, numbers.tolist(), quantity, text, "", log=log)


def _even(numbers: np.ndarray[tuple[int], np.dtype[np.float64]]) -> bool:
    steps = np.diff(numbers)
    return bool(np.allclose(steps, steps.mean(), rtol=1e-6))


def _made(
    name: str, values: list[float], quantity: Quantity, text: str, shown: str, *, log: bool
) -> Dimension:
    for value in values:
        objection = quantity.objection(value) if math.isfinite(value) else "a value is not finite"
        if objection is not None:
            raise OverError(f"{text!r}: {objection}")
    return Dimension(name, tuple(values), quantity.unit, quantity.description, shown, log)
