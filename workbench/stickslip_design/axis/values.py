"""The values of an axis file: numbers with unit and ±, and texts."""

from __future__ import annotations

import json
import math
import re
from difflib import get_close_matches
from typing import Any, Final, NamedTuple

from ..quantity import QuantityError, parts_of
from .keys import UNITS, Key


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
    """Read what TOML says that stands at a path: by name the value.

    The values of a list are ``demand.feeds[1]`` and so on. AxisError if they are not allowed there.
    """
    if not (isinstance(written, list) and key.most > 1):
        return {path: _value(key, path, written)}
    if not 1 <= len(written) <= key.most:
        raise key.refusal(path, f"has {len(written)} values", as_written(written))
    places = {f"{path}[{place}]": each for place, each in enumerate(written, 1)}
    return {place: _value(key, place, each) for place, each in places.items()}


def as_written(value: Any) -> str:
    """Return a value of TOML as a person wrote it."""
    if isinstance(value, dict):
        return "{...}"
    text = json.dumps(value, ensure_ascii=False, default=str)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def _value(key: Key, path: str, written: Any) -> Value:
    shown, remedy = as_written(written), ""
    if key.units:
        return _number(key, path, written)
    if not isinstance(written, str) or not written.strip():
        raise key.refusal(path, "is not a text", shown)
    if path == "drive.kind" and written.lower() in {"linear motor", "rack"}:
        remedy = 'with kind = "rigid" the axis is judged without its loop'
        raise key.refusal(path, "is not computed yet", shown, remedy)
    if key.choices and written not in key.choices:
        for near in get_close_matches(written.lower(), key.choices, 1, 0.5):
            remedy = f'"{near}" is the nearest'
        raise key.refusal(path, "is none of the choices", shown, remedy)
    return written


def _number(key: Key, path: str, written: Any) -> Number:
    shown = as_written(written)
    if isinstance(written, bool) or not isinstance(written, int | float | str):
        raise key.refusal(path, "is not a number with a unit", shown)
    if not isinstance(written, str) and key.bare is None:
        unit = parts_of(key.example.split('"')[1])[1]
        remedy = f'write the unit, such as {key.name} = "{written} {unit}"'
        raise key.refusal(path, "has no unit", shown, remedy)
    try:
        number = _with_spread(key, written if isinstance(written, str) else repr(written))
    except QuantityError as error:
        raise key.refusal(path, str(error), shown) from None
    if number.value not in key.within:
        raise key.refusal(path, "is out of range", shown)
    if not all(number.value + side * number.spread in key.within for side in (-1.0, 1.0)):
        raise key.refusal(path, "is out of range with its ±", shown)
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
