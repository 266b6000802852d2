"""A verdict as one HTML page that asks for nothing outside itself, and as plain data for JSON."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, Final

import matplotlib as mpl
import numpy as np
from markupsafe import Markup
from matplotlib.figure import Figure

from stickslip_fmu.release import VERSION
from stickslip_verification.report.files import environment, text_of
from stickslip_verification.report.svg import STYLE, as_part

from ..axis.keys import KEYS, TURNING
from ..loop.presliding import AtFeed
from ..loop.stability import Swing
from ..verdict import OperatingPoint, Verdict, in_its_units
from . import plots, tables
from .drawing import sketch
from .tables import standing

_TEMPLATES: Final = Path(__file__).parent / "templates"


@in_its_units
def html(verdict: Verdict) -> str:
    """Return a verdict as a page: at most four on paper (A4), the first for a meeting.

    The same verdict gives the same text.
    """
    return rendered(
        "report.html.j2",
        verdict=verdict,
        axis=verdict.axis,
        tables=tables,
        pictures=[
            drawn(sketch(verdict), "sketch", "The axis and its numbers"),
            drawn(plots.feeds(verdict, plots.NARROW), "bar", "Motions over the feed"),
            drawn(plots.motion(verdict, "before"), "before", "The motion as it is"),
            drawn(plots.motion(verdict, "after"), "after", "The motion with the best measure"),
        ],
        responses=[
            drawn(plots.responses(verdict, cut), cut, f"Open loop {words}")
            for cut, words in tables.CUTS.items()
        ],
    )  # fmt: skip


def rendered(template: str, **parts: Any) -> str:
    """Return a page of one of our templates, in the style of reports on an axis."""
    style = text_of("report.css", _TEMPLATES)
    page = environment(_TEMPLATES).get_template(template)
    return page.render(version=VERSION, style=style, **parts)


def drawn(page: Figure | None, prefix: str, title: str) -> Markup | None:
    """Return a picture as a part of a page; None where there is none."""
    if page is None:
        return None
    with mpl.rc_context(STYLE):
        return Markup(as_part(page, prefix, title))


FORMAT: Final = 3
"""Rises where a key changes its meaning or goes."""

ABOUT: Final = (
    "Numbers are SI, in the units of `units` by key. A number without end is the text 'Infinity'. "
    "null: there is none, or it was not stated."
)

UNITS: Final = {
    **{key.symbol: key.units[0] for key in KEYS.values() if key.units and key.symbol},
    **{
        key: unit
        for unit, keys in {
            "m/s": "feed speed low high critical_feed critical_range rigid_critical_feed "
            "estimated_critical_feed simplified_critical_feed",
            "m/s; of a regime the motion that a start from rest reaches": "from_rest",
            "m": "jump simplified_jump ahead hunts way turns_at",
            "1/s": "growth",
            "s": "settling period delay_margin time",
            "Hz": "frequency simplified_frequency gain_margin_at phase_margin_at",
            "rad/s": "w",
            "rad": "phase_margin",
            "1": "margin amplitude damping real imag gain_margin effort depth clean machines gap "
            "stiffness mass",
            "N": "F_s F_k",
            "N.m": "rated_torque",
            "N/m": "stiffest",
            "that of `unit` beside it": "now then",
            "SI, as the number that it belongs to": "spread",
            "SI, as the parameters of the friction law": "own",
        }.items()
        for key in keys.split()
    },
}
"""The unit of every number, by its key."""

_SHOWN: Final[dict[type, tuple[str, ...]]] = {
    Swing: ("frequency",),
    AtFeed: ("judders",),
    OperatingPoint: ("feed", "jumps", "judders", "jump", "frequency"),
}
"""Properties that stand beside the fields of a result."""


def data(verdict: Verdict) -> dict[str, Any]:
    """Return a verdict as what JSON knows: dicts, lists, texts, finite numbers, true and null.

    Keys are the attributes of `Verdict` and of what is in it. Numbers are SI, their units stand in
    ``units`` by key. Infinity is the text ``"Infinity"``, what is not a number null. A complex
    gain is two lists, ``real`` and ``imag``.
    """
    turned = TURNING if verdict.axis.turns else {}
    found: dict[str, Any] = plain(verdict)
    for each in (*found["cures"], *(c for one in found["measures"] for c in one["changes"])):
        each["unit"] = turned.get(each["unit"], each["unit"])
    found["axis"] |= plain({"F_s": verdict.axis.F_s, "F_k": verdict.axis.F_k})
    return {
        "format": FORMAT,
        "version": VERSION,
        "about": ABOUT,
        "units": {
            key: "; ".join(turned.get(part, part) for part in unit.split("; "))
            for key, unit in UNITS.items()
        },
        "standing": standing(verdict).word,
        **found,
    }


def plain(value: Any) -> Any:
    """Return a result as what JSON knows, as of `data`."""
    if is_dataclass(value) or hasattr(value, "_asdict"):
        names = [of.name for of in fields(value)] if is_dataclass(value) else value._fields
        names = (*names, *_SHOWN.get(type(value), ()))
        return {name: plain(getattr(value, name)) for name in names}
    if isinstance(value, Mapping):
        return {str(key): plain(part) for key, part in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        if np.iscomplexobj(value):
            return {"real": plain(value.real), "imag": plain(value.imag)}
        return plain(value.tolist())
    if isinstance(value, tuple | list):
        return [plain(part) for part in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else "Infinity" if value > 0.0 else "-Infinity"
    return value
