"""Tables as all commands print them, and such as fit the line they are printed on."""

from collections.abc import Collection, Iterable, Sequence
from typing import Any, Final

from rich.box import SIMPLE_HEAD
from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.measure import Measurement
from rich.segment import Segment
from rich.table import Table

_UNBOUND: Final = 10_000
"""Characters in a line that fits any table."""


def grid(
    head: Sequence[str],
    rows: Iterable[Sequence[Any]] = (),
    *,
    texts: Collection[int] = (0,),
    title: str | None = None,
    **look: Any,
) -> Table:
    """Make a table: its headings, its rows, and which columns are texts and not numbers."""
    table = Table(title=title, title_justify="left", title_style="bold", box=SIMPLE_HEAD, **look)
    for place, heading in enumerate(head):
        table.add_column(heading, justify="left" if place in texts else "right", overflow="fold")
    for row in rows:
        table.add_row(*row)
    return table


class Fitted:
    """A table in the fullest form that fits the line, with notes below and no blanks at line ends.

    Parameters
    ----------
    forms
        The same table, the widest first. The last one is taken where none fits.
    notes
        What stands below the table.
    """

    def __init__(self, forms: Sequence[RenderableType], *notes: RenderableType) -> None:
        self._forms, self._notes = forms, notes

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        unbound = options.update(max_width=_UNBOUND)
        fitting = (
            form
            for form in self._forms
            if Measurement.get(console, unbound, form).maximum <= options.max_width
        )
        shown = Group(next(fitting, self._forms[-1]), *self._notes)
        for line in console.render_lines(shown, options, pad=False):
            yield from _without_blanks_at_the_end(line)
            yield Segment.line()


def _without_blanks_at_the_end(line: list[Segment]) -> list[Segment]:
    kept = list(line)
    while kept and not kept[-1].text.strip():
        kept.pop()
    if kept:
        text, style, control = kept[-1]
        kept[-1] = Segment(text.rstrip(), style, control)
    return kept
