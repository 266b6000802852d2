"""Quantities as people type them: `20mm/s`, `1 kN/m`, `0.5 N/um`, `1e3`; plain numbers are SI.

A unit is a product and quotient of symbols, each with an optional power: `N.s/m`, `m/s2`, `kg/s`.
It is read against two tables, symbols and prefixes, and refused if its dimension is not the one
expected. Numbers are scaled as fractions and rounded once: `20mm/s` is the same double as `0.02`.
"""

import math
import re
from dataclasses import dataclass
from fractions import Fraction
from typing import Final, TypeAlias

from stickslip.errors import CommandError

Dimension: TypeAlias = tuple[int, int, int]
"""Exponents of kilogram, metre and second."""


@dataclass(frozen=True)
class Kind:
    """A kind of quantity that the command reads: its name, SI unit, dimension and an example."""

    name: str
    unit: str
    dimension: Dimension
    example: str


# The keys are units as the FMU's variable table and the command's own options write them.
_KINDS: Final = {
    kind.unit: kind
    for kind in (
        Kind("a mass", "kg", (1, 0, 0), "2 kg"),
        Kind("a length", "m", (0, 1, 0), "5mm"),
        Kind("a time", "s", (0, 0, 1), "3 ms"),
        Kind("a velocity", "m/s", (0, 1, -1), "20mm/s"),
        Kind("an acceleration", "m/s2", (0, 1, -2), "9.81 m/s2"),
        Kind("a force", "N", (1, 1, -2), "5 N"),
        Kind("a stiffness", "N/m", (1, 0, -2), "1 kN/m"),
        Kind("a damping coefficient", "N.s/m", (1, 0, -1), "2 N.s/m"),
        Kind("a plain number", "1", (0, 0, 0), "0.5"),
    )
}

_SYMBOLS: Final[dict[str, tuple[Fraction, Dimension]]] = {
    "1": (Fraction(1), (0, 0, 0)),
    "%": (Fraction(1, 100), (0, 0, 0)),
    "g": (Fraction(1, 1000), (1, 0, 0)),
    "t": (Fraction(1000), (1, 0, 0)),
    "m": (Fraction(1), (0, 1, 0)),
    "s": (Fraction(1), (0, 0, 1)),
    "min": (Fraction(60), (0, 0, 1)),
    "h": (Fraction(3600), (0, 0, 1)),
    "N": (Fraction(1), (1, 1, -2)),
}

_PREFIXES: Final = {
    "p": Fraction(1, 10**12),
    "n": Fraction(1, 10**9),
    "u": Fraction(1, 10**6),
    "\N{MICRO SIGN}": Fraction(1, 10**6),
    "\N{GREEK SMALL LETTER MU}": Fraction(1, 10**6),
    "m": Fraction(1, 1000),
    "c": Fraction(1, 100),
    "d": Fraction(1, 10),
    "k": Fraction(1000),
    "M": Fraction(10**6),
    "G": Fraction(10**9),
}

_PREFIXED: Final = frozenset({"g", "m", "s", "N"})

_NUMBER: Final = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)
_FACTOR: Final = re.compile(
    r"(?P<symbol>1|%|[A-Za-zµμ]+)(?:\^?(?P<power>-?[0-9])|(?P<raised>[²³]))?"
)


def kind_of(unit: str) -> Kind:
    """Give the kind of quantity that has this SI unit.

    Parameters
    ----------
    unit
        An SI unit as the FMU's variable table writes it, such as ``"N.s/m"``.

    Raises
    ------
    KeyError
        If the command knows no quantity of this unit.
    """
    return _KINDS[unit]


def parse(text: str, unit: str, option: str, within: str = "") -> float:
    """Read a quantity typed by a person as a number of SI units.

    Parameters
    ----------
    text
        A number, with or without a unit: ``"1e3"``, ``"20mm/s"``, ``"1 kN/m"``.
    unit
        The SI unit of the result, which also says what dimension is expected.
    option
        The name under which the person gave it, for the message.
    within
        The range in words, such as ``"> 0"``, for the message; the caller checks it.

    Returns
    -------
    float
        The finite double nearest to the quantity in `unit`.

    Raises
    ------
    CommandError
        If the text is not a finite number, or its unit is unknown or of another dimension; the
        message names the option, the text and what is expected.
    """
    kind = kind_of(unit)
    expected = _expected(kind, within)
    stripped = text.strip()
    number = _NUMBER.match(stripped)
    if number is None:
        raise _refused(text, expected, option, "is not a finite number")
    symbol = stripped[number.end() :].strip()
    if symbol.startswith(","):
        raise _refused(text, expected, option, "has a comma where the decimal point is expected")
    scale = Fraction(1)
    if symbol:
        try:
            scale, dimension = _scale_and_dimension(symbol)
        except ValueError:
            raise _refused(text, expected, option, f"has the unknown unit {symbol!r}") from None
        if dimension != kind.dimension:
            found = next((k.name for k in _KINDS.values() if k.dimension == dimension), None)
            reason = f"is {found}" if found else f"has the unit {symbol!r}"
            raise _refused(text, expected, option, reason)
    value = _scaled(number.group(), scale)
    if not math.isfinite(value):
        raise _refused(text, expected, option, "is larger than a double can hold")
    return value


def _scaled(number: str, scale: Fraction) -> float:
    unscaled = float(number)
    # A number that is 0 or infinity as a double has an exponent that a fraction must not expand.
    if scale == 1 or unscaled == 0.0 or math.isinf(unscaled):
        return unscaled
    try:
        return float(Fraction(number) * scale)
    except OverflowError:
        return math.inf


def _scale_and_dimension(symbol: str) -> tuple[Fraction, Dimension]:
    scale = Fraction(1)
    kilogram = metre = second = 0
    sign = 1
    position = 0
    while True:
        factor = _FACTOR.match(symbol, position)
        if factor is None:
            raise ValueError(symbol)
        power = sign * _power(factor)
        one_scale, one_dimension = _look_up(factor["symbol"])
        scale *= one_scale**power
        kilogram += power * one_dimension[0]
        metre += power * one_dimension[1]
        second += power * one_dimension[2]
        position = factor.end()
        if position == len(symbol):
            return scale, (kilogram, metre, second)
        operator = symbol[position]
        if operator not in "/.*·":
            raise ValueError(symbol)
        # As in FMI and in print, everything after the stroke stands below it: N/m.s is N/(m.s).
        sign = -1 if operator == "/" else sign
        position += 1


def _power(factor: re.Match[str]) -> int:
    if factor["raised"]:
        return {"²": 2, "³": 3}[factor["raised"]]
    return int(factor["power"] or 1)


def _look_up(symbol: str) -> tuple[Fraction, Dimension]:
    if symbol in _SYMBOLS:
        return _SYMBOLS[symbol]
    prefix, base = symbol[0], symbol[1:]
    if prefix in _PREFIXES and base in _PREFIXED:
        scale, dimension = _SYMBOLS[base]
        return _PREFIXES[prefix] * scale, dimension
    raise ValueError(symbol)


def _expected(kind: Kind, within: str) -> str:
    unit = "" if kind.unit == "1" else f" in {kind.unit}"
    return f"{kind.name}{unit}{' ' if within else ''}{within}, such as {kind.example}"


def _refused(text: str, expected: str, option: str, reason: str) -> CommandError:
    return CommandError(f"{option} {text!r} {reason}; expected {expected}")
