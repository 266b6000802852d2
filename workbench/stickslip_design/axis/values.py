"""The values of an axis file: numbers with unit and ±, and texts."""

from __future__ import annotations

import json
import math
import re
from difflib import get_close_matches
from typing import Any, Final, NamedTuple

from ..quantity import QuantityError, parts_of
from .keys import UNITS, Key
from .refusal import AxisError


class Number(NamedTuple):
    """A number of an axis file: in which SI unit it is stated, and its ± in that unit."""

    value: float
    unit: str
    spread: float = 0.0


Value = Number | str

_LONGEST: Final = 80
"""Characters of a value that a refusal shows."""
_SPREAD: Final = re.compile(r"±|\+/-|\+-")


def values_of(key: Key, path: str, written: Any) -> dict[str, Value]:
    """Read what stands at a key.

    Parameters
    ----------
    key
        The key.
    path
        Its name in the file.
    written
        What TOML says that stands there.

    Returns
    -------
    dict
        By name the value, the values of a list as ``demand.feeds[1]`` and so on.

    Raises
    ------
    AxisError
        If that is not allowed there.
    """
    if isinstance(written, list) and key.most > 1:
        if not 1 <= len(written) <= key.most:
            raise refused(key, path, written, f"has {len(written)} values")
        return {
            f"{path}[{place}]": _value(key, f"{path}[{place}]", each)
            for place, each in enumerate(written, 1)
        }
    return {path: _value(key, path, written)}


def refused(key: Key, path: str, written: Any, reason: str, remedy: str = "") -> AxisError:
    """Return the refusal of what is written at a key."""
    return AxisError(
        reason, key=path, value=as_written(written), within=key.expected,
        remedy=remedy or f"write such as {key.name} = {key.example}",
    )  # fmt: skip


def as_written(value: Any) -> str:
    """Return a value of TOML as a person wrote it."""
    if isinstance(value, dict):
        return "{...}"
    text = json.dumps(value, ensure_ascii=False, default=str)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def _value(key: Key, path: str, written: Any) -> Value:
    if key.units:
        return _number(key, path, written)
    if not isinstance(written, str) or not written.strip():
        raise refused(key, path, written, "is not a text")
    if key.choices and written not in key.choices:
        near = get_close_matches(written.lower(), key.choices, 1, 0.5)
        remedy = f'"{near[0]}" is the nearest' if near else ""
        raise refused(key, path, written, "is none of the choices", remedy)
    return written


def _number(key: Key, path: str, written: Any) -> Number:
    if isinstance(written, bool) or not isinstance(written, int | float | str):
        raise refused(key, path, written, "is not a number with a unit")
    if not isinstance(written, str) and key.bare is None:
        unit = parts_of(key.example.split('"')[1])[1]
        remedy = f'write the unit, such as {key.name} = "{written} {unit}"'
        raise refused(key, path, written, "has no unit", remedy)
    text = written if isinstance(written, str) else repr(written)
    try:
        number = _with_spread(key, text)
    except QuantityError as error:
        raise refused(key, path, written, str(error)) from None
    for value in (number.value, number.value - number.spread, number.value + number.spread):
        if value not in key.within:
            where = "is out of range" if value == number.value else "is out of range with its ±"
            raise refused(key, path, written, where)
    return number


def _with_spread(key: Key, text: str) -> Number:
    parts = _SPREAD.split(text)
    if len(parts) == 1:
        value, kind = UNITS.read(text, key.kinds, key.bare)
        return Number(value, kind.unit)
    if not key.spread:
        raise QuantityError("has a ±, which is not allowed here")
    if len(parts) > 2:
        raise QuantityError("has more than one ±")
    (number, unit), (around, unit_around) = map(parts_of, parts)
    if unit_around == "%" != unit:
        value, kind = UNITS.read(parts[0], key.kinds, key.bare)
        spread = abs(value) * UNITS.read(around + "%", (UNITS.kinds["1"],), None)[0]
    else:
        value, kind = UNITS.read(f"{number} {unit or unit_around}", key.kinds, key.bare)
        spread, _ = UNITS.read(f"{around} {unit_around or unit}", (kind,), key.bare)
    if math.copysign(1.0, spread) < 0.0:
        raise QuantityError("has a negative ±")
    return Number(value, kind.unit, spread)
