"""Numbers as engineers read them: three or four digits, in the units of the workshop."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Final, NamedTuple

NONE: Final = "–"
"""What stands for a number that there is none of."""

DIGITS: Final = 3
"""Digits of a result, with zeros at the end; a critical feed in the loop is good to 1 %."""

EXACT: Final = 4
"""Digits of a number that was given or that a cure has to reach, without zeros at the end."""

_DEGREE: Final = math.pi / 180.0
_UNITS: Final[Mapping[str, tuple[float, str]]] = {
    "1": (1.0, ""),
    "Hz": (1.0, "Hz"),
    "N": (1.0, "N"),
    "N.s/m": (1.0, "N·s/m"),
    "N/m": (1e6, "N/µm"),
    "m": (1e-6, "µm"),
    "m/s": (1e-3, "mm/s"),
    "m/min": (1.0 / 60e3, "mm/min"),
    "m/s2": (1.0, "m/s²"),
    "N.m": (1.0, "N·m"),
    "kg.m2": (1.0, "kg·m²"),
    "rad": (_DEGREE, "°"),
    "rad/s": (1.0, "1/s"),
}
"""The unit in which a quantity of an SI unit is shown, with its size; others stay in SI. A speed is
in m/s, and shown by the minute as ``m/min``."""
_TURNING: Final[Mapping[str, tuple[float, str]]] = {
    **_UNITS,
    "kg": (1.0, "kg·m²"),
    "N": (1.0, "N·m"),
    "N.s/m": (1.0, "N·m·s/rad"),
    "N/m": (1e3, "kN·m/rad"),
    "m": (_DEGREE, "°"),
    "m/s": (_DEGREE, "°/s"),
    "m/min": (_DEGREE / 60.0, "°/min"),
    "m/s2": (_DEGREE, "°/s²"),
}
"""The same of what turns: an angle in rad stands for a way, a torque for a force."""
_SHOWN: Final = ContextVar("shown", default=_UNITS)

_SHORT: Final = 0.1
"""Times below this [s] are shown in ms."""

_LONG: Final = 1e-3
"""Lengths from this on [m] are shown in mm."""

_SMALLEST: Final = 1e-4
"""Numbers below this are written with a power of ten."""


class Scale(NamedTuple):
    """A unit to show values in: its size in SI, and its symbol, "" for a plain number."""

    size: float
    symbol: str

    def label(self, name: str = "") -> str:
        """Return a name with the unit behind it, or the unit alone."""
        return f"{name} [{self.symbol}]".lstrip() if self.symbol else name

    def text(self, value: float, form: str = ".6g") -> str:
        """Write a value [SI] with the unit."""
        return f"{value / self.size:{form}} {self.symbol}"

    def told(self, value: float) -> str:
        """Return a value [SI] with its unit, its number as of `number`."""
        return f"{number(value / self.size)} {self.symbol}".rstrip()


@contextmanager
def turning(turns: bool) -> Iterator[None]:
    """Show inside what is in m, N and kg as what turns has it: in °, N·m and kg·m².

    The numbers are then in rad, N m and kg m2; without `turns` they are those of a slide.
    """
    token = _SHOWN.set(_TURNING if turns else _UNITS)
    try:
        yield
    finally:
        _SHOWN.reset(token)


def scale_of(unit: str) -> Scale:
    """Return the unit in which `told` and `shown_in` show a quantity of an SI unit."""
    return Scale(*_SHOWN.get().get(unit, (1.0, unit)))


def number(value: float | None, digits: int = DIGITS) -> str:
    """Return a number with so many digits, and no power of ten where it can be without."""
    if value is None or math.isnan(value):
        return NONE
    if math.isinf(value):
        return "∞" if value > 0.0 else "\N{MINUS SIGN}∞"
    if abs(value) >= 10.0**digits:
        text = f"{value:.0f}"
    elif 0.0 < abs(value) < _SMALLEST:
        mantissa, _, power = f"{value:.{digits - 1}e}".partition("e")
        text = f"{mantissa}e{int(power)}"
    elif digits == DIGITS and value:
        text = f"{value:#.{digits}g}".rstrip(".")
    else:
        text = f"{value:.{digits}g}"
    return text.replace("-", "\N{MINUS SIGN}")


def told(value: float | None, unit: str, digits: int = DIGITS) -> str:
    """Return a quantity given in SI with its unit, in the one that engineers use."""
    if value is None or math.isnan(value):
        return NONE
    size, symbol = scale_of(unit)
    if unit == "s" and 0.0 < abs(value) < _SHORT:
        size, symbol = 1e-3, "ms"
    if symbol == "µm" and _LONG <= abs(value) < math.inf:
        size, symbol = 1e-3, "mm"
    text = number(value / size, digits)
    # A degree stands at its number.
    return text + symbol if not symbol or symbol[0] == "°" else f"{text} {symbol}"


def shown_in(value: float | None, unit: str, digits: int = DIGITS) -> str:
    """Return the number of a quantity in the unit of `told`, for a column that names the unit."""
    return number(None if value is None else value / scale_of(unit).size, digits)


def per_minute(speed: float | None, digits: int = DIGITS) -> str:
    """Return a speed [m/s] as a number of mm/min; of what turns [rad/s] of °/min."""
    return shown_in(speed, "m/min", digits)


def decibels(factor: float) -> str:
    """Return a factor in dB, to a tenth."""
    if not 0.0 < factor < math.inf:
        return number(factor if factor > 0.0 else None)
    return f"{20.0 * math.log10(factor):.1f}".replace("-", "\N{MINUS SIGN}")


_PREFIXES: Final = ((1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))
_SCALES: Final = {
    # Metres and seconds have no larger units in a workshop.
    **{u: [Scale(size, sign + u) for size, sign in _PREFIXES[2:]] for u in ("m", "m/s", "s")},
    **{u: [Scale(size, sign + u) for size, sign in _PREFIXES] for u in ("N", "Hz")},
    "N/m": [Scale(1e6, "N/µm"), Scale(1e3, "kN/m"), Scale(1.0, "N/m")],
}
"""Units in which a value of an SI unit is neither tiny nor huge, the largest first."""


def scale_for(value: float, unit: str, enough: float = 1.0) -> Scale:
    """Choose the largest unit of which `value` has at least `enough`; else the smallest.

    Parameters
    ----------
    value
        The value to show, or the largest of many, SI; its sign does not count. 0 is in SI.
    unit
        Its SI unit, "1" for none. One without a ladder is shown as it is.
    enough
        How many of the unit `value` must hold.
    """
    if _SHOWN.get() is _TURNING and unit in _TURNING:
        return scale_of(unit)
    scales = _SCALES.get(unit, [Scale(1.0, "" if unit == "1" else unit)])
    if value == 0.0:
        return next(scale for scale in scales if scale.size == 1.0)
    return next((scale for scale in scales if abs(value) >= enough * scale.size), scales[-1])
