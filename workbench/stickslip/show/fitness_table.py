"""The fitness of an FMU as a table: the answer for each quantity."""

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from stickslip_verification import Verdict
from stickslip_verification.judge.fitness import FITNESS


def fitness_table(verdict: Verdict) -> RenderableType:
    """Make the table of the answers, and say how many places the report has.

    `verdict` has a table of fitness, as `verify(…, within=…)` makes it.
    """
    answer, *places = (table for table in verdict.tables if table.title.startswith(FITNESS))
    shown = Table(title=answer.title, title_justify="left", title_style="bold", box=SIMPLE_HEAD)
    for heading in answer.head:
        shown.add_column(heading, overflow="fold")
    for row in answer.rows:
        style = {"yes": "green", "no": "red"}.get(str(row[1]))
        shown.add_row(*(Text(str(cell), style or "") for cell in row))
    more = sum(len(table.rows) for table in places)
    found = [Text(f"{more} places are not within it; the report lists them")] if more else []
    return Group(shown, *found)
