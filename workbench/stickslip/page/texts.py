"""Texts with numbers: templates that are filled with what the reference computes for a setting."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict
from functools import partial
from typing import Final

from jinja2 import Environment, StrictUndefined

from stickslip_ref import Parameters, critical_velocity, simplified, steady_cycle

_ALMOST: Final = 0.9999
_SCALES: Final[Mapping[str, tuple[tuple[float, str, float], ...]]] = {
    "length": (
        (1e3, "km", _ALMOST),
        (1.0, "m", _ALMOST),
        (1e-3, "mm", _ALMOST),
        (1e-6, "µm", _ALMOST),
    ),
    "velocity": ((1.0, "m/s", _ALMOST), (1e-3, "mm/s", _ALMOST), (1e-6, "µm/s", _ALMOST)),
    "force": (
        (1e12, "TN", _ALMOST),
        (1e9, "GN", _ALMOST),
        (1e6, "MN", _ALMOST),
        (1e3, "kN", _ALMOST),
        (1.0, "N", _ALMOST),
        (1e-3, "mN", _ALMOST),
    ),
    "time": (
        (31557600.0, "years", 2.0),
        (86400.0, "days", 2.0),
        (3600.0, "h", 2.0),
        (60.0, "min", 2.0),
        (1.0, "s", _ALMOST),
        (1e-3, "ms", _ALMOST),
        (1e-6, "µs", _ALMOST),
    ),
    "frequency": ((1e3, "kHz", _ALMOST), (1.0, "Hz", _ALMOST), (1e-3, "mHz", _ALMOST)),
    "stiffness": ((1e6, "N/µm", _ALMOST), (1.0, "N/m", _ALMOST)),
    "damping": ((1e3, "kN·s/m", _ALMOST), (1.0, "N·s/m", _ALMOST)),
    "mass": ((1.0, "kg", _ALMOST), (1e-3, "g", _ALMOST)),
    "share": ((0.01, "%", 0.0),),
    "number": ((1.0, "", 0.0),),
}
"""Kinds of quantity: of each unit its size [SI], its symbol, and from how many of it on it fits.

Those of view/units.js, as far as the texts need them.
"""


def quantity(value: float, count: int = 4, *, kind: str) -> str:
    """Return a quantity as a person reads it, such as "6.305 mm", as view/units.js writes it.

    Parameters
    ----------
    value
        The quantity [SI].
    count
        Significant digits.
    kind
        What it is, such as ``"length"``; decides the units to choose from.

    Raises
    ------
    ValueError
        If the value is not finite: a text must not tell of a cycle that does not exist.
    """
    if not math.isfinite(value):
        raise ValueError(f"a text of the page asks for a {kind} that is {value}")
    scales = _SCALES[kind]
    size, unit, _ = next(
        (scale for scale in scales if abs(value) >= scale[2] * scale[0]), scales[-1]
    )
    if value == 0.0:
        size, unit = 1.0, next(unit for size, unit, _ in scales if size == 1.0)
        count = 1
    shown = value / size
    whole = abs(shown) >= 10**count
    digits = f"{shown:.0f}" if whole else f"{shown:#.{count}g}".rstrip(".")
    return f"{digits}\u00a0{unit}".rstrip("\u00a0").replace("-", "−")


class Numbers:
    """What the reference computes for a setting, by the symbols of docs/theory.md.

    Parameters
    ----------
    setting
        m, g, load, k, c, mu_s, mu_k, v [SI].

    Attributes
    ----------
    m, g, load, k, c, mu_s, mu_k, v, N, F_s, F_k, Delta, w, lambda_, zeta : float
        The setting and what follows from it alone [SI]; (2).
    delta_x, spring_drop, t_stick, t_slip, T, f, x_dot_peak, share : float
        The exact cycle [SI], NaN where there is none; (6) to (13).
    simple : SimplifiedCycle
        The cycle as designers write it [SI]; (12).
    F_max : float
        Largest spring force without damping [N], the swing about F_k; (7).
    v_c, v_c_simple : float
        Critical velocity [m/s], exact and to first order; (14).
    """

    def __init__(self, setting: Mapping[str, float]) -> None:
        p = Parameters(**setting)
        cycle = steady_cycle(p)
        self.__dict__ |= {**setting, **asdict(cycle)}
        self.share = cycle.t_stick / cycle.T
        self.simple = simplified(p)
        self.N, self.w, self.zeta = p.N, p.w, p.zeta
        self.F_k = p.mu_k * p.N
        self.F_max = self.F_k + p.k * math.hypot(float(p.Delta), p.v / float(p.w))
        self.v_c = critical_velocity(p)
        if p.c > 0.0:
            damping = 4.0 * math.pi * p.zeta * p.k * p.m
            self.v_c_simple = p.k * p.Delta / damping**0.5


def filled(text: str, numbers: Mapping[str, object]) -> str:
    """Fill a text with numbers.

    Parameters
    ----------
    text
        A template of Jinja, such as ``"It jumps {{ now.delta_x | length }}."``; the filters are
        the kinds of `quantity`.
    numbers
        By the names that the text uses, such as ``now``: `Numbers` of a setting.

    Raises
    ------
    jinja2.UndefinedError
        If the text asks for a number that there is not.
    ValueError
        If it asks for one that is not finite; names the text.
    """
    if "{" not in text:
        return text
    try:
        return _ENVIRONMENT.from_string(text).render(numbers)
    except ValueError as error:
        raise ValueError(f"{error}: {text}") from error


_ENVIRONMENT: Final = Environment(autoescape=False, undefined=StrictUndefined)
_ENVIRONMENT.filters |= {kind: partial(quantity, kind=kind) for kind in _SCALES}
