"""Ranges of parameters as people type them: ``v=0.1..50 mm/s log 400``."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..quantity import QuantityError
from ..ranges import parse_range

DEFAULT_COUNT: Final = 200
"""Values of a range that says no number of them."""

_FORM: Final = "NAME=LOW..HIGH [UNIT] [log|lin] [COUNT]"


class OverError(ValueError):
    """A range cannot be taken; the message says which, why, and what is expected."""


class Quantity(NamedTuple):
    """What may be mapped over.

    Attributes
    ----------
    unit, description
        SI unit, "1" for a plain number; the meaning, in words.
    read
        Reads a quantity with its unit into SI; raises QuantityError.
    check
        Raises a ValueError if one of some values cannot be taken.
    """

    unit: str
    description: str
    read: Callable[[str], float]
    check: Callable[[NDArray[np.float64]], object]


@dataclass(frozen=True)
class Dimension:
    """A parameter and the values that it takes, rising.

    Attributes
    ----------
    name, quantity, values
        The parameter, what it is, and its values [SI].
    shown, log
        The unit in which it was typed, "" for none; whether it is drawn on a logarithmic scale.
    """

    name: str
    quantity: Quantity
    values: tuple[float, ...]
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
    if len(over) < 2:
        raise OverError(
            f"a map is over two parameters or more, not {len(over)}; give each as {_FORM}"
        )
    return tuple(_dimension(name, span, known) for name, span in over.items())


def _dimension(name: str, span: str | Sequence[float], known: Mapping[str, Quantity]) -> Dimension:
    if name not in known:
        near = get_close_matches(name, known, 3, 0.4)
        remedy = f"nearest: {', '.join(near)}" if near else f"known are {', '.join(known)}"
        raise OverError(f"{name!r} is no parameter that can be mapped over; {remedy}")
    quantity = known[name]
    if isinstance(span, str):
        text = repr(f"{name}={span}")
        read = quantity.read
        try:
            spaced = parse_range(
                span, quantity.unit, read=lambda end, _: read(end), count=DEFAULT_COUNT
            )
        except QuantityError as error:
            raise OverError(f"{text} {error}") from None
        values, log, shown = spaced.values(), spaced.log, spaced.symbol
    else:
        text, shown = f"the range of {name}", ""
        values = np.asarray(span, dtype=np.float64)
        if values.ndim != 1 or values.size < 2:
            raise OverError(f"{text} has {values.size} values; at least 2 are needed, in one row")
        # Drawn as it is spaced: by equal ratios or by equal distances.
        log = bool(np.all(values > 0.0)) and _even(np.log(values)) and not _even(values)
    if not np.all(np.diff(values) > 0.0):
        raise OverError(f"{text} does not rise from value to value")
    try:
        quantity.check(values)
    except ValueError as error:
        raise OverError(f"{text}: {error}") from None
    return Dimension(name, quantity, tuple(values.tolist()), shown, log)


def _even(numbers: NDArray[np.float64]) -> bool:
    steps = np.diff(numbers)
    return bool(np.allclose(steps, steps.mean(), rtol=1e-6))
