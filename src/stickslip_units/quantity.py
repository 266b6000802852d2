"""Quantities as people write them, `20mm/s`, `0.5 N/um`, `60 kg cm2`, `1e3`, and ranges of them.

A unit is refused if its dimension is not the one expected. Numbers are scaled as fractions and
rounded once: `20mm/s` is the same double as `0.02`. A range is `0.1..50 mm/s log 400`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, Final, TypeAlias

from .units import Unit, spelled

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Kind:
    """A kind of quantity: its name, SI unit and an example."""

    name: str
    unit: str
    example: str

    @property
    def in_words(self) -> str:
        """Its name, with the SI unit where it has one."""
        return self.name if self.unit == "1" else f"{self.name} in {self.unit}"

    def expected(self, within: str = "") -> str:
        """Return what is expected in words: name, SI unit, range `within`, example."""
        return f"{self.in_words}{' ' if within else ''}{within}, such as {self.example}"


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
"""The kinds of quantities of the block, by SI unit as its variable table spells it."""

_NUMBER: Final = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)


class QuantityError(ValueError):
    """A text is not a quantity of the kind expected; the message is the reason alone."""


@dataclass(frozen=True)
class Units:
    """A way to write quantities."""

    spelled: Callable[[str], Unit | None]
    """The unit of a spelling; None where it is not understood."""
    kinds: Mapping[str, Kind]
    """The kinds of quantities that a refusal calls by their names, by SI unit."""

    def read(self, text: str, kinds: Sequence[Kind], bare: Kind | None) -> tuple[float, Kind]:
        """Read a quantity of one of several kinds: its kind, and the nearest double in its unit.

        `bare` is what a number without a unit is; None: it is refused.

        Raises
        ------
        QuantityError
            If the text is not a finite number, or its unit is unknown or of another dimension.
        """
        number, symbol = parts_of(text)
        if not symbol:
            if bare is None:
                raise QuantityError("has no unit")
            return _scaled(number, Fraction(1)), bare
        typed = self.spelled(symbol)
        if typed is None:
            raise QuantityError(f"has the unknown unit {symbol!r}")
        for kind in (*kinds, *self.kinds.values()):
            unit = self.spelled(kind.unit)
            if unit is not None and unit.dimension == typed.dimension:
                if kind not in kinds:
                    raise QuantityError(f"is {kind.name}")
                return _scaled(number, typed.factor / unit.factor), kind
        raise QuantityError(f"has the unit {symbol!r}")


def parts_of(text: str) -> tuple[str, str]:
    """Return number and unit of a quantity as they are written.

    Raises
    ------
    QuantityError
        If the text does not begin with a finite number, or that has a decimal comma.
    """
    stripped = text.strip()
    number = _NUMBER.match(stripped)
    if number is None:
        raise QuantityError("is not a finite number")
    symbol = stripped[number.end() :].strip()
    if symbol.startswith(","):
        raise QuantityError("has a comma where the decimal point is expected")
    return number.group(), symbol


def _scaled(number: str, scale: Fraction, offset: Fraction = Fraction(0)) -> float:
    value = float(number)
    if (scale != 1 or offset != 0) and not math.isinf(value):
        # A number that is 0 as a double may have an exponent that a fraction must not expand.
        exact = Fraction(number) * scale if value else Fraction(0)
        try:
            value = float(exact + offset) if exact or offset else value
        except OverflowError:
            value = math.inf
    if math.isinf(value):
        raise QuantityError("is larger than a double can hold")
    return value


def in_unit(number: str, symbol: str, unit: str, known: Mapping[str, Unit]) -> float:
    """Return a number with a unit as one in another unit, of those `known` and of data sheets.

    Where that unit is empty a plain number alone is understood. `QuantityError` if a unit is
    unknown, they are of different dimensions, or the number is larger than a double can hold.
    """
    if symbol in ("", unit):
        return float(number)
    if not unit:
        raise QuantityError(f"has the unit {symbol!r}, and the model declares none")
    return _scaled(number, *between(symbol, unit, known))


def between(source: str, target: str, known: Mapping[str, Unit]) -> tuple[Fraction, Fraction]:
    """Return factor and offset from numbers in one unit to those in another; as `in_unit`."""
    one, other = (known.get(symbol) or on_data_sheet(symbol) for symbol in (source, target))
    if one is None:
        raise QuantityError(f"has the unknown unit {source!r}; the model's is {target!r}")
    if other is None:
        raise QuantityError(f"has the unit {source!r}; only the model's {target!r} is understood")
    if one.dimension != other.dimension:
        raise QuantityError(
            f"has the unit {source!r}, which is no unit like the model's {target!r}"
        )
    return one.factor / other.factor, (one.offset - other.offset) / other.factor


def typed_in(text: str, unit: str, known: Mapping[str, Unit]) -> float:
    """Read a quantity in the unit of a model that defines those `known`; as `in_unit`."""
    number, symbol = parts_of(text)
    return in_unit(number, symbol, unit, known) if symbol else _scaled(number, Fraction(1))


_TYPED: Final = Units(partial(spelled, all_below=True), KINDS)
"""As in FMI and in print, everything after the stroke stands below it."""


def typed(text: str, unit: str, within: str = "") -> float:
    """Read a quantity, ``"1e3"``, ``"20mm/s"`` or ``"1 kN/m"``, in which a plain number is SI.

    The SI unit of the result also says what dimension is expected; `within` is the range in words,
    such as ``"> 0"``, for the message: the caller checks it.

    Raises
    ------
    QuantityError
        If the text is not a finite number, or its unit is unknown or of another dimension; the
        message gives the reason and what is expected.
    """
    # A friction law may have a parameter of any unit.
    kind = KINDS.get(unit) or Kind("a quantity", unit, f"0.5 {unit}")
    try:
        return _TYPED.read(text, (kind,), kind)[0]
    except QuantityError as error:
        raise QuantityError(f"{error}; expected {kind.expected(within)}") from None


_ONE: Final = Unit(Fraction(1), Fraction(0), (0,) * 8)
_RAD: Final = replace(_ONE, dimension=(0, 0, 0, 0, 0, 0, 0, 1))
_TURN: Final = replace(_RAD, factor=Fraction(2.0 * math.pi))
_DEGREE: Final = replace(_RAD, factor=Fraction(math.pi) / 180)
_ROTARY: Final[Mapping[str, Unit]] = {
    "rad": _RAD,
    "mrad": replace(_RAD, factor=Fraction(1, 1000)),
    "deg": _DEGREE,
    "arcmin": replace(_RAD, factor=_DEGREE.factor / 60),
    "arcsec": replace(_RAD, factor=_DEGREE.factor / 3600),
    "turn": _TURN,
    "rev": _TURN,
    "rpm": Unit(_TURN.factor / 60, Fraction(0), (0, 0, -1, 0, 0, 0, 0, 1)),
    "counts": _ONE,
    "A": replace(_ONE, dimension=(0, 0, 0, 1, 0, 0, 0, 0)),
    # Read sign by sign it could be N ms.
    "Nms": replace(_ONE, dimension=(1, 2, -1, 0, 0, 0, 0, 0)),
    # Both edges of both tracks of an encoder count.
    "lines": replace(_ONE, factor=Fraction(4)),
}
"""Units of what turns. Beside them Hz is a turn in a second, and 1/s stays apart from it."""

_SIGN: Final = re.compile(r"\s*([()/.·*]|[^()/.·*\s]+)")
_FACTOR: Final = re.compile(r"(?P<symbol>[^\W\d_²³]+)(?P<power>\^?[+-]?\d{1,2}|[²³])?")


def on_data_sheet(text: str) -> Unit | None:
    """Read a unit as drawings and data sheets write it; None if it is not understood.

    Beyond `units.spelled` a blank multiplies, or nothing at all (``kg cm2``,
    ``kgcm²``, ``Nm``), round brackets group, everything after the first stroke stands below it
    (``m/min/mm``), and what turns has units: ``rad``, ``deg`` or ``°``, ``arcsec``, ``turn``,
    ``rpm``, ``Hz``, ``lines/turn``.
    """
    text = text.replace("**", "^").replace("°", "deg")
    signs = _SIGN.findall("1" + text if text.startswith("/") else text)
    try:
        unit = _quotient(signs)
    except ValueError:
        return None
    return None if signs else unit


def _quotient(signs: list[str]) -> Unit:
    """Take a unit from the beginning of a list of signs, up to a bracket that closes."""
    unit, side, open_end = _ONE, 1, True
    while signs and signs[0] != ")":
        sign = signs.pop(0)
        if sign in {"/", ".", "·", "*"}:
            if open_end:
                raise ValueError
            side, open_end = (-1 if sign == "/" else side), True
            continue
        if sign == "(":
            part = _quotient(signs)
            if not signs:
                raise ValueError
            del signs[0]
        else:
            part = _factor(sign)
        unit, open_end = _times(unit, part, side), False
    if open_end:
        raise ValueError
    return unit


def _factor(sign: str) -> Unit:
    unit = spelled(sign)
    if unit is not None and "Hz" not in sign:
        return unit
    match = _FACTOR.fullmatch(sign)
    if match is None:
        raise ValueError
    symbol, power = match["symbol"], match["power"] or ""
    if symbol.endswith("Hz") and (hertz := spelled(symbol)):
        return _raised(_times(hertz, _ROTARY["turn"], 1), power)
    if symbol in _ROTARY:
        return _raised(_ROTARY[symbol], power)
    pairs = [(spelled(symbol[:n]), spelled(symbol[n:] + power)) for n in range(1, len(symbol))]
    found = [_times(one, other, 1) for one, other in pairs if one and other]
    if len(found) != 1:
        raise ValueError
    return found[0]


def _raised(unit: Unit, power: str) -> Unit:
    exponent = {"": 1, "²": 2, "³": 3}.get(power) or int(power.lstrip("^"))
    return _times(_ONE, unit, exponent)


def _times(one: Unit, other: Unit, power: int) -> Unit:
    a, b, c, d, e, f, g, h = (
        p + power * q for p, q in zip(one.dimension, other.dimension, strict=True)
    )
    return Unit(one.factor * other.factor**power, Fraction(0), (a, b, c, d, e, f, g, h))


Read: TypeAlias = Callable[[str, str], float]
"""Reads a quantity: text and unit of the result; raises `QuantityError`."""

EXAMPLE: Final = "0.1..50 mm/s log 400"
BETWEEN: Final = ".."
"""What stands between the ends of a range."""

MOST_VALUES: Final = 10_000_000
"""Most values of a range: they are held in memory."""

_SPACED: Final = {"log": True, "lin": False}
_COUNT: Final = re.compile(r"[+-]?\d{1,18}", re.ASCII)


@dataclass(frozen=True)
class Range:
    """Values from `low` to `high`, both among them, in the unit that was asked for."""

    low: float
    high: float
    count: int
    """How many values, at least 2."""
    log: bool
    """Whether each value has the same ratio to the next, in place of the same distance."""
    symbol: str = ""
    """The unit as it was written; "" for none."""

    def values(self) -> NDArray[np.float64]:
        """Return the values, shape (count,), rising; the ends are exact."""
        # What has no ranges goes without NumPy.
        import numpy as np

        spaced = np.geomspace if self.log else np.linspace
        return np.asarray(spaced(self.low, self.high, self.count), dtype=np.float64)


def parse_range(text: str, unit: str, *, read: Read = typed, count: int | None = None) -> Range:
    """Read a range: ``LOW..HIGH [UNIT] [log|lin] [COUNT]``.

    A unit of one end counts for both, and each may have its own (``900 um/s..2 mm/s 12``). Without
    ``log`` the distances are equal. `read` reads one end, given text and the `unit` of the result;
    `count` is how many values a range has that does not say it, None: that is refused.

    Raises
    ------
    QuantityError
        If the text is no range, runs backwards, is empty, or is logarithmic and not above 0; or as
        `read` raises it. The message gives the reason alone: it follows a name and the text.
    """
    low_text, between, rest = (part.strip() for part in text.partition(BETWEEN))
    if not between or BETWEEN in rest or rest.startswith("."):
        raise QuantityError(f"is no range; expected such as {EXAMPLE!r}")
    number, tail = parts_of(rest)
    words, spacing, counts = tail.split(), list[str](), list[str]()
    while words and (words[-1] in _SPACED or _COUNT.fullmatch(words[-1])):
        (spacing if words[-1] in _SPACED else counts).append(words.pop())
    for what, said in (("spacing", spacing), ("count", counts)):
        if len(said) > 1:
            raise QuantityError(f"has two words for its {what}")
    if not counts and count is None:
        raise QuantityError(f"does not end with how many values; expected such as {EXAMPLE!r}")
    count = int(counts[0]) if counts else count or 0
    log = spacing == ["log"]
    low_number, low_symbol = parts_of(low_text)
    symbol = " ".join(words) or low_symbol
    low = read(f"{low_number} {low_symbol or symbol}".strip(), unit)
    high = read(f"{number} {symbol}".strip(), unit)
    if not 2 <= count <= MOST_VALUES:
        raise QuantityError(f"has {count} values; 2 to {MOST_VALUES:g} are possible")
    if low == high:
        raise QuantityError("is empty: both ends are the same")
    if low > high:
        raise QuantityError("is reversed: its end must be above its begin")
    if log and low <= 0.0:
        raise QuantityError("is logarithmic and begins at 0 or below; expected both ends above 0")
    return Range(low, high, count, log, symbol)
