"""A verdict as one HTML page that asks for nothing outside itself, for screen, phone and paper."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import matplotlib as mpl
from markupsafe import Markup
from matplotlib.figure import Figure

from stickslip_fmu.release import VERSION
from stickslip_verification.report.files import environment, text_of
from stickslip_verification.report.svg import STYLE, as_part

from ..verdict import Verdict
from . import plots, tables

_TEMPLATES: Final = Path(__file__).parent / "templates"


def html(verdict: Verdict) -> str:
    """Return a verdict as a page: at most four on paper (A4), the answer on the first.

    The same verdict gives the same text.
    """
    return environment(_TEMPLATES).get_template("report.html.j2").render(
        verdict=verdict,
        axis=verdict.axis,
        tables=tables,
        bars=[
            (name, _drawn(plots.feeds(verdict, width), f"bar-{name}", "Motions over the feed"))
            for name, width in (("wide", plots.WIDE), ("narrow", plots.NARROW))
        ],
        motion=_drawn(plots.before_and_after(verdict), "motion", "The motion before and after"),
        responses=[
            _drawn(plots.responses(verdict, cut), cut, f"Open loop {words}")
            for cut, words in tables.CUTS.items()
        ],
        version=VERSION,
        style=text_of("report.css", _TEMPLATES),
    )  # fmt: skip


def _drawn(page: Figure | None, prefix: str, title: str) -> Markup | None:
    if page is None:
        return None
    with mpl.rc_context(STYLE):
        return Markup(as_part(page, prefix, title))
