"""A verdict as one HTML page that asks for nothing outside itself, for screen, phone and paper."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Final

import matplotlib as mpl
from markupsafe import Markup
from matplotlib.figure import Figure

from stickslip_fmu.release import VERSION
from stickslip_verification.report.environment import environment, text_of
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
        standing=tables.standing(verdict),
        critical=tables.critical(verdict),
        margin=tables.margin(verdict),
        smallest=[(cure, tables.change(cure)) for cure in verdict.smallest],
        bars=[
            (name, _drawn(plots.feeds(verdict, width), f"bar-{name}", "Motions over the feed"))
            for name, width in (("wide", plots.WIDE), ("narrow", plots.NARROW))
        ],
        points=tables.operating_points(verdict),
        limits=tables.critical_feeds(verdict),
        hunting=tables.hunting(verdict),
        cures=tables.cures(verdict),
        motion=_drawn(plots.before_and_after(verdict), "motion", "The motion before and after"),
        loop=tables.loop(verdict),
        margins=tables.margins(verdict),
        unseen=not all(tables.passes(each) for each in verdict.responses),
        responses=[
            _drawn(plots.responses(verdict, cut), cut, f"Open loop {words}")
            for cut, words in tables.CUTS.items()
        ],
        assumed=tables.assumed(verdict.axis),
        numbers=_halves(tables.numbers(verdict.axis)),
        version=VERSION,
        style=text_of("report.css", _TEMPLATES),
    )  # fmt: skip


def _halves(grid: tables.Grid) -> list[tables.Grid]:
    middle = -(-len(grid.rows) // 2)
    return [replace(grid, rows=grid.rows[:middle]), replace(grid, rows=grid.rows[middle:])]


def _drawn(page: Figure | None, prefix: str, title: str) -> Markup | None:
    if page is None:
        return None
    with mpl.rc_context(STYLE):
        return Markup(as_part(page, prefix, title))
