"""Units in SI: from their spelling, or from the definitions in an FMU.

All factors are kept as the decimals that were written, so that 1 mm is a thousandth of a metre and
not 0.001 as a double: a value then suffers one rounding on its way to SI and one on its way back.
"""

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Final

Dimension = tuple[int, ...]
"""Exponents of kg, m, s, A, K, mol, cd, rad, in the order of an FMU's BaseUnit."""

_NONE: Dimension = (0, 0, 0, 0, 0, 0, 0, 0)


@dataclass(frozen=True)
class Unit:
    """A unit: a number in it is ``factor * number + offset`` in SI, of this dimension."""

    factor: Fraction
    offset: Fraction
    dimension: Dimension


@dataclass(frozen=True)
class Conversion:
    """From a number of the FMU to ours in SI: ``number * numerator / denominator + offset``.

    The sign of a variable that points the other way is in numerator and offset.
    """

    numerator: float = 1.0
    denominator: float = 1.0
    offset: float = 0.0

    @property
    def leaves_alone(self) -> bool:
        """Whether numbers pass through untouched."""
        return self.numerator == self.denominator and self.offset == 0.0

    def to_si(self, number: float) -> float:
        """Convert a number of the FMU to ours."""
        scaled = number * self.numerator / self.denominator
        return scaled + self.offset if self.offset else scaled

    def from_si(self, number: float) -> float:
        """Convert a number of ours to the FMU's."""
        moved = number - self.offset if self.offset else number
        return moved * self.denominator / self.numerator


_TABLES: Final = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
UNITS_WITH_PREFIX, UNITS_ALONE = (
    {symbol: (Fraction(factor), tuple(of)) for symbol, (factor, of) in _TABLES[table].items()}
    for table in ("prefixed", "alone")
)
"""Factor and dimension of the units that take a prefix, and that take none, by symbol."""
UNIT_PREFIXES = {symbol: Fraction(factor) for symbol, factor in _TABLES["prefixes"].items()}
"""Factors of the prefixes, by symbol."""

_BY_SYMBOL: Mapping[str, tuple[Fraction, Dimension]] = {
    prefix + symbol: (factor * of_unit, dimension)
    for prefix, factor in UNIT_PREFIXES.items()
    for symbol, (of_unit, dimension) in UNITS_WITH_PREFIX.items()
} | {**UNITS_WITH_PREFIX, **UNITS_ALONE}

_FACTOR = re.compile(
    r"(?P<symbol>1|%|[^\W\d_²³]+)(?:(?:\^|\*\*)?(?P<power>[+-]?\d{1,2})|(?P<raised>[²³]))?"
)
_RAISED: Mapping[str, int] = {"²": 2, "³": 3}
_BLANKS = re.compile(r"\s*([./*·])\s*")
_PRODUCT = re.compile(r"[.·]|(?<!\*)\*(?!\*)")


def spelled(text: str, *, all_below: bool = False) -> Unit | None:
    """Read a unit from its spelling, such as mm, N.s/m or m/s2; None if it is not understood.

    Factors are joined by ``.``, ``·``, ``*`` or ``/``, and a prefix stands before m, g, s, N, J, W
    or Hz. An empty text and ``-`` are pure numbers. Several factors after the first ``/`` are not
    understood, for people read them differently; with `all_below` N/m.s is N/(m.s).
    """
    if text.strip() == "-":
        return Unit(Fraction(1), Fraction(0), _NONE)
    above, slash, below = _BLANKS.sub(r"\1", text.strip()).partition("/")
    if slash and not above:
        return None
    factor, dimension = Fraction(1), _NONE
    lower = _PRODUCT.split(below.replace("/", ".")) if all_below else [below]
    parts = [(part, 1) for part in _PRODUCT.split(above)] if above else []
    parts += [(part, -1) for part in lower] if slash else []
    for part, side in parts:
        match = _FACTOR.fullmatch(part)
        base = _BY_SYMBOL.get(match["symbol"]) if match else None
        if match is None or base is None:
            return None
        times = side * int(match["power"] or _RAISED.get(match["raised"], 1))
        factor *= base[0] ** times
        dimension = tuple(p + times * q for p, q in zip(dimension, base[1], strict=True))
    return Unit(factor, Fraction(0), dimension)


def defined(factor: float, offset: float, dimension: Dimension) -> Unit | None:
    """Make a unit from the definition in an FMU; None if its factor makes no sense."""
    try:
        unit = Unit(Fraction(repr(factor)), Fraction(repr(offset)), dimension)
    except ValueError:
        return None
    return unit if unit.factor else None


def conversion(unit: Unit, sign: int) -> Conversion:
    """Return the conversion of numbers in `unit`, that count along (+1) or against (-1) ours."""
    top, bottom = unit.factor.numerator, unit.factor.denominator
    # Beyond this an integer is no double, and two roundings are not better than one.
    if max(abs(top), bottom) > 2**53:
        return Conversion(sign * float(unit.factor), 1.0, sign * float(unit.offset))
    return Conversion(float(sign * top), float(bottom), sign * float(unit.offset))
