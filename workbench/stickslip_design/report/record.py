"""A verdict as plain data, for JSON."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any, Final

import numpy as np

from stickslip_fmu.release import VERSION

from ..axis.keys import KEYS
from ..loop.stability import Swing
from ..verdict import OperatingPoint, Verdict
from .tables import standing

FORMAT: Final = 2
"""Rises where a key changes its meaning or goes."""

ABOUT: Final = (
    "Numbers are SI, in the units of `units` by key. A number without end is the text 'Infinity'. "
    "null: there is none, or it was not stated."
)

UNITS: Final = {
    **{key.symbol: key.units[0] for key in KEYS.values() if key.units and key.symbol},
    "feed": "m/s",
    "margin": "1",
    "jump": "m",
    "frequency": "Hz",
    "speed": "m/s",
    "amplitude": "1",
    "settling": "s",
    "low": "m/s",
    "high": "m/s",
    "simplified_jump": "m",
    "simplified_frequency": "Hz",
    "critical_feed": "m/s",
    "critical_range": "m/s",
    "rigid_critical_feed": "m/s",
    "estimated_critical_feed": "m/s",
    "simplified_critical_feed": "m/s",
    "from_rest": "m/s; of a regime the motion that a start from rest reaches",
    "damping": "1",
    "w": "rad/s",
    "period": "s",
    "real": "1",
    "imag": "1",
    "gain_margin": "1",
    "gain_margin_at": "Hz",
    "phase_margin": "rad",
    "phase_margin_at": "Hz",
    "delay_margin": "s",
    "time": "s",
    "ahead": "m",
    "effort": "1",
    "now": "that of `unit` beside it",
    "then": "that of `unit` beside it",
    "F_s": "N",
    "F_k": "N",
    "stiffest": "N/m",
    "spread": "SI, as the number that it belongs to",
    "own": "SI, as the parameters of the friction law",
    "depth": "1",
}
"""The unit of every number, by its key."""


_OF_POINT: Final = ("feed", "jumps", "judders", "jump", "frequency")


def data(verdict: Verdict) -> dict[str, Any]:
    """Return a verdict as what JSON knows: dicts, lists, texts, finite numbers, true and null.

    Keys are the attributes of `Verdict` and of what is in it. Numbers are SI, their units stand in
    ``units`` by key. Infinity is the text ``"Infinity"``, what is not a number null. A complex
    gain is two lists, ``real`` and ``imag``.
    """
    axis = {"F_s": verdict.axis.F_s, "F_k": verdict.axis.F_k}
    found: dict[str, Any] = plain(verdict)
    found["axis"] |= plain(axis)
    return {
        "format": FORMAT,
        "version": VERSION,
        "about": ABOUT,
        "units": dict(UNITS),
        "standing": standing(verdict).word,
        **found,
    }


def plain(value: Any) -> Any:
    """Return a result as what JSON knows, as of `data`."""
    if isinstance(value, Swing):
        return plain({**value._asdict(), "frequency": value.frequency})
    if isinstance(value, OperatingPoint):
        shown = {name: getattr(value, name) for name in _OF_POINT}
        return {**plain({each.name: getattr(value, each.name) for each in fields(value)}), **shown}
    if is_dataclass(value) and not isinstance(value, type):
        return {each.name: plain(getattr(value, each.name)) for each in fields(value)}
    if hasattr(value, "_asdict"):
        return plain(value._asdict())
    if isinstance(value, Mapping):
        return {str(key): plain(each) for key, each in value.items()}
    if isinstance(value, np.ndarray):
        if np.iscomplexobj(value):
            return {"real": plain(value.real), "imag": plain(value.imag)}
        return [plain(each) for each in value.tolist()]
    if isinstance(value, tuple | list):
        return [plain(each) for each in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float):
        return _number(value)
    return value


def _number(value: float) -> float | str | None:
    if math.isnan(value):
        return None
    if math.isinf(value):
        return "Infinity" if value > 0.0 else "-Infinity"
    return value
