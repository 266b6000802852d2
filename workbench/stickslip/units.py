"""Quantities as people type them: `20mm/s`, `31 mm/year`, `0.5 N/um`, `1e3`; plain numbers are SI.

A unit is a product and quotient of symbols, each with an optional power: `N.s/m`, `m/s2`, `kg/s`.
It is refused if its dimension is not the one expected. Numbers are scaled as fractions and rounded
once: `20mm/s` is the same double as `0.02`.
"""

import math
import re
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

from stickslip.errors import CommandError
from stickslip_verification import spelled


@dataclass(frozen=True)
class Kind:
    """A kind of quantity that the command reads: its name, SI unit and an example."""

    name: str
    unit: str
    example: str

    @property
    def dimension(self) -> tuple[int, ...] | None:
        """The exponents of the base units in its unit."""
        unit = spelled(self.unit)
        return unit.dimension if unit else None

    def expected(self, within: str = "") -> str:
        """Return what is expected in words: name, SI unit, range `within`, example."""
        unit = "" if self.unit == "1" else f" in {self.unit}"
        return f"{self.name}{unit}{' ' if within else ''}{within}, such as {self.example}"


KINDS: Final = {
    kind.unit: kind
    for kind in (
        Kind("a mass", "kg", "2 kg"),
        Kind("a length", "m", "5mm"),
        Kind("a time", "s", "3 ms"),
        Kind("a velocity", "m/s", "20mm/s"),
        Kind("an acceleration", "m/s2", "9.81 m/s2"),
        Kind("a force", "N", "5 N"),
        Kind("a stiffness", "N/m", "1 kN/m"),
        Kind("a damping coefficient", "N.s/m", "2 N.s/m"),
        Kind("a plain number", "1", "0.5"),
    )
}
"""The kinds of quantities that the command reads, by SI unit as the variable table spells it."""

_NUMBER: Final = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)


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
    # A friction law may have a parameter of any unit.
    kind = KINDS.get(unit) or Kind("a quantity", unit, f"0.5 {unit}")
    expected = kind.expected(within)
    stripped = text.strip()
    number = _NUMBER.match(stripped)
    if number is None:
        raise _refused(text, expected, option, "is not a finite number")
    symbol = stripped[number.end() :].strip()
    if symbol.startswith(","):
        raise _refused(text, expected, option, "has a comma where the decimal point is expected")
    scale = Fraction(1)
    if symbol:
        # As in FMI and in print, everything after the stroke stands below it.
        typed = spelled(symbol, all_below=True)
        if typed is None:
            raise _refused(text, expected, option, f"has the unknown unit {symbol!r}")
        if typed.dimension != kind.dimension:
            found = next((k.name for k in KINDS.values() if k.dimension == typed.dimension), None)
            reason = f"is {found}" if found else f"has the unit {symbol!r}"
            raise _refused(text, expected, option, reason)
        scale = typed.factor
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


def _refused(text: str, expected: str, option: str, reason: str) -> CommandError:
    return CommandError(f"{option} {text!r} {reason}; expected {expected}")
