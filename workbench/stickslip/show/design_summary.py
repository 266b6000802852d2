"""A verdict on an axis at a glance: the sentence, the operating points, the cheapest cures."""

from collections.abc import Iterator
from typing import Final

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from stickslip.show.tables import grid
from stickslip_design.report import tables
from stickslip_design.verdict import Verdict

_STYLES: Final = {"good": "bold green", "warn": "bold yellow", "bad": "bold red"}


def design_summary(verdict: Verdict) -> RenderableType:
    """Make the summary of a verdict; the report has the rest."""
    found = tables.standing(verdict)
    parts: list[RenderableType] = [
        Text.assemble(verdict.axis.name, ": ", (found.word, _STYLES[found.tone])),
        Text(verdict.sentence),
    ]
    grids = tables.operating_points(verdict), tables.loop(verdict)
    parts += [_table(each) for each in grids if each.rows]
    parts.append(Text(f"critical feed: {tables.critical(verdict)}"))
    if verdict.stable and verdict.axis.drive is not None:
        parts.append(Text(f"at a target: {tables.hunting(verdict)[0]}"))
    parts += _cures(verdict)
    assumed = tables.assumed(verdict.axis)
    if assumed.rows:
        parts.append(_table(assumed))
    return Group(*parts)


def _cures(verdict: Verdict) -> Iterator[RenderableType]:
    """Yield the cures that help as a table, and the names of the others."""
    rated = tables.cures(verdict)
    names = [f"{cure.name} ({cure.held})" if cure.held else cure.name for cure in verdict.cures]
    rows: list[tuple[str, ...]] = []
    others: dict[tuple[str, str], list[str]] = {}
    for name, cure, row in zip(names, verdict.cures, rated.rows, strict=True):
        if cure.then is None:
            others.setdefault((cure.aim, cure.note), []).append(name)
        else:
            rows.append((name, *row[1:-1]))
    if rows:
        yield _table(tables.Grid(rated.head[:-1], rows, rated.numbers))
    for (aim, note), idle in others.items():
        reason = f" ({note})" if note else ""
        yield Text(f"no help alone for {aim}{reason}: {', '.join(idle)}")


def _table(shown: tables.Grid) -> Table:
    texts = [place for place in range(len(shown.head)) if place not in shown.numbers]
    return grid(shown.head, shown.rows, texts=texts, show_header=bool(shown.head[1]))
